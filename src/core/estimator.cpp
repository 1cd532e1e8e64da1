#include "sightline/core/estimator.h"

namespace sightline::core {

AngularState firstState(const Measurement& measurement, double rate_sigma) {
  AngularState state;
  state.mean << measurement.position, Eigen::Vector2d::Zero();
  state.covariance.topLeftCorner<2, 2>() = measurement.covariance;
  state.covariance.bottomRightCorner<2, 2>().diagonal().setConstant(rate_sigma * rate_sigma);
  return state;
}

}  // namespace sightline::core
