#include "sightline/ros/recordings/recorded_scans.h"

#include <algorithm>
#include <cstdint>
#include <stdexcept>
#include <utility>

#include <ros/serialization.h>
#include <rosbag/view.h>

#include "sightline/report/value_text.h"
#include "sightline/ros/messages/conversions.h"
#include "sightline/ros/messages/framed_scan.h"
#include "sightline/ros/recordings/bags.h"

namespace sightline_ros {

namespace core = sightline::core;
using sightline::SightingArray;
using sightline::report::valueOf;

namespace {

constexpr double kMostDelay =
    60.0;  // of a sensor's scans behind the others', of which nothing is dropped [s]
constexpr double kJitterMargin = 1.5;  // over the usual change of the latency

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

RecordingSurvey surveyOf(const rosbag::Bag& bag) {
  RecordingSurvey survey;
  core::ArrivalSurvey arrivals(kMostDelay);
  rosbag::View view(bag, rosbag::TypeQuery(ros::message_traits::datatype<SightingArray>()));
  for (const rosbag::MessageInstance& instance : view) {
    const auto scan = messageIn<SightingArray>(instance);
    if (!scan)
      throw std::runtime_error(instance.getTopic() +
                               " was recorded with another definition of SightingArray");
    if (refusalOf(*scan)) continue;
    survey.sensors.insert(scan->sensor);
    arrivals.take(scan->sensor, toCore(scan->header.stamp), toCore(instance.getTime()));
  }
  survey.arrivals = arrivals.plan();
  return survey;
}

RecordedOrder liveOrder(double max_lag, double max_future) {
  return {max_lag, max_lag, max_future, {}};
}

RecordedOrder orderInHindsight(double max_lag, double max_future, const core::ArrivalPlan& arrivals) {
  const double jitter = kJitterMargin * arrivals.jitter;
  return {std::max(max_lag, jitter), std::max(max_lag, kMostDelay), max_future + arrivals.ahead + jitter,
          arrivals};
}

RecordedScans::RecordedScans(RecordedOrder order, ReplaySummary& summary)
    : order_(std::move(order)),
      summary_(summary),
      stamps_(stampWatchParams(order_.max_lag)),
      queue_(order_.most_late) {}

/// A scan that no tracker could use does not reach the stamp watch: it must not disturb the order of the
/// others.
DueScans RecordedScans::take(const SightingArray::ConstPtr& scan, const ros::Time& received) {
  ++summary_.scans;
  summary_.sightings += scan->sightings.size();
  const core::Time arrival = toCore(received) - core::durationOf(order_.arrivals.delayOf(scan->sensor));
  const double ahead = core::seconds(toCore(scan->header.stamp) - arrival);
  DueScans due;
  if (const auto refusal = refusalOf(*scan)) {
    drop(*scan, refusal->kind, refusal->detail);
  } else if (ahead > order_.max_future) {
    drop(*scan, "stamped more than max_future after it was received",
         valueOf(ahead, "s") +
             " ahead of the recorder's clock: synchronise the sensor's clock, or raise max_future");
  } else {
    arriving_.emplace(arrival, scan);
  }
  admitUpTo(toCore(received) - core::durationOf(order_.arrivals.longestDelay()), due);
  due.scans = queue_.release();
  return due;
}

DueScans RecordedScans::finish() {
  DueScans due;
  admitUpTo(core::Time::max(), due);
  if (!due.restart) admit(stamps_.finish(), due);
  if (arriving_.empty()) due.scans = queue_.releaseAll();
  return due;
}

/// The scans that no other can precede any more in the order of arrival; up to a restart.
void RecordedScans::admitUpTo(core::Time arrival, DueScans& due) {
  while (!arriving_.empty() && arriving_.begin()->first <= arrival && !due.restart) {
    const auto first = arriving_.begin();
    const SightingArray::ConstPtr scan = first->second;
    admit(stamps_.take(scan->sensor, toCore(scan->header.stamp), scan, first->first), due);
    arriving_.erase(first);
  }
}

void RecordedScans::admit(const StampGate::Result& admitted, DueScans& due) {
  summary_.notices.insert(summary_.notices.end(), admitted.notices.begin(), admitted.notices.end());
  if (admitted.went_back) {
    due.before_restart = queue_.releaseAll();
    due.restart = toCore(admitted.passed.back().item->header.stamp);
    queue_ = Queue(order_.most_late);
  }
  for (const StampGate::Passed& passed : admitted.passed) {
    if (!passed.refusal)
      enqueue(passed.item);
    else
      drop(*passed.item, "its stamp is ahead of the other sensors'", passed.refusal->detail);
  }
}

void RecordedScans::enqueue(const SightingArray::ConstPtr& scan) {
  const core::Time stamp = toCore(scan->header.stamp);
  if (!queue_.add({stamp, scan->sensor, bytesOf(*scan)}, scan)) {
    drop(*scan, "later than max_lag",
         "it came more than " + valueOf(order_.most_late, "s") +
             " after newer ones: synchronise the sensor's clock, or raise max_lag");
    return;
  }
  first_ = std::min(first_.value_or(stamp), stamp);
  last_ = std::max(last_.value_or(stamp), stamp);
  summary_.recorded = core::seconds(*last_ - *first_);
}

void RecordedScans::drop(const SightingArray& scan, const std::string& reason, const std::string& detail) {
  summary_.noteDrop("recording: scan dropped, " + reason, exampleOf(scan, detail));
}

}  // namespace sightline_ros
