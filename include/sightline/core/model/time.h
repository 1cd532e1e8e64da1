#pragma once

#include <chrono>
#include <cmath>
#include <cstdint>

namespace sightline::core {

/// The time line on which sightings are stamped. It has no now(): time comes in with the data.
struct StampClock {
  using duration = std::chrono::nanoseconds;
  using rep = duration::rep;
  using period = duration::period;
  using time_point = std::chrono::time_point<StampClock>;
  static constexpr bool is_steady = false;
};

/// A stamp, nanoseconds since the epoch of the data (ROS: 1970).
using Time = StampClock::time_point;
using Duration = StampClock::duration;

/// Length of a duration [s].
inline double seconds(Duration duration) {
  return std::chrono::duration<double>(duration).count();
}

/// The duration nearest to a length [s].
inline Duration durationOf(double length_s) {
  return Duration(static_cast<std::int64_t>(std::llround(length_s * 1e9)));
}

/// The stamp `since_epoch_ns` nanoseconds after the epoch.
inline Time timeOf(std::int64_t since_epoch_ns) {
  return Time(Duration(since_epoch_ns));
}

}  // namespace sightline::core
