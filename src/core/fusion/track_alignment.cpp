#include "sightline/core/fusion/track_alignment.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "sightline/core/model/angle_range.h"
#include "sightline/core/model/kinematics.h"
#include "sightline/core/model/sphere.h"

namespace sightline::core {
namespace {

constexpr double kSmallestSigma = 1e-9;       // [rad]: a thousandth of an arc second
constexpr double kAsymmetry = 1e-6;           // of an entry, relative to the two sigmas
constexpr double kLeastUncorrelated = 1e-12;  // share of a component's variance that the others leave open

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
  if (!isAzimuth(state.mean(0)) || !isElevation(state.mean(1))) {
    why << "direction (" << state.mean(0) << ", " << state.mean(1)
        << ") rad is off the sphere: azimuth within +-2 pi, elevation within +-pi/2; are these degrees?";
    return why.str();
  }
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
  // On the sphere, where azimuth shrinks with the cosine of the elevation.
  const Eigen::Vector2d shrink(std::max(std::cos(state.mean(1)), kSmallestSigma), 1.0);
  const Eigen::Matrix2d on_sphere = shrink.asDiagonal() * state.anglesCovariance() * shrink.asDiagonal();
  const double least = std::sqrt(
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(on_sphere, Eigen::EigenvaluesOnly).eigenvalues()(0));
  if (!(least >= kSmallestSigma)) {
    why << "sigma " << least << " rad is below " << kSmallestSigma << " rad: no tracker is that good";
    return why.str();
  }
  if (!(least <= kPi / 2.0)) {
    why << "sigma " << least
        << " rad is above pi/2 in every direction: the track says nothing; are these degrees?";
    return why.str();
  }
  return std::nullopt;
}

}  // namespace sightline::core
