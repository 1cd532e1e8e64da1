#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <ros/time.h>
#include <rosbag/bag.h>
#include <sightline/SightingArray.h>

#include "sightline/core/model/time.h"
#include "sightline/core/ordering/arrival_survey.h"
#include "sightline/core/ordering/scan_queue.h"
#include "sightline/core/ordering/stamp_watch.h"
#include "sightline/ros/recordings/replay.h"

namespace sightline_ros {

/// What is to be known of a recording before its first scan is followed.
struct RecordingSurvey {
  std::set<std::string> sensors;          ///< of the scans that a tracker can use
  sightline::core::ArrivalPlan arrivals;  ///< how these came in
};

/// Reads all scans of a recording. Throws std::runtime_error.
RecordingSurvey surveyOf(const rosbag::Bag& bag);

/// How the scans of a recording are put in the order of their stamps.
struct RecordedOrder {
  double max_lag = 0.5;     ///< by how much stamps may step back, before it counts as a jump [s]
  double most_late = 0.5;   ///< a scan that comes so much later than newer ones is dropped [s]
  double max_future = 0.1;  ///< a scan whose stamp is ahead of its arrival by more is dropped [s]
  sightline::core::ArrivalPlan arrivals;  ///< delays that are taken away from the sensors' times of arrival
};

/// As live trackers do, which cannot wait.
RecordedOrder liveOrder(double max_lag, double max_future);

/// As far as can be known when the recording is over: no sensor is late, whatever the time after its stamps
/// at which its scans were recorded, up to a minute.
RecordedOrder orderInHindsight(double max_lag, double max_future,
                               const sightline::core::ArrivalPlan& arrivals);

/// Scans that are due, in the order in which they are followed.
struct DueScans {
  std::vector<sightline::SightingArray::ConstPtr> before_restart;
  std::optional<sightline::core::Time>
      restart;  ///< the stamps went back: everything starts anew at this time
  std::vector<sightline::SightingArray::ConstPtr> scans;
};

/// Puts the scans of a recording in the order of their stamps, however they arrived. Drops scans that no
/// tracker could use, and counts them in the summary.
class RecordedScans {
 public:
  /// `summary` must outlive this.
  RecordedScans(RecordedOrder order, ReplaySummary& summary);

  /// Takes a scan of the recording, received at `received`; returns what is due then.
  DueScans take(const sightline::SightingArray::ConstPtr& scan, const ros::Time& received);

  /// The recording is over: returns what is left up to the next restart; all of it when there is none.
  DueScans finish();

 private:
  using StampGate = sightline::core::StampGate<sightline::SightingArray::ConstPtr>;
  using Queue = sightline::core::ScanQueue<sightline::SightingArray::ConstPtr>;

  void admitUpTo(sightline::core::Time arrival, DueScans& due);
  void admit(const StampGate::Result& admitted, DueScans& due);
  void enqueue(const sightline::SightingArray::ConstPtr& scan);
  void drop(const sightline::SightingArray& scan, const std::string& reason, const std::string& detail);

  RecordedOrder order_;
  ReplaySummary& summary_;
  std::multimap<sightline::core::Time, sightline::SightingArray::ConstPtr>
      arriving_;  // by the time of arrival without the sensor's delay
  StampGate stamps_;
  Queue queue_;
  std::optional<sightline::core::Time> first_, last_;  // stamps of scans
};

}  // namespace sightline_ros
