#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "sightline/core/model/field_of_view.h"
#include "sightline/core/model/refusal.h"
#include "sightline/core/simulation/platform_motion.h"
#include "sightline/core/simulation/sighting_sequence.h"

namespace sightline::core {

/// A stretch of scenario time, [from, to) in seconds.
struct Interval {
  double from = 0.0;                                    ///< [s]
  double to = std::numeric_limits<double>::infinity();  ///< [s]

  bool holds(double time) const { return from <= time && time < to; }
};

/// What is wrong with an interval; the detail begins with `what` it is ("an outage"). nullopt when nothing
/// is.
std::optional<Refusal> refusalOf(const Interval& interval, const char* what);

/// A time in which a sensor is worse than it states.
struct Degradation {
  Interval interval;
  double sigma_scale = 1.0;        ///< true sigma over stated sigma, >= 0 [1]
  Eigen::Vector2d bias{0.0, 0.0};  ///< of (azimuth, elevation), added to the constant one [rad]
};

/// A sensor as the simulator makes it. Angles are in the sensor's frame: x forward along the boresight, y
/// left, z up.
struct SimulatedSensor {
  std::string name;      ///< unique; also the name of its frame
  std::string station;   ///< on which it is mounted; empty: on the platform
  std::string sequence;  ///< sensors of the same sequence look at the same times; empty: its own

  Eigen::Vector3d mount_position = Eigen::Vector3d::Zero();  ///< in the station's or platform's frame [m]
  Eigen::Vector3d mount_attitude = Eigen::Vector3d::Zero();  ///< roll, pitch (positive looks down), yaw [rad]
  Eigen::Vector2d field_of_view{1.5, 1.5};                   ///< half widths in azimuth and elevation [rad]
  double ifov = 0.08;                                        ///< angle of one detector element [rad]

  /// Noise of each channel, as it is stated in the sightings: variance = sigma^2 + (relative_sigma r)^2 with
  /// r the angle of that channel from the boresight (the paper's eta r; sigma is its compulsory floor).
  Eigen::Vector2d sigma{0.08, 0.08};  ///< of azimuth and elevation, > 0 [rad]
  double relative_sigma = 0.0;        ///< eta, >= 0 [1]

  Eigen::Vector2d bias{0.0, 0.0};      ///< constant error, not stated in the sightings [rad]
  double detection_probability = 1.0;  ///< of a target in view, in (0, 1]
  double clutter_density = 0.0;        ///< false sightings, >= 0 [1/sr a scan]

  SightingTiming timing;
  double latency = 0.0;         ///< shortest time from exposure to publication, >= 0 [s]
  double latency_jitter = 0.0;  ///< further delay, uniform in [0, latency_jitter) [s]

  std::vector<Interval> outages;  ///< no scans at all
  std::vector<Degradation> degradations;
};

/// Maps the sensor's frame to that of its station or platform.
Eigen::Matrix3d R_platform_sensor(const SimulatedSensor& sensor);

/// What the sensor looks at, in its own frame.
FieldOfView viewOf(const SimulatedSensor& sensor);

/// Whether a direction (sensor's frame) lies in the field of view; the rim belongs to it.
bool inView(const SimulatedSensor& sensor, const Eigen::Vector3d& direction_sensor);

/// Solid angle of the field of view [sr].
double solidAngle(const SimulatedSensor& sensor);

/// Stated standard deviations at (azimuth, elevation) [rad] in the sensor's frame, (S-84).
Eigen::Vector2d statedSigma(const SimulatedSensor& sensor, const Eigen::Vector2d& angles_sensor);

/// What is wrong with a sensor's parameters; nullopt when nothing is.
std::optional<Refusal> refusalOf(const SimulatedSensor& sensor);

}  // namespace sightline::core
