#include "sightline/ros/recordings/smoothed_positions.h"

#include <algorithm>
#include <cstddef>
#include <tuple>
#include <utility>

#include "sightline/ros/messages/conversions.h"
#include "sightline/ros/messages/position_messages.h"

namespace sightline_ros {

namespace core = sightline::core;

namespace {

/// The message with the position in it.
sightline::PositionTrack withState(const sightline::PositionTrack& message,
                                   const core::SmoothedPosition& smoothed) {
  core::PositionTrack track = toCore(message);
  track.position = smoothed.mean.head<3>();
  track.velocity = smoothed.mean.tail<3>();
  track.covariance = smoothed.covariance;
  return toMessage(track);
}

bool isEarlier(const core::StationMeasurement& a, const core::StationMeasurement& b) {
  return std::tie(a.time, a.station) < std::tie(b.time, b.station);
}

}  // namespace

SmoothedPositions::SmoothedPositions(const core::PositionEstimatorParams& estimator,
                                     std::optional<double> lag)
    : smoother_(estimator), lag_(lag) {}

void SmoothedPositions::keep(const PositionResult& result) {
  keep(result.taken);
  if (result.tracks) tracks_.push_back(result.tracks);
}

/// A target that is started anew is given measurements that it had been given before.
void SmoothedPositions::keep(const std::vector<core::TakenMeasurement>& taken) {
  for (const core::TakenMeasurement& one : taken) {
    std::vector<core::StationMeasurement>& known = measurements_[one.target];
    const auto place = std::lower_bound(known.begin(), known.end(), one.measurement, isEarlier);
    if (place == known.end() || isEarlier(one.measurement, *place)) known.insert(place, one.measurement);
  }
}

std::vector<sightline::PositionTrackArray> SmoothedPositions::smooth() const {
  std::map<std::uint32_t, std::vector<core::Time>> times;
  for (const auto& message : tracks_)
    for (const sightline::PositionTrack& track : message->tracks)
      times[track.id].push_back(toCore(message->header.stamp));
  std::map<std::uint32_t, std::map<core::Time, core::SmoothedPosition>> positions;
  for (auto& [id, asked] : times) {
    const auto measurements = measurements_.find(id);
    if (measurements == measurements_.end()) continue;
    std::sort(asked.begin(), asked.end());
    asked.erase(std::unique(asked.begin(), asked.end()), asked.end());
    const auto smoothed = smoother_.smooth(measurements->second, asked, lag_);
    for (std::size_t i = 0; i < asked.size(); ++i)
      if (smoothed[i]) positions[id].emplace(asked[i], *smoothed[i]);
  }
  std::vector<sightline::PositionTrackArray> messages;
  messages.reserve(tracks_.size());
  for (const auto& message : tracks_) {
    sightline::PositionTrackArray smoothed = *message;
    for (sightline::PositionTrack& track : smoothed.tracks) {
      const auto& known = positions[track.id];
      const auto position = known.find(toCore(message->header.stamp));
      if (position != known.end()) track = withState(track, position->second);
    }
    messages.push_back(std::move(smoothed));
  }
  return messages;
}

}  // namespace sightline_ros
