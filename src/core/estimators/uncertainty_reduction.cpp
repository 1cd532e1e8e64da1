#include "sightline/core/estimators/uncertainty_reduction.h"

#include <sstream>
#include <stdexcept>

namespace sightline::core::reduction {

void refuseSizes(Eigen::Index parameters, Eigen::Index responses) {
  std::ostringstream message;
  message << "reduceUncertainty: the sizes do not fit a model of " << parameters << " parameters and "
          << responses << " responses: S and C_p must be " << responses << " x " << parameters << ", C_a "
          << parameters << " x " << parameters << ", C_r " << responses << " x " << responses << ", r "
          << responses;
  throw std::invalid_argument(message.str());
}

void refuseCovariance(const char* name, double least_pivot) {
  std::ostringstream message;
  message << "reduceUncertainty: " << name << " is not a covariance: ";
  if (std::isnan(least_pivot)) {
    message << "it is not finite, not symmetric, or has a negative variance";
  } else {
    message << "scaled to unit variances its least pivot is " << least_pivot
            << ", so that a correlation in it is above one";
  }
  message << "; give a symmetric positive semidefinite matrix";
  throw std::invalid_argument(message.str());
}

void refuseJoint(double least_pivot) {
  std::ostringstream message;
  message
      << "reduceUncertainty: C_p does not go with C_r and C_a: scaled to unit variances [[C_r, C_p], "
         "[C_p^T, C_a]] has the least pivot "
      << least_pivot
      << "; C_p must be cov(r, a) of these very r and a, and zero when the measurement did not serve to find "
         "the parameters";
  throw std::invalid_argument(message.str());
}

void refuseSingularDifference() {
  throw std::invalid_argument(
      "reduceUncertainty: the covariance D of q - r is not positive definite: model and measurement leave no "
      "doubt to share out; give the measurement its noise C_r");
}

void refuseSingularJoint() {
  throw std::invalid_argument(
      "reduceUncertaintyIterated: [[C_r, C_p], [C_p^T, C_a]] is not positive definite; the iteration needs "
      "its "
      "inverse: leave out parameters that are known exactly, and check C_p");
}

}  // namespace sightline::core::reduction
