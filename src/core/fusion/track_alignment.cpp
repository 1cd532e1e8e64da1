#include "sightline/core/fusion/track_alignment.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "sightline/core/model/angle_range.h"
#include "sightline/core/model/kinematics.h"
#include "sightline/core/model/sphere.h"

namespace sightline::core {
namespace {

constexpr double kSmallestKnownSigma = 1e-9;  // [rad]: a thousandth of an arc second
constexpr double kLargestKnownSigma = 1e3;    // [rad]: "not known", in one direction
constexpr double kLargestRate = 1e4;          // [rad/s]
constexpr double kLargestRateSigma = 1e6;     // [rad/s]: "not known"
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

/// Sigmas of two components on the sphere, where azimuth shrinks with the cosine of the elevation, ascending.
Eigen::Vector2d sigmasOnSphere(const Eigen::Matrix2d& covariance, double elevation) {
  const Eigen::Vector2d shrink(std::max(std::cos(elevation), kSmallestKnownSigma), 1.0);
  const Eigen::Matrix2d on_sphere = shrink.asDiagonal() * covariance * shrink.asDiagonal();
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(on_sphere, Eigen::EigenvaluesOnly)
      .eigenvalues()
      .cwiseMax(0.0)
      .cwiseSqrt();
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

std::optional<Refusal> rejectionOf(const AngularState& state) {
  std::ostringstream why;
  if (!state.mean.allFinite() || !state.covariance.allFinite())
    return invalid("state or covariance is not finite");
  if (!isAzimuth(state.mean(0)) || !isElevation(state.mean(1))) {
    why << "direction (" << state.mean(0) << ", " << state.mean(1)
        << ") rad is off the sphere: azimuth within +-2 pi, elevation within +-pi/2; are these degrees?";
    return invalid(why.str());
  }
  const Eigen::Vector4d variances = state.covariance.diagonal();
  if (variances.isZero(0.0))
    return invalid("covariance is zero (is this the truth?): a local track must state its own");
  if (!(variances.minCoeff() > 0.0)) {
    why << "covariance is not positive definite (variances " << variances.transpose() << ")";
    return invalid(why.str());
  }
  const Eigen::Matrix4d correlation = correlationOf(state.covariance);
  if ((correlation - correlation.transpose()).cwiseAbs().maxCoeff() > kAsymmetry)
    return invalid("covariance is not symmetric");
  if (!isPositiveDefinite(symmetric(correlation))) {
    return invalid("covariance is not positive definite (its correlations contradict one another)");
  }
  const Eigen::Vector2d sigmas = sigmasOnSphere(state.anglesCovariance(), state.mean(1));
  const double least = sigmas(0);
  if (!(least >= kSmallestKnownSigma)) {
    why << "sigma " << least << " rad is below " << kSmallestKnownSigma << " rad: no tracker is that good";
    return invalid(why.str());
  }
  if (!(least <= kPi / 2.0)) {
    why << "sigma " << least
        << " rad is above pi/2 in every direction: the track says nothing; are these degrees?";
    return invalid(why.str());
  }
  if (!(sigmas(1) <= kLargestKnownSigma)) {
    why << "sigma " << sigmas(1) << " rad is above " << kLargestKnownSigma << " rad: the state has diverged";
    return invalid(why.str());
  }
  const double rate = std::hypot(std::cos(state.mean(1)) * state.mean(2), state.mean(3));
  if (!(rate <= kLargestRate)) {
    why << "rate " << rate << " rad/s is above " << kLargestRate << " rad/s: the state has diverged";
    return invalid(why.str());
  }
  const double rate_sigma = sigmasOnSphere(state.covariance.bottomRightCorner<2, 2>(), state.mean(1))(1);
  if (!(rate_sigma <= kLargestRateSigma)) {
    why << "sigma of the rate " << rate_sigma << " rad/s is above " << kLargestRateSigma
        << " rad/s: the state has diverged";
    return invalid(why.str());
  }
  return std::nullopt;
}

double largestPositionSigma(const AngularState& state) {
  return sigmasOnSphere(state.anglesCovariance(), state.mean(1))(1);
}

}  // namespace sightline::core
