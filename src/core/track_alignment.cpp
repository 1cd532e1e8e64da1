#include "sightline/core/track_alignment.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include <Eigen/Cholesky>

#include "sightline/core/kinematics.h"
#include "sightline/core/sighting.h"

namespace sightline::core {
namespace {

constexpr double kAsymmetry = 1e-6;          // of an entry, relative to the two sigmas
constexpr double kLeastUncorrelated = 1e-12; // share of a component's variance that the others leave open

/// Unit-free: ones on the diagonal.
Eigen::Matrix4d correlationOf(const Eigen::Matrix4d& covariance) {
  const Eigen::Vector4d per_sigma = covariance.diagonal().cwiseSqrt().cwiseInverse();
  return per_sigma.asDiagonal() * covariance * per_sigma.asDiagonal();
}

bool isPositiveDefinite(const Eigen::Matrix4d& correlation) {
  const Eigen::LLT<Eigen::Matrix4d> factor(correlation);
  if (factor.info() != Eigen::Success) return false;
  return factor.matrixLLT().diagonal().cwiseAbs2().minCoeff() > kLeastUncorrelated;
}

}  // namespace

AngularState propagate(const AngularState& state, double h, const Eigen::Vector2d& q) {
  Motion<4> motion{state.mean, state.covariance};
  moveOn(motion, h);
  addWhiteAcceleration(motion, q.asDiagonal(), h);
  return {motion.mean, symmetric(motion.covariance)};
}

Eigen::Vector2d impliedProcessNoise(const Eigen::Matrix4d& covariance) {
  Eigen::Vector2d q;
  for (int channel = 0; channel < 2; ++channel) {
    const double P11 = covariance(channel, channel), P22 = covariance(channel + 2, channel + 2);
    q(channel) = std::min(P22 * std::sqrt(0.5 * P22 / P11), kLargestDensityRatio * P11);
  }
  return q;
}

std::optional<std::string> rejectionOf(const AngularState& state) {
  std::ostringstream why;
  if (!state.mean.allFinite() || !state.covariance.allFinite()) return "state or covariance is not finite";
  const Eigen::Vector4d variances = state.covariance.diagonal();
  if (variances.isZero(0.0))
    return "covariance is zero (is this the truth?): a local track must state its own";
  if (!(variances.minCoeff() > 0.0)) {
    why << "covariance is not positive definite (variances " << variances.transpose() << ")";
    return why.str();
  }
  const Eigen::Matrix4d correlation = correlationOf(state.covariance);
  if ((correlation - correlation.transpose()).cwiseAbs().maxCoeff() > kAsymmetry)
    return "covariance is not symmetric";
  if (!isPositiveDefinite(symmetric(correlation))) {
    return "covariance is not positive definite (its correlations contradict one another)";
  }
  return rejectionOf(state.angles(), state.anglesCovariance());
}

}  // namespace sightline::core
