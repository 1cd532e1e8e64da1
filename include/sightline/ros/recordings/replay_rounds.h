#pragma once

#include <cstddef>
#include <deque>
#include <future>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <ros/time.h>
#include <sightline/SightingArray.h>
#include <sightline/TrackletArray.h>

#include "sightline/core/model/time.h"
#include "sightline/ros/components/local_tracker_component.h"
#include "sightline/ros/components/track_fusion_component.h"
#include "sightline/ros/recordings/replay_output.h"
#include "sightline/ros/recordings/smoothed_tracks.h"
#include "sightline/ros/recordings/task_thread.h"

namespace sightline_ros {

/// A local tracker of a replay, and where its messages go.
struct ReplayTracker {
  LocalTrackerComponent component;
  TrackerTopics topics;
  std::optional<SmoothedTracks> smoothed;  // where they are to be smoothed
  bool is_used = false;                    // its tracks go to the fusion or to the position tracker
};

using ReplayTrackers = std::map<std::string, ReplayTracker>;

/// Tracklets that waited for a scan that did not come, of each tracker that has some.
using OverdueTracklets = std::vector<std::pair<ReplayTracker*, sightline::TrackletArray::Ptr>>;

/// As a node would by its clock: for trackers whose scans end or pause.
OverdueTracklets overdueOf(ReplayTrackers& trackers, sightline::core::Time now);

/// Until when a live tracker would have waited for the scan's transform; here the wait costs nothing.
sightline::core::Time endOfWait(const ReplayTracker& tracker, const sightline::SightingArray::ConstPtr& scan);

/// What comes of one scan.
struct ReplayRound {
  sightline::SightingArray::ConstPtr scan;
  std::string topic;                   ///< of the scan
  ReplayTracker* of_sensor = nullptr;  ///< never null
  ReplayTracker* of_group = nullptr;   ///< null where the sensor is alone
  OverdueTracklets overdue_of_groups, overdue_of_sensors;
  std::vector<TrackerReport> by_sensor, by_group;
  std::vector<std::pair<FusionResult, ros::Time>> fused;  ///< with the stamps of what was fused
};

/// The rounds of a replay that are under way: the trackers of the sensors, those of the groups and the fusion
/// work in a thread each, one scan after the other, so that each is given what it would be given by one
/// thread, in the same order. The transforms that they look up must not change before `waitForAll`.
class ReplayRounds {
 public:
  /// Rounds that are under way at a time.
  static constexpr std::size_t kMost = 64;

  /// All must outlive this. `fusion`: null where what the trackers say goes elsewhere; then overdue tracklets
  /// are left to the caller, too.
  ReplayRounds(ReplayTrackers& sensors, ReplayTrackers& groups, TrackFusionComponent* fusion)
      : sensors_(sensors), groups_(groups), fusion_(fusion) {}

  /// Begins with the sensor's tracker, and with the fusion of what it says.
  void begin(const sightline::SightingArray::ConstPtr& scan, const std::string& topic,
             ReplayTracker& of_sensor);

  /// Goes on with the tracker of the group, in the round that was begun last.
  void beginGroup(ReplayTracker& of_group);

  std::size_t count() const { return rounds_.size(); }

  /// Until nothing is under way. Throws what a tracker or the fusion threw; so does `takeFirst`.
  void waitForAll();

  /// The oldest round, when it is done.
  std::unique_ptr<ReplayRound> takeFirst();

 private:
  struct UnderWay {
    std::unique_ptr<ReplayRound> round;
    std::vector<std::shared_future<void>> tasks;
  };

  void fuse(ReplayRound& round);

  ReplayTrackers& sensors_;
  ReplayTrackers& groups_;
  TrackFusionComponent* fusion_;
  std::deque<UnderWay> rounds_;
  TaskThread sensors_thread_, groups_thread_, fusion_thread_;  // the last: they use the others
};

}  // namespace sightline_ros
