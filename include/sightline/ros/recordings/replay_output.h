#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include <rosbag/bag.h>
#include <rosbag/message_instance.h>
#include <sightline/FusionReport.h>
#include <sightline/PositionTrackArray.h>
#include <sightline/TrackArray.h>
#include <sightline/TrackletArray.h>

#include "sightline/ros/components/local_tracker_component.h"
#include "sightline/ros/components/position_tracker_component.h"
#include "sightline/ros/components/track_fusion_component.h"
#include "sightline/ros/recordings/replay.h"

namespace sightline_ros {

/// Of the tracks that nobody goes on with, unless everything is to be written [1/s].
constexpr double kSlowRate = 10.0;

/// The topics on which a local tracker publishes.
struct TrackerTopics {
  explicit TrackerTopics(const std::string& space)
      : tracks(space + "/tracks"),
        tracklets(space + "/tracklets"),
        associations(space + "/associations"),
        smoothed(space + "/tracks_smoothed") {}

  std::string tracks, tracklets, associations, smoothed;
};

/// Writes the bag of a replay and counts in its summary what is written.
class ReplayOutput {
 public:
  /// Bag and summary must outlive this. `wanted`: as ReplaySettings::topics; `all`: likewise.
  ReplayOutput(rosbag::Bag& out, ReplaySummary& summary, const std::vector<std::string>& wanted, bool all);

  /// The replay publishes on these topics: recorded messages on them are not copied.
  void replace(const TrackerTopics& topics);

  /// Nobody goes on with what this tracker says: unless everything is to be written, it is at most
  /// `kSlowRate` times a second.
  void slowDown(const TrackerTopics& topics);

  /// What the replay was told, as `parametersText` gives it, at the time of the recording's first message.
  void writeParameters(const std::string& text, const ros::Time& begin);

  /// The replay publishes positions: recorded ones are not copied.
  void replacePositions();

  /// Copies a recorded message, unless its topic is replaced.
  void copy(const rosbag::MessageInstance& message);

  /// What a tracker, named `tracker`, made of a scan.
  void write(const TrackerReport& report, const std::string& tracker, const TrackerTopics& topics);
  void write(const sightline::TrackletArray& tracklets, const TrackerTopics& topics);

  /// Smoothed tracks, in order of time.
  void writeSmoothed(const std::vector<sightline::TrackArray>& tracks, const TrackerTopics& topics);

  /// Smoothed positions, likewise.
  void writeSmoothed(const std::vector<sightline::PositionTrackArray>& positions);

  /// What the fusion made of tracks with this stamp.
  void write(const FusionResult& fused, const ros::Time& stamp);

  /// The positions that came of a message, if any.
  void write(const PositionResult& positions);

  /// Says in the summary on which of the wanted topics nothing was written.
  void noteUnwritten();

 private:
  template <typename Message>
  void say(const std::string& topic, const ros::Time& time, const Message& message);
  void write(const sightline::TrackArray& tracks, const std::string& topic);
  bool isDue(const std::string& tracks_topic, const ros::Time& stamp);
  bool isNews(const sightline::FusionReport::ConstPtr& report);

  rosbag::Bag& out_;
  ReplaySummary& summary_;
  std::set<std::string> replaced_;         // topics
  std::map<std::string, bool> wanted_;     // and whether anything was written on them; none = all topics are
  bool is_complete_;                       // every message is written
  std::map<std::string, ros::Time> slow_;  // last message written, by topic of tracks; 0 = none
  sightline::FusionReport::ConstPtr last_report_;  // that was written
};

}  // namespace sightline_ros
