#include "sightline/ros/recordings/replay_output.h"

#include <algorithm>
#include <iomanip>
#include <sstream>
#include <utility>

#include <std_msgs/String.h>

#include "sightline/ros/components/local_tracker_health.h"
#include "sightline/ros/recordings/replay_parameters.h"

namespace sightline_ros {
namespace {

const char* const kFusedTracks = "/fusion/tracks";
const char* const kFusionReport = "/fusion/report";
const char* const kPositionTracks = "/positions/tracks";
const char* const kSmoothedPositions = "/positions/tracks_smoothed";
const char* const kPositionReport = "/positions/report";
const char* const kPositionPoses = "/positions/poses";

/// The time of a message with this stamp in a bag, which cannot hold time 0.
ros::Time bagTime(const ros::Time& stamp) {
  return std::max(stamp, ros::TIME_MIN);
}

/// Whether a topic has this name, in which a * at the end stands for any rest.
bool isNamed(const std::string& topic, const std::string& name) {
  if (name.empty() || name.back() != '*') return topic == name;
  return topic.compare(0, name.size() - 1, name, 0, name.size() - 1) == 0;
}

}  // namespace

ReplayOutput::ReplayOutput(rosbag::Bag& out, ReplaySummary& summary, const std::vector<std::string>& wanted)
    : out_(out), summary_(summary), replaced_({kFusedTracks, kFusionReport, kReplayParameters}) {
  for (const std::string& topic : wanted) wanted_[topic] = false;
}

/// Writes the message if its topic is wanted.
template <typename Message>
void ReplayOutput::say(const std::string& topic, const ros::Time& time, const Message& message) {
  bool is_wanted = wanted_.empty();
  for (auto& [name, is_written] : wanted_) {
    if (!isNamed(topic, name)) continue;
    is_wanted = is_written = true;
  }
  if (is_wanted) out_.write(topic, time, message);
}

void ReplayOutput::noteUnwritten() {
  for (const auto& [name, is_written] : wanted_) {
    if (is_written) continue;
    summary_.notices.push_back("nothing was written on \"" + name +
                               "\" (--topics): no tracker, fusion or position says anything there");
  }
}

void ReplayOutput::replace(const TrackerTopics& topics) {
  replaced_.insert({topics.tracks, topics.tracklets, topics.associations, topics.smoothed});
}

void ReplayOutput::writeParameters(const std::string& text, const ros::Time& begin) {
  std_msgs::String message;
  message.data = text;
  out_.write(kReplayParameters, bagTime(begin), message);
}

void ReplayOutput::replacePositions() {
  replaced_.insert({kPositionTracks, kSmoothedPositions, kPositionReport, kPositionPoses});
}

void ReplayOutput::copy(const rosbag::MessageInstance& message) {
  if (replaced_.count(message.getTopic()) > 0) return;
  out_.write(message.getTopic(), message.getTime(), message, message.getConnectionHeader());
  ++summary_.copied_messages;
}

void ReplayOutput::write(const TrackerReport& report, const std::string& tracker,
                         const TrackerTopics& topics) {
  say(topics.associations, bagTime(report.scan->header.stamp), report.associations);
  if (!report.tracks) {
    summary_.noteDrop(tracker + ": scan dropped, " + report.refusal->kind,
                      exampleOf(*report.scan, report.refusal->detail));
    return;
  }
  if (report.rejected > 0) {
    summary_.noteDrop(tracker + ": sightings rejected",
                      exampleOf(*report.scan, firstRejection(*report.associations)), report.rejected);
  }
  if (report.tracklets) write(*report.tracklets, topics);
  write(*report.tracks, topics.tracks);
}

void ReplayOutput::write(const sightline::TrackletArray& tracklets, const TrackerTopics& topics) {
  say(topics.tracklets, bagTime(tracklets.header.stamp), tracklets);
}

void ReplayOutput::writeSmoothed(const std::vector<sightline::TrackArray>& tracks,
                                 const TrackerTopics& topics) {
  for (const sightline::TrackArray& message : tracks) write(message, topics.smoothed);
}

void ReplayOutput::writeSmoothed(const std::vector<sightline::PositionTrackArray>& positions) {
  for (const sightline::PositionTrackArray& message : positions) {
    say(kSmoothedPositions, bagTime(message.header.stamp), message);
    ++summary_.track_messages;
  }
}

void ReplayOutput::write(const FusionResult& fused, const ros::Time& stamp) {
  say(kFusionReport, bagTime(stamp), fused.report);
  if (fused.tracks) write(*fused.tracks, kFusedTracks);
}

void ReplayOutput::write(const PositionResult& positions) {
  if (!positions.tracks) return;
  const ros::Time time = bagTime(positions.tracks->header.stamp);
  say(kPositionTracks, time, positions.tracks);
  say(kPositionReport, time, positions.report);
  say(kPositionPoses, time, positions.poses);
  ++summary_.track_messages;
}

void ReplayOutput::write(const sightline::TrackArray& tracks, const std::string& topic) {
  say(topic, bagTime(tracks.header.stamp), tracks);
  ++summary_.track_messages;
}

void ReplaySummary::noteDrop(const std::string& reason, const std::string& example, std::size_t count) {
  drops[reason] += count;
  if (!example.empty()) examples.try_emplace(reason, example);
}

std::string exampleOf(const sightline::SightingArray& scan, const std::string& detail) {
  if (detail.empty()) return "";
  std::ostringstream words;
  words << "of " << scan.sensor << " at " << std::fixed << std::setprecision(3) << scan.header.stamp.toSec()
        << " s in frame \"" << scan.header.frame_id << "\": " << detail;
  return words.str();
}

}  // namespace sightline_ros
