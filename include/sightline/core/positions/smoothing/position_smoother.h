#pragma once

#include <optional>
#include <vector>

#include "sightline/core/model/time.h"
#include "sightline/core/positions/position_estimator.h"
#include "sightline/core/positions/smoothing/position_smoothing.h"

namespace sightline::core {

/// Where a target was, by the measurements of several stations before and after, of known correspondence: a
/// pass of PositionEstimator forward, and the recursion of position_smoothing.h back.
///
/// Memory: 30 kB for each of at most 512 measurements, and 45 kB for every 512 of the rest, of which the
/// forward pass is taken twice.
class PositionSmoother {
 public:
  /// Throws std::invalid_argument for a parameter out of range.
  explicit PositionSmoother(const PositionEstimatorParams& params = {});

  /// The positions at `times`, ascending. `measurements`: in order of time; those that the estimator refuses
  /// are left out. `lag`: only measurements up to so many seconds later are used, and up to 1.5 times as many
  /// where that saves work [s], >= 0; nullopt = all. nullopt while the target had no position; after the last
  /// measurement that may be used, what the filter predicts.
  std::vector<std::optional<SmoothedPosition>> smooth(const std::vector<StationMeasurement>& measurements,
                                                      const std::vector<Time>& times,
                                                      std::optional<double> lag = std::nullopt) const;

 private:
  PositionEstimatorParams params_;
};

}  // namespace sightline::core
