#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include <sightline/PositionTrackArray.h>

#include "sightline/core/positions/smoothing/position_smoother.h"
#include "sightline/ros/components/position_tracker_component.h"

namespace sightline_ros {

/// The positions of a replay, smoothed when it is over: what the position tracker said, and the measurements
/// of which each position came, are kept until then.
class SmoothedPositions {
 public:
  /// `estimator`: of the position tracker. `lag`: as in PositionSmoother [s]; nullopt = all measurements.
  SmoothedPositions(const sightline::core::PositionEstimatorParams& estimator, std::optional<double> lag);

  /// Keeps what the tracker, which has been told to `keepMeasurements`, says of a message.
  void keep(const PositionResult& result);
  void keep(const std::vector<sightline::core::TakenMeasurement>& taken);

  /// The tracker's messages in their order with smoothed position, velocity and covariance; all else is as
  /// the tracker said, and so is a position at a time for which the smoother has none.
  std::vector<sightline::PositionTrackArray> smooth() const;

 private:
  sightline::core::PositionSmoother smoother_;
  std::optional<double> lag_;
  std::vector<sightline::PositionTrackArray::ConstPtr> tracks_;
  std::map<std::uint32_t, std::vector<sightline::core::StationMeasurement>> measurements_;  // by id, by time
};

}  // namespace sightline_ros
