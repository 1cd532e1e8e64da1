#pragma once

#include <string>
#include <tuple>
#include <vector>

#include <Eigen/Core>

#include "sightline/core/model/sighting.h"
#include "sightline/core/sensors/lone_sightings.h"

namespace sightline::core {

/// How the noise of each sensor is learned in one tracker.
struct NoiseCalibrationParams {
  bool enabled = true;
  double trust = 30.0;      ///< sightings that a sensor's stated covariance counts for at first, > 0
  double settled = 300.0;   ///< sightings that count at last, >= trust
  double min_scale = 1e-3;  ///< least variance over the stated one, in (0, 1]
  double max_scale = 1e2;   ///< largest, >= 1

  friend bool operator==(const NoiseCalibrationParams& a, const NoiseCalibrationParams& b) {
    return std::tie(a.enabled, a.trust, a.settled, a.min_scale, a.max_scale) ==
           std::tie(b.enabled, b.trust, b.settled, b.min_scale, b.max_scale);
  }
};

/// What is known of one sensor's noise.
struct CalibratedSensor {
  std::string sensor;
  double scale = 1.0;      ///< variance of its sightings' white noise over the stated one
  double sightings = 0.0;  ///< on which that rests
  double start = 1.0;      ///< where that started: far from 1 where the stated noise cannot be right
  LoneSightings lone;
};

/// One noise scale for each sensor, learned slowly from the innovations of all mature tracks (S-45).
/// Estimators learn the scale of a track's sightings quickly and for all its sensors together; what they find
/// passes over into the sensors' scales, so that sensors get their right weight against each other, and a new
/// track starts with what others have learned. Plain state, copied with the tracker's.
class NoiseCalibration {
 public:
  /// Throws std::invalid_argument for parameters out of range.
  explicit NoiseCalibration(const NoiseCalibrationParams& params);

  /// Whether it learns from now on; switching it off forgets what it has learnt, so that the stated variances
  /// count.
  void enable(bool enabled);

  /// Factor on the sensor's stated variances.
  double scale(const std::string& sensor) const;

  /// The same, or what it may have to be by what its sightings have shown while no track was established, if
  /// that is more (LoneSightings).
  double suspectedScale(const std::string& sensor) const;

  /// A mature track was updated with a sighting. `innovation_squared` of both coordinates and the variance
  /// `expected` of each [rad^2]; `track_scale`: the noise scale that the track has found beyond the sensor's.
  void take(const std::string& sensor, const Eigen::Vector2d& innovation_squared,
            const Eigen::Vector2d& expected, const Eigen::Vector2d& track_scale);

  /// Takes a scan while no track is established: whether the stated noise can be right at all. Returns
  /// whether it has just been found far too small.
  bool takeUntracked(const Scan& scan);

  /// By name.
  const std::vector<CalibratedSensor>& sensors() const { return sensors_; }

 private:
  const CalibratedSensor* find(const std::string& sensor) const;
  CalibratedSensor* entry(const std::string& sensor);

  NoiseCalibrationParams params_;
  std::vector<CalibratedSensor> sensors_;
};

}  // namespace sightline::core
