#include "sightline/core/evaluation/sighting_score.h"

#include <algorithm>
#include <cmath>

#include "sightline/core/association/assignment.h"
#include "sightline/core/model/sphere.h"

namespace sightline::core {
namespace {

double statedVariance(const Sighting& sighting, Channels channels) {
  return channels == Channels::azimuth_only ? anglesCovariance(sighting)(0, 0)
                                            : 0.5 * sighting.covariance.trace();
}

/// Whether a sighting is so far from the target that no gate reaches it; a cheap test before the exact one.
bool isOutOfReach(const Sighting& sighting, const Eigen::Vector3d& target, const SightingGate& gate,
                  Channels channels) {
  constexpr double kMargin = 2.0;  // for what arcs and angles differ
  if (channels == Channels::azimuth_only) return false;
  const double reach = kMargin * std::max(gate.floor, gate.sigmas * std::sqrt(sighting.covariance.trace()));
  return (sighting.direction - target).squaredNorm() > reach * reach;
}

/// For each target its sighting, or -1: as many as lie within the gate, with the smallest sum of squared
/// distances.
std::vector<int> matchSightings(const std::vector<TrueTarget>& targets,
                                const std::vector<Sighting>& sightings, const SightingGate& gate,
                                Channels channels) {
  const double dimensions = channels == Channels::azimuth_only ? 1.0 : 2.0;
  Eigen::MatrixXd cost = Eigen::MatrixXd::Constant(targets.size(), sightings.size(), kForbidden);
  for (Eigen::Index i = 0; i < cost.rows(); ++i) {
    const Eigen::Vector3d target = directionOf(targets[i].state.angles());
    for (Eigen::Index j = 0; j < cost.cols(); ++j) {
      if (isOutOfReach(sightings[j], target, gate, channels)) continue;
      const DirectionError error = errorOf(sightings[j], targets[i].state, channels);
      const double square = error.position.squaredNorm();
      const double sigmas = error.position_nees ? std::sqrt(*error.position_nees * dimensions) : kForbidden;
      if (square <= gate.floor * gate.floor || sigmas <= gate.sigmas) cost(i, j) = square;
    }
  }
  return assign(cost);
}

}  // namespace

void SightingScore::note(const Scan& scan) {
  for (const Sighting& sighting : scan.sightings) {
    const double variance = statedVariance(sighting, channels_);
    if (std::isfinite(variance) && variance > 0.0) stated_variance_.add(variance);
  }
}

double SightingScore::statedSigma() const {
  return std::sqrt(stated_variance_.mean());
}

void SightingScore::add(const Scan& scan, const std::vector<TrueTarget>& targets, const SightingGate& gate,
                        const ScoreListener& listener) {
  const std::vector<int> sighting_of = matchSightings(targets, scan.sightings, gate, channels_);
  const auto matched = targets.size() - std::count(sighting_of.begin(), sighting_of.end(), -1);
  unmatched_ += scan.sightings.size() - matched;

  RunningMean square;
  for (std::size_t i = 0; i < targets.size(); ++i) {
    if (sighting_of[i] < 0 || !targets[i].is_scored) continue;
    const Sighting& sighting = scan.sightings[sighting_of[i]];
    const DirectionError error = errorOf(sighting, targets[i].state, channels_);
    errors_.add(error);
    square.add(error.position.squaredNorm() / errors_.dimensions());
    if (listener.pair) {
      listener.pair({topic_, sensor_, scan.time, targets[i].id, 0, anglesOf(sighting.direction),
                     targets[i].state.angles(), error});
    }
  }
  if (square.count() > 0) last_error_ = std::sqrt(square.mean());
}

}  // namespace sightline::core
