#include "sightline/ros/display/display_memory.h"

#include <algorithm>
#include <cmath>

#include "sightline/ros/messages/conversions.h"

namespace sightline_ros {
namespace {

namespace core = sightline::core;

constexpr std::size_t kMaxTracks = 100;          // of one tracker that are drawn
constexpr std::size_t kMaxSightings = 500;       // of one sensor that are kept
constexpr double kSamplesOfPath = 200.0;         // aimed at; more reports than that are thinned out
constexpr std::size_t kMaxSamplesOfPath = 1000;  // whatever the stamps say

bool isFinite(const sightline::Track& track) {
  const auto finite = [](double number) { return std::isfinite(number); };
  return finite(track.azimuth) && finite(track.elevation) && finite(track.azimuth_rate) &&
         finite(track.elevation_rate) &&
         std::all_of(track.covariance.begin(), track.covariance.end(), finite);
}

}  // namespace

void TrackMemory::add(const sightline::TrackArray& report, double arrival) {
  if (report.header.stamp < newest_.header.stamp) clear();
  arrival_ = arrival;
  newest_.header = report.header;
  newest_.tracker = report.tracker;
  newest_.estimator = report.estimator;
  newest_.tracks.clear();
  std::map<std::uint32_t, std::deque<core::TruthSample>> paths;
  for (const sightline::Track& track : report.tracks) {
    if (!isFinite(track) || newest_.tracks.size() >= kMaxTracks) continue;
    newest_.tracks.push_back(track);
    auto& path = paths[track.id] = std::move(paths_[track.id]);
    lengthen(path, {toCore(report.header.stamp), toCore(track).state.mean});
  }
  paths_ = std::move(paths);
}

void TrackMemory::add(const sightline::AssociationArray& decisions) {
  claimed_.clear();
  for (const sightline::Association& decision : decisions.associations) {
    if (decision.decision == sightline::Association::CLAIMED_BY_OTHER && claimed_.size() < kMaxTracks) {
      claimed_.insert(decision.track);
    }
  }
}

void TrackMemory::clear() {
  newest_ = {};
  paths_.clear();
  claimed_.clear();
}

const std::deque<core::TruthSample>& TrackMemory::pathOf(std::uint32_t track) const {
  static const std::deque<core::TruthSample> empty;
  const auto path = paths_.find(track);
  return path != paths_.end() ? path->second : empty;
}

std::optional<Eigen::Vector2d> TrackMemory::anglesAt(std::uint32_t track, core::Time time) const {
  const auto& path = pathOf(track);
  const auto after = std::lower_bound(
      path.begin(), path.end(), time,
      [](const core::TruthSample& sample, core::Time wanted) { return sample.time < wanted; });
  if (after == path.end()) return std::nullopt;
  if (after->time == time) return after->motion.head<2>();
  if (after == path.begin()) return std::nullopt;
  const auto motion = core::interpolate(*std::prev(after), *after, time);
  if (!motion) return std::nullopt;
  return motion->head<2>();
}

void TrackMemory::lengthen(std::deque<core::TruthSample>& path, const core::TruthSample& sample) {
  const double spacing = history_ / kSamplesOfPath;
  // The newest sample moves along until it is far enough from the one before.
  const bool crowded = path.size() >= 2 && core::seconds(sample.time - path[path.size() - 2].time) < spacing;
  if (!path.empty() && (crowded || path.back().time == sample.time)) path.pop_back();
  path.push_back(sample);
  while (path.size() > kMaxSamplesOfPath || core::seconds(sample.time - path.front().time) > history_) {
    path.pop_front();
  }
}

void SightingMemory::add(const core::Scan& scan, double arrival) {
  for (const core::Sighting& sighting : scan.sightings) {
    if (!sighting.direction.allFinite() || !sighting.covariance.allFinite()) continue;
    seen_.push_back({scan.time, sighting.direction, arrival});
    if (seen_.size() > kMaxSightings) seen_.pop_front();
  }
}

void SightingMemory::forgetBefore(double arrival) {
  while (!seen_.empty() && seen_.front().arrival < arrival) seen_.pop_front();
}

}  // namespace sightline_ros
