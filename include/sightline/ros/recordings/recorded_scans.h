#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include <ros/time.h>
#include <rosbag/bag.h>
#include <sightline/SightingArray.h>

#include "sightline/core/model/time.h"
#include "sightline/core/ordering/scan_queue.h"
#include "sightline/core/ordering/stamp_watch.h"
#include "sightline/ros/recordings/replay.h"

namespace sightline_ros {

/// The sensors of all scans of a recording that a tracker can use. Throws std::runtime_error.
std::set<std::string> sensorsOf(const rosbag::Bag& bag);

/// Scans that are due, in the order in which they are followed.
struct DueScans {
  std::vector<sightline::SightingArray::ConstPtr> before_restart;
  std::optional<sightline::core::Time>
      restart;  ///< the stamps went back: everything starts anew at this time
  std::vector<sightline::SightingArray::ConstPtr> scans;
};

/// Puts the scans of a recording in the order of their stamps, however they arrived within `max_lag`. Drops
/// scans that no tracker could use, and counts them in the summary.
class RecordedScans {
 public:
  /// `max_lag` and `max_future`: the largest of all trackers [s]. `summary` must outlive this.
  RecordedScans(double max_lag, double max_future, ReplaySummary& summary);

  /// Takes a scan of the recording, received at `received`; returns what is due then.
  DueScans take(const sightline::SightingArray::ConstPtr& scan, const ros::Time& received);

  /// The recording is over: returns all that is left.
  DueScans finish();

 private:
  using StampGate = sightline::core::StampGate<sightline::SightingArray::ConstPtr>;
  using Queue = sightline::core::ScanQueue<sightline::SightingArray::ConstPtr>;

  void admit(const StampGate::Result& admitted, DueScans& due);
  void enqueue(const sightline::SightingArray::ConstPtr& scan);

  double max_lag_;     // [s]
  double max_future_;  // [s]
  ReplaySummary& summary_;
  StampGate stamps_;
  Queue queue_;
  std::optional<sightline::core::Time> first_, last_;  // stamps of scans
};

}  // namespace sightline_ros
