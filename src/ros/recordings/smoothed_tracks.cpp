#include "sightline/ros/recordings/smoothed_tracks.h"

#include <algorithm>
#include <utility>

#include "sightline/ros/components/live_smoothing.h"
#include "sightline/ros/messages/conversions.h"

namespace sightline_ros {

namespace core = sightline::core;

SmoothedTracks::SmoothedTracks(const core::EstimatorParams& estimator, std::optional<double> lag)
    : smoother_(estimator), lag_(lag) {}

void SmoothedTracks::keep(const TrackerReport& report) {
  for (const core::TrackTracklet& taken : report.sightings) {
    std::vector<core::TakenSighting>& known = sightings_[taken.track];
    const auto place = std::upper_bound(
        known.begin(), known.end(), taken.tracklet.time,
        [](core::Time time, const core::TakenSighting& sighting) { return time < sighting.tracklet.time; });
    known.insert(place, {taken.tracklet, report.noise_scale});
  }
  if (report.tracks) tracks_.push_back(report.tracks);
}

std::vector<sightline::TrackArray> SmoothedTracks::smooth() const {
  std::map<std::uint32_t, std::vector<core::Time>> times;
  for (const auto& message : tracks_)
    for (const sightline::Track& track : message->tracks)
      times[track.id].push_back(toCore(message->header.stamp));
  std::map<std::uint32_t, States> states;
  for (auto& [id, asked] : times) {
    const auto sightings = sightings_.find(id);
    if (sightings == sightings_.end()) continue;
    std::sort(asked.begin(), asked.end());
    const auto smoothed = smoother_.smooth(sightings->second, asked, lag_);
    for (std::size_t i = 0; i < asked.size(); ++i)
      if (smoothed[i]) states[id].emplace(asked[i], *smoothed[i]);
  }
  std::vector<sightline::TrackArray> messages;
  messages.reserve(tracks_.size());
  for (const auto& message : tracks_) {
    sightline::TrackArray smoothed = *message;
    smoothed.tracks.clear();
    for (const sightline::Track& track : message->tracks) {
      const States& known = states[track.id];
      const auto state = known.find(toCore(message->header.stamp));
      if (state != known.end()) smoothed.tracks.push_back(withState(track, state->second));
    }
    messages.push_back(std::move(smoothed));
  }
  return messages;
}

}  // namespace sightline_ros
