#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "sightline/core/model/sphere.h"
#include "sightline/core/model/time.h"

namespace sightline::core {

/// Where the next sighting of a track is expected, in the coordinates of whoever computed it.
struct Gate {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();          ///< predicted (azimuth, elevation) [rad]
  Eigen::Vector2d half_width = Eigen::Vector2d::Zero();      ///< the paper's rectangle [rad]
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity();  ///< of the innovation, S [rad^2]
};

enum class TrackStatus : std::uint8_t { tentative = 0, confirmed = 1, coasting = 2 };

/// A track as it leaves a tracker or a fusion; the fields of sightline/Track. Angles and rates in the
/// tracking frame, azimuth in (-pi, pi].
struct Track {
  std::uint32_t id = 0;  ///< never reused within a run
  TrackStatus status = TrackStatus::tentative;
  AngularState state;
  Gate gate;  ///< where the next sighting is expected, at the time of the report
  Time last_sighting{};
  std::uint32_t hits = 0;
  std::uint32_t misses = 0;                                     ///< since the last hit
  double existence = std::numeric_limits<double>::quiet_NaN();  ///< probability, NaN = not computed
  std::vector<std::string> sources;  ///< sensors, or trackers, that support the state, sorted
};

/// What happened to a sighting.
enum class Decision : std::uint8_t {
  accepted = 0,
  outside_gate = 1,
  claimed_by_other = 2,
  started_track = 3,
  rejected_input = 4
};

/// Why a sighting was taken or not: the fields of sightline/Association.
struct Association {
  std::uint32_t sighting = 0;  ///< index within the scan
  std::uint32_t track =
      0;  ///< the track meant by `decision`: the taker, the nearest, the claimed, the started; 0 = none
  Eigen::Vector2d innovation =
      Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());  ///< [rad]
  Eigen::Matrix2d covariance =
      Eigen::Matrix2d::Constant(std::numeric_limits<double>::quiet_NaN());  ///< S [rad^2]
  double distance_squared = std::numeric_limits<double>::quiet_NaN();
  double threshold = std::numeric_limits<double>::quiet_NaN();  ///< largest accepted distance_squared
  Decision decision = Decision::outside_gate;
  std::string reason;  ///< only for rejected input
};

}  // namespace sightline::core
