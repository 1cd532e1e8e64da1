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

constexpr double kReportPeriod = 1.0;  // of reports in which nothing is new [s]

bool areSameTracks(const std::vector<sightline::SourceTrack>& a,
                   const std::vector<sightline::SourceTrack>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const sightline::SourceTrack& one, const sightline::SourceTrack& other) {
                      return one.id == other.id && one.tracker == other.tracker;
                    });
}

bool areSameVerdicts(const std::vector<sightline::SensorHealth>& a,
                     const std::vector<sightline::SensorHealth>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const sightline::SensorHealth& one, const sightline::SensorHealth& other) {
                      return one.sensor == other.sensor && one.verdict == other.verdict &&
                             one.undecided == other.undecided;
                    });
}

/// Whether the same local tracks make the same global tracks, with the same verdicts on the sensors. Which
/// ones belong to none changes all the time where there is clutter.
bool saySame(const sightline::FusionReport& a, const sightline::FusionReport& b) {
  return std::equal(a.tracks.begin(), a.tracks.end(), b.tracks.begin(), b.tracks.end(),
                    [](const sightline::FusedTrack& one, const sightline::FusedTrack& other) {
                      return one.id == other.id && one.rule == other.rule &&
                             areSameTracks(one.sources, other.sources) &&
                             areSameTracks(one.left_out, other.left_out) &&
                             areSameVerdicts(one.sensors, other.sensors) && other.sensor_changes.empty();
                    });
}

/// Whether a topic has this name, in which a * at the end stands for any rest.
bool isNamed(const std::string& topic, const std::string& name) {
  if (name.empty() || name.back() != '*') return topic == name;
  return topic.compare(0, name.size() - 1, name, 0, name.size() - 1) == 0;
}

}  // namespace

ReplayOutput::ReplayOutput(rosbag::Bag& out, ReplaySummary& summary, const std::vector<std::string>& wanted,
                           bool all)
    : out_(out),
      summary_(summary),
      replaced_({kFusedTracks, kFusionReport, kReplayParameters}),
      is_complete_(all || !wanted.empty()) {
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

void ReplayOutput::slowDown(const TrackerTopics& topics) {
  if (is_complete_) return;
  for (const std::string& tracks : {topics.tracks, topics.smoothed}) slow_[tracks] = ros::Time();
}

/// Whether a message with this stamp is written, with what belongs to it.
bool ReplayOutput::isDue(const std::string& tracks_topic, const ros::Time& stamp) {
  const auto last = slow_.find(tracks_topic);
  if (last == slow_.end()) return true;
  const bool is_due =
      stamp < last->second || last->second.isZero() || stamp - last->second >= ros::Duration(1.0 / kSlowRate);
  if (is_due) last->second = stamp;
  return is_due;
}

bool ReplayOutput::isNews(const sightline::FusionReport::ConstPtr& report) {
  const bool is_news = last_report_ == nullptr || !saySame(*last_report_, *report) ||
                       report->header.stamp < last_report_->header.stamp ||  // time has gone back
                       report->header.stamp - last_report_->header.stamp >= ros::Duration(kReportPeriod);
  if (is_news) last_report_ = report;
  return is_news;
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
  const bool is_due = !report.tracks || isDue(topics.tracks, report.tracks->header.stamp);
  if (is_due) say(topics.associations, bagTime(report.scan->header.stamp), report.associations);
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
  if (is_due)
    write(*report.tracks, topics.tracks);
  else
    summary_.left_out_messages += 2;
}

void ReplayOutput::write(const sightline::TrackletArray& tracklets, const TrackerTopics& topics) {
  if (is_complete_)
    say(topics.tracklets, bagTime(tracklets.header.stamp), tracklets);
  else
    ++summary_.left_out_messages;
}

void ReplayOutput::writeSmoothed(const std::vector<sightline::TrackArray>& tracks,
                                 const TrackerTopics& topics) {
  for (const sightline::TrackArray& message : tracks) {
    if (isDue(topics.smoothed, message.header.stamp))
      write(message, topics.smoothed);
    else
      ++summary_.left_out_messages;
  }
}

void ReplayOutput::writeSmoothed(const std::vector<sightline::PositionTrackArray>& positions) {
  for (const sightline::PositionTrackArray& message : positions) {
    say(kSmoothedPositions, bagTime(message.header.stamp), message);
    ++summary_.track_messages;
  }
}

void ReplayOutput::write(const FusionResult& fused, const ros::Time& stamp) {
  if (is_complete_ || isNews(fused.report))
    say(kFusionReport, bagTime(stamp), fused.report);
  else
    ++summary_.left_out_messages;
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
