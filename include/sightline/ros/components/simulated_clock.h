#pragma once

#include <algorithm>
#include <optional>

#include "sightline/core/model/time.h"

namespace sightline_ros {

/// Simulated time as it goes on, and whether it has gone back: a recording in a loop.
class SimulatedClock {
 public:
  /// It is `now`. By how much it has gone back [s] when that is more than `tolerance` [s]; time counts from
  /// there then. nullopt else: a smaller step is none, but several small ones in a row add up.
  std::optional<double> stepBack(sightline::core::Time now, double tolerance) {
    const double back = sightline::core::seconds(latest_ - now);
    latest_ = back > tolerance ? now : std::max(latest_, now);
    return back > tolerance ? std::optional<double>(back) : std::nullopt;
  }

 private:
  sightline::core::Time latest_{};  // since it went back last
};

}  // namespace sightline_ros
