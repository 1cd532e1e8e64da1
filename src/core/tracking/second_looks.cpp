#include "sightline/core/tracking/second_looks.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace sightline::core {
namespace {

constexpr double kNear = 10.0;          // standard deviations of a change within which another target is near
constexpr std::ptrdiff_t kFewFree = 3;  // sightings of a clear scan that are of no established track
constexpr double kFewFalse = 1.5;       // false sightings expected in it

}  // namespace

// (S-94)
void keepApart(std::vector<TrackPrediction>& predictions) {
  for (TrackPrediction& tentative : predictions) {
    const double distance = kNear * tentative.change_sigma;
    if (distance == 0.0) continue;
    const bool is_near =
        std::any_of(predictions.begin(), predictions.end(), [&](const TrackPrediction& other) {
          return other.believed &&
                 (other.direction - tentative.direction).squaredNorm() < distance * distance;
        });
    if (is_near) tentative.change_sigma = 0.0;
  }
}

bool isClear(const Scan& scan, const std::vector<LiveTrack>& tracks, double clutter) {
  const auto established = std::count_if(
      tracks.begin(), tracks.end(), [](const LiveTrack& track) { return track.lifecycle().isEstablished(); });
  return static_cast<std::ptrdiff_t>(scan.sightings.size()) <= established + kFewFree && clutter <= kFewFalse;
}

// (S-95)
std::vector<LiveTrack> branchesOf(const std::vector<LiveTrack>& tracks, const Scan& scan,
                                  const std::vector<TrackPrediction>& predictions,
                                  const AssociationResult& result, const LifecycleParams& params,
                                  TrackIds& ids) {
  std::vector<LiveTrack> branches;
  for (const GatedPair& pair : result.second_looks) {
    const auto i = static_cast<std::size_t>(pair.track), j = static_cast<std::size_t>(pair.sighting);
    if (result.sighting_of[i] >= 0 || !result.may_start[j]) continue;
    const auto parent = std::find_if(tracks.begin(), tracks.end(),
                                     [&](const LiveTrack& track) { return track.id() == predictions[i].id; });
    if (parent == tracks.end()) continue;
    // The parent has been missed in this scan.
    const double evidence = 1.0 + std::exp(pair.log_ratio) / result.evidence[i];
    const TrackOrigin origin{scan.time, scan.sensor, static_cast<std::uint32_t>(j), parent->id()};
    LiveTrack branch = parent->branch(ids.idOf(origin), origin);
    branch.update(scan, scan.sightings[j], predictions[i], {}, evidence, params);
    branches.push_back(std::move(branch));
  }
  return branches;
}

}  // namespace sightline::core
