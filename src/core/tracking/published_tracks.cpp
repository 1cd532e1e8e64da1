#include "sightline/core/tracking/published_tracks.h"

#include <cmath>

#include <Eigen/Cholesky>

#include "sightline/core/model/sphere.h"

namespace sightline::core {
namespace {

constexpr double kRounding = 1e-9;  // of the smallest eigenvalue, in units of the standard deviations

}  // namespace

bool isTrack(const Track& track) {
  const AngularState& state = track.state;
  const Gate& gate = track.gate;
  if (!state.mean.allFinite() || !state.covariance.allFinite()) return false;
  if (!gate.centre.allFinite() || !gate.half_width.allFinite() || !gate.covariance.allFinite()) return false;
  const double cosine = std::cos(state.angles().y());
  const double variance = state.covariance(0, 0) * cosine * cosine + state.covariance(1, 1);
  if (!(variance <= kLargestDirectionSigma * kLargestDirectionSigma) ||
      !(state.covariance.diagonal().minCoeff() > 0.0))
    return false;
  const Eigen::Vector4d per_sigma = state.covariance.diagonal().cwiseSqrt().cwiseInverse();
  Eigen::Matrix4d correlation = per_sigma.asDiagonal() * state.covariance * per_sigma.asDiagonal();
  correlation.diagonal().array() += kRounding;
  return Eigen::LLT<Eigen::Matrix4d>(correlation).info() == Eigen::Success;
}

}  // namespace sightline::core
