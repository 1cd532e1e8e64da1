#pragma once

#include <array>
#include <optional>

#include "sightline/core/model/time.h"
#include "sightline/core/positions/position_belief.h"
#include "sightline/core/positions/rays.h"
#include "sightline/core/positions/stations/seen_stations.h"

namespace sightline::core {

/// Measurements of a target that has no position yet: they wait until those of two stations cross well. A
/// value; of more than `kMostWaiting` the oldest is forgotten.
class PositionStart {
 public:
  static constexpr int kMostWaiting = 32;

  /// `window`: directions of so long before are used [s], > 0. `max_relative_sigma`: largest standard
  /// deviation over the range with which a position is one [1].
  PositionStart(double window, double max_relative_sigma)
      : window_(window), max_relative_sigma_(max_relative_sigma) {}

  /// One more measurement, not before the last one; those older than the window are forgotten.
  void wait(const StationMeasurement& measurement);

  /// What a crossing of all that wait says of the target at `now`, without slots for slow errors (P-2);
  /// nullopt when there is none, or the rays contradict each other.
  std::optional<PositionBelief> startAt(Time now) const;

  void clear() { count_ = 0; }

  /// Of the last measurement that waits.
  std::optional<Time> newest() const;

 private:
  std::optional<Ray> rayAt(int station, Time now) const;

  double window_, max_relative_sigma_;
  std::array<StationMeasurement, kMostWaiting> waiting_;  // the newest, oldest first
  int count_ = 0;
};

}  // namespace sightline::core
