#include "sightline/ros/recordings/incident_watch.h"

namespace sightline_ros {

std::optional<std::string> IncidentWatch::onTracks(const std::string& topic,
                                                   const sightline::TrackArray& tracks) {
  std::set<std::uint32_t>& believed = believed_[topic];
  std::set<std::uint32_t> present;
  for (const sightline::Track& track : tracks.tracks) {
    if (track.status == sightline::Track::CONFIRMED || believed.count(track.id) > 0) present.insert(track.id);
  }
  std::string lost;
  for (const std::uint32_t id : believed) {
    if (present.count(id) == 0) lost += (lost.empty() ? "" : ", ") + std::to_string(id);
  }
  const bool is_one = lost.find(',') == std::string::npos;
  believed = std::move(present);
  if (lost.empty()) return std::nullopt;
  return (is_one ? "track " : "tracks ") + lost + " of " + topic + " ended";
}

std::optional<std::string> IncidentWatch::onReport(const sightline::FusionReport& report) {
  for (const sightline::FusedTrack& track : report.tracks) {
    if (track.sensor_changes.empty()) continue;
    const sightline::SensorHealth& change = track.sensor_changes.front();
    return "sensor " + change.sensor + " is " + change.verdict + " now";
  }
  return std::nullopt;
}

}  // namespace sightline_ros
