#include "sightline/ros/recordings/recorded_scans.h"

#include <algorithm>
#include <cstdint>
#include <stdexcept>

#include <ros/serialization.h>
#include <rosbag/view.h>

#include "sightline/ros/messages/conversions.h"
#include "sightline/ros/messages/framed_scan.h"

namespace sightline_ros {

namespace core = sightline::core;
using sightline::SightingArray;

namespace {

core::StampWatchParams stampWatchParams(double max_lag) {
  core::StampWatchParams params;
  params.max_lag = max_lag;
  return params;
}

/// The bytes of a message: they order two scans of one sensor and instant.
std::string bytesOf(const SightingArray& scan) {
  std::string bytes(ros::serialization::serializationLength(scan), '\0');
  ros::serialization::OStream stream(reinterpret_cast<std::uint8_t*>(&bytes[0]),
                                     static_cast<std::uint32_t>(bytes.size()));
  ros::serialization::serialize(stream, scan);
  return bytes;
}

}  // namespace

std::set<std::string> sensorsOf(const rosbag::Bag& bag) {
  std::set<std::string> sensors;
  rosbag::View view(bag, rosbag::TypeQuery(ros::message_traits::datatype<SightingArray>()));
  for (const rosbag::MessageInstance& instance : view) {
    const auto scan = instance.instantiate<SightingArray>();
    if (!scan)
      throw std::runtime_error(instance.getTopic() +
                               " was recorded with another definition of SightingArray");
    if (!refusalOf(*scan)) sensors.insert(scan->sensor);
  }
  return sensors;
}

RecordedScans::RecordedScans(double max_lag, double max_future, ReplaySummary& summary)
    : max_lag_(max_lag),
      max_future_(max_future),
      summary_(summary),
      stamps_(stampWatchParams(max_lag)),
      queue_(max_lag) {}

/// A scan that no tracker could use does not reach the stamp watch: it must not disturb the order of the
/// others.
DueScans RecordedScans::take(const SightingArray::ConstPtr& scan, const ros::Time& received) {
  ++summary_.scans;
  summary_.sightings += scan->sightings.size();
  const core::Time stamp = toCore(scan->header.stamp);
  DueScans due;
  if (const auto refusal = refusalOf(*scan)) {
    ++summary_.drops["recording: scan dropped, " + refusal->kind];
  } else if (core::seconds(stamp - toCore(received)) > max_future_) {
    ++summary_.drops["recording: scan dropped, stamped more than max_future after it was received"];
  } else {
    admit(stamps_.take(scan->sensor, stamp, scan, toCore(received)), due);
  }
  due.scans = queue_.release();
  return due;
}

DueScans RecordedScans::finish() {
  DueScans due;
  admit(stamps_.finish(), due);
  due.scans = queue_.releaseAll();
  return due;
}

void RecordedScans::admit(const StampGate::Result& admitted, DueScans& due) {
  summary_.notices.insert(summary_.notices.end(), admitted.notices.begin(), admitted.notices.end());
  if (admitted.went_back) {
    due.before_restart = queue_.releaseAll();
    due.restart = toCore(admitted.passed.back().item->header.stamp);
    queue_ = Queue(max_lag_);
  }
  for (const StampGate::Passed& passed : admitted.passed) {
    if (!passed.refusal)
      enqueue(passed.item);
    else
      ++summary_.drops["recording: scan dropped, its stamp is ahead of the other sensors'"];
  }
}

void RecordedScans::enqueue(const SightingArray::ConstPtr& scan) {
  const core::Time stamp = toCore(scan->header.stamp);
  if (!queue_.add({stamp, scan->sensor, bytesOf(*scan)}, scan)) {
    ++summary_.drops["recording: scan dropped, later than max_lag"];
    return;
  }
  first_ = std::min(first_.value_or(stamp), stamp);
  last_ = std::max(last_.value_or(stamp), stamp);
  summary_.recorded = core::seconds(*last_ - *first_);
}

}  // namespace sightline_ros
