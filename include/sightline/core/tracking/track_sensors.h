#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "sightline/core/estimators/revisit_time.h"
#include "sightline/core/model/time.h"
#include "sightline/core/sensors/sensor_guard.h"

namespace sightline::core {

/// What one track knows of the sensors: which of them see its target, how well, and which do not. Plain
/// state; coordinates are those of the track's chart.
class TrackSensors {
 public:
  /// A sighting of the target. `R`: its covariance [rad^2]; `slow_error`: variance of the slowly varying
  /// error of the sensor's positions [rad^2].
  void noteSighting(const std::string& sensor, Time time, const Eigen::Vector2d& innovation,
                    const Eigen::Matrix2d& R, const Eigen::Vector2d& slow_error);

  /// What is known of the pace of a sensor that sees the target.
  void noteInterval(const std::string& sensor, const RevisitTime& interval);

  /// The longest unit of time of the sensors that have seen the target lately and have looked more than once
  /// [s]; 0 when there is none such. Infinite while none of all has looked twice: then silence means nothing.
  double unit(Time time, double units, double least) const;

  /// A scan of a sensor that has not seen the target lately, or cannot, has not shown it.
  /// `detection_probability`: that it would have, given that the sensor can see it.
  void noteMiss(const std::string& sensor, double visibility, double detection_probability);

  /// A sensor that had not been seeing the target has seen it: from now on it is as one of which nothing is
  /// known when it is silent for long again.
  void noteVisible(const std::string& sensor);

  /// Whether the sensor has seen the target lately: within so many units of its time, or `least` seconds.
  bool hasSeen(const std::string& sensor, Time time, double units, double least) const;

  /// Probability that the sensor, which has not seen the target lately, could see it.
  double visibility(const std::string& sensor) const;

  /// How far the track corroborates the sensor's sightings at `time`. `is_mature`: whether the track's
  /// innovations tell of its sensors.
  Corroboration corroborationOf(const std::string& sensor, Time time, const SensorGuard& guard,
                                bool is_mature) const;

  /// Variance of the slowly varying error of the position [rad^2]: each sensor's by its share in the
  /// information of the last seconds.
  Eigen::Vector2d slowErrorVariance(Time time) const;

  /// The sensors that have seen the target lately, by name.
  std::vector<std::string> names(Time time, double units, double least) const;

  /// The track has moved to another chart. `J`: Jacobian of its angles by those of the old one.
  void rotate(const Eigen::Matrix2d& J);

 private:
  struct Source {
    std::string sensor;
    Time last_sighting;
    Eigen::Vector2d innovation = Eigen::Vector2d::Zero();  // mean of the last ones [rad]
    RevisitTime interval;                                  // between its scans
    double information = 0.0;                              // of its sightings, fading [1/rad^2]
    Eigen::Vector2d slow_error = Eigen::Vector2d::Zero();  // variance [rad^2]
  };
  struct NonDetectingSensor {
    std::string sensor;
    double visibility = 0.0;  // probability that it could see the target
  };

  static double unitOf(const Source& source);
  static bool isRecent(const Source& source, Time time, double units, double least);
  void setVisibility(const std::string& sensor, double visibility);

  std::vector<Source> sources_;  // in the order in which they saw the target first
  std::vector<NonDetectingSensor> non_detecting_;
};

}  // namespace sightline::core
