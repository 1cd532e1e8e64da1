#include "sightline/ros/diagnosis/position_examination.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <set>

#include <ros/message_traits.h>

#include "sightline/core/positions/stations/station_alignment.h"
#include "sightline/report/value_text.h"
#include "sightline/ros/messages/conversions.h"

namespace sightline_ros {

namespace core = sightline::core;
using sightline::StationError;
using sightline::report::listOf;
using sightline::report::valueOf;

namespace {

constexpr std::size_t kMostReportTopics = 100;
constexpr std::size_t kMostLocalTracks = 10000;  // of a topic
constexpr std::size_t kMostStations = 1000;      // likewise
constexpr double kLeastLack = 1.0;       // [s] without a position that is worth a word: tracks start without
constexpr double kToldShare = 0.5;       // of its sigma before anything is known: above, nothing is told
constexpr double kOffDeviations = 5.0;   // standard deviations from which a clock or angle is clearly off
constexpr double kHarmfulSlowScale = 5;  // slow error over the stated sigma
constexpr double kMilliOfOne = 1e3;
const std::array<const char*, 3> kAxisNames{"x", "y", "z"};

/// The local tracker of a `tracker/id`.
std::string localTrackerOf(const std::string& source) {
  return source.substr(0, source.rfind('/'));
}

bool isClockTold(const StationError& station) {
  return std::isfinite(station.clock_behind) &&
         station.clock_sigma <= kToldShare * core::StationAlignmentParams().clock_sigma;
}

bool isRotationTold(const StationError& station, std::size_t axis) {
  return std::isfinite(station.rotation[axis]) &&
         station.rotation_sigma[axis] <= kToldShare * core::StationAlignmentParams().orientation_sigma;
}

/// "its clock is 0.05 s behind the others' (standard deviation 0.002 s)".
std::string clockText(const StationError& station) {
  const bool is_behind = station.clock_behind >= 0.0;
  return "its clock is " + valueOf(std::abs(station.clock_behind), "s") +
         (is_behind ? " behind" : " ahead of") +
         (station.corrected ? " those of the stations that are right" : " the others'") +
         " (standard deviation " + valueOf(station.clock_sigma, "s") + ")";
}

/// "what it sees is turned by 0.2 about x, -0.1 about z [mrad of world] (standard deviations 0.4, 0.3)".
std::string rotationText(const StationError& station, const std::string& frame) {
  std::string angles, sigmas;
  for (std::size_t axis = 0; axis < kAxisNames.size(); ++axis) {
    if (!isRotationTold(station, axis)) continue;
    angles += (angles.empty() ? "" : ", ") + valueOf(kMilliOfOne * station.rotation[axis], "mrad") +
              " about " + kAxisNames[axis];
    sigmas += (sigmas.empty() ? "" : ", ") + valueOf(kMilliOfOne * station.rotation_sigma[axis], "mrad");
  }
  return angles.empty() ? ""
                        : "what it sees is turned by " + angles + " of \"" + frame +
                              "\" (standard deviations " + sigmas + ")";
}

/// What the targets do not tell of it; empty when they tell all.
std::string untoldText(const StationError& station) {
  std::string axes;
  for (std::size_t axis = 0; axis < kAxisNames.size(); ++axis) {
    if (!isRotationTold(station, axis)) axes += (axes.empty() ? "" : ", ") + std::string(kAxisNames[axis]);
  }
  std::string things = isClockTold(station) ? "" : "its clock";
  if (!axes.empty()) things += (things.empty() ? "" : " and ") + std::string("its rotation about ") + axes;
  return things.empty()
             ? ""
             : "the targets do not tell " + things +
                   ": it must see targets that other stations see, too, better several at once and "
                   "on paths that bend";
}

std::string slowText(const StationError& station) {
  return valueOf(station.slow_scale, "times") + " the sigma that it states (time constant " +
         valueOf(station.time_constant, "s") + ")";
}

/// All that is known of clock and orientation, and what is not.
std::string knowledgeOf(const StationError& station, const std::string& frame) {
  std::string words = isClockTold(station) ? clockText(station) : "";
  for (const std::string& more : {rotationText(station, frame), untoldText(station)}) {
    if (!more.empty()) words += (words.empty() ? "" : "; ") + more;
  }
  return words;
}

/// What to do about a station that the position tracker puts right.
std::string remedyOf(const StationError& station) {
  const bool is_clock_off = std::abs(station.clock_behind) >= kOffDeviations * station.clock_sigma;
  bool is_turned = false;
  for (std::size_t axis = 0; axis < kAxisNames.size(); ++axis)
    is_turned |= std::abs(station.rotation[axis]) >= kOffDeviations * station.rotation_sigma[axis];
  const std::string clock = "synchronise its clock", rotation = "correct the rotation of its tf";
  if (is_clock_off == is_turned) return clock + ", and " + rotation;
  return is_clock_off ? clock : rotation;
}

/// What a user can do about local tracks without a position, beyond the reason.
std::string remedyOf(const std::string& kind) {
  if (kind == "one station only")
    return "if a second station looks there, see its tf and its clock, and whether its tracker sends "
           "tracklets";
  if (kind == "parallax too small")
    return "stations farther apart, or another one aside of the line of sight, tell the range "
           "(max_relative_sigma)";
  if (kind == "unlikely") return "see the tf and the clock of its station if others see the target";
  return "the crossings are in `refused` of the report";
}

}  // namespace

void PositionExamination::take(const sightline::PositionReport& report, const std::string& topic) {
  if (reported_.size() >= kMostReportTopics && reported_.count(topic) == 0) return;
  Reported& reported = reported_[topic];
  ++reported.reports;
  reported.incomplete += report.complete ? 0 : 1;
  reported.has_positions |= !report.positions.empty();
  reported.frame = report.header.frame_id;
  for (const StationError& station : report.stations) {
    const auto key = std::make_pair(station.tracker, station.sensor);
    if (reported.stations.size() < kMostStations || reported.stations.count(key) > 0)
      reported.stations[key] = station;
  }
  const core::Time now = toCore(report.header.stamp);
  for (const sightline::UnlocatedTrack& unlocated : report.unlocated) {
    if (reported.tracks.size() >= kMostLocalTracks && reported.tracks.count(unlocated.source) == 0) continue;
    LocalTrack& track = reported.tracks[unlocated.source];
    Lack& lack = track.lacks[unlocated.kind];
    lack.reason = unlocated.reason;
    const bool was_without = track.number_without > 0 && track.number_without + 1 == reported.reports;
    if (was_without) lack.seconds += std::max(0.0, core::seconds(now - track.last_without));
    track.last_without = now;
    track.number_without = reported.reports;
  }
}

std::vector<Finding> PositionExamination::findings() const {
  std::vector<Finding> found;
  for (const auto& [topic, reported] : reported_) {
    if (reported.incomplete > 0) {
      found.push_back({topic, std::to_string(reported.incomplete) + " of " +
                                  std::to_string(reported.reports) +
                                  " reports say that there are more crossings than can be scored at once, so "
                                  "that no new positions are started: raise hypotheses/most_candidates, or "
                                  "lessen the false tracks of the local trackers"});
    }
    findStations(topic, reported, found);
    findUnlocated(topic, reported, found);
  }
  return found;
}

void PositionExamination::findStations(const std::string& topic, const Reported& reported,
                                       std::vector<Finding>& found) {
  std::set<std::string> undecided, said;  // trackers
  for (const auto& [key, station] : reported.stations) {
    if (station.undecided) undecided.insert(station.tracker);
  }
  if (!undecided.empty()) {
    found.push_back({topic,
                     "the clock or the orientation of one of these stations is off, and the targets do "
                     "not tell whose: " +
                         listOf(undecided) +
                         "; synchronise their clocks and see the rotations of their tf, or let a third "
                         "station see the same targets"});
  }
  for (const auto& [key, station] : reported.stations) {
    const std::string of_topic = " in " + topic;
    const std::string sensor = station.sensor == station.tracker || station.sensor.empty()
                                   ? station.tracker
                                   : station.tracker + "/" + station.sensor;
    if (said.insert(station.tracker).second) {  // all sensors of a tracker have one clock and one orientation
      const std::string known = knowledgeOf(station, reported.frame);
      if (station.corrected)
        found.push_back({station.tracker + of_topic,
                         known + ": its directions are put right by that; " + remedyOf(station)});
      else
        found.push_back({station.tracker + of_topic, known, true});
    }
    if (station.slow_scale >= kHarmfulSlowScale) {
      found.push_back(
          {sensor + of_topic,
           "its directions have errors that stay for a while, of " + slowText(station) +
               ", and it counts the less for positions: see its calibration and mounting, and the "
               "rotation of its tf",
           true});
    }
  }
}

void PositionExamination::findUnlocated(const std::string& topic, const Reported& reported,
                                        std::vector<Finding>& found) {
  struct Group {
    std::set<std::string> tracks;
    std::string reason;
  };
  std::map<std::pair<std::string, std::string>, Group> groups;  // by tracker, kind
  std::set<std::string> trackers;
  for (const auto& [source, track] : reported.tracks) {
    for (const auto& [kind, lack] : track.lacks) {
      if (lack.seconds < kLeastLack) continue;
      trackers.insert(localTrackerOf(source));
      Group& group = groups[{localTrackerOf(source), kind}];
      group.tracks.insert(source + " for " + valueOf(lack.seconds, "s"));
      group.reason = lack.reason;
    }
  }
  if (!reported.has_positions && trackers.size() > 1) {
    found.push_back({topic,
                     "no position in any of " + std::to_string(reported.reports) + " reports, though " +
                         listOf(trackers) +
                         " have tracks: do they see the same targets, and are tf (translation and rotation) "
                         "and clocks of these stations right?",
                     true});
  }
  for (const auto& [key, group] : groups) {
    const auto& [tracker, kind] = key;
    found.push_back(
        {tracker + " in " + topic,
         "its " + listOf(group.tracks) + " had no position (" + group.reason + "); " + remedyOf(kind), true});
  }
}

std::vector<Finding> PositionExamination::silentTopics(const GraphView& graph, double seconds) const {
  std::vector<Finding> found;
  for (const GraphView::Topic& topic : positionReportTopics(graph)) {
    if (topic.publishers.empty() || reported_.count(topic.name) > 0) continue;
    found.push_back({topic.name, "is published by " + listOf(topic.publishers) +
                                     ", but no report of positions came within " + valueOf(seconds, "s") +
                                     ": do its track_topics speak, and does tf lead from their frames to its "
                                     "tracking_frame? Its /diagnostics say what it refuses"});
  }
  return found;
}

std::vector<GraphView::Topic> positionReportTopics(const GraphView& graph) {
  std::vector<GraphView::Topic> topics;
  std::copy_if(graph.topics.begin(), graph.topics.end(), std::back_inserter(topics),
               [](const GraphView::Topic& topic) {
                 return topic.type == ros::message_traits::datatype<sightline::PositionReport>();
               });
  return topics;
}

}  // namespace sightline_ros
