#pragma once

#include <Eigen/Core>

#include "sightline/core/model/sighting.h"
#include "sightline/core/model/sphere.h"

namespace sightline::core {

/// The coordinates in which one target is estimated: azimuth and elevation in a frame that is turned so that
/// the target is far from the wrap at +-pi and from the poles.
///
/// Below 75 degrees of elevation the chart is the tracking frame turned about z alone: its coordinates are
/// azimuth and elevation themselves, less a constant, as the paper has them. Above, it is tilted to put
/// the target at its origin. A chart serves until `holds` says no; the tracker then moves the track to a new
/// one.
class Chart {
 public:
  /// The tracking frame itself.
  Chart() = default;

  /// The chart for a target in `direction` (unit vector, tracking frame).
  static Chart around(const Eigen::Vector3d& direction);

  /// The chart with `direction` at its origin, wherever that is: the plane that touches the sphere there.
  static Chart centredOn(const Eigen::Vector3d& direction);

  /// The chart that follows this one for a target that has gone to `direction`. Coming from a tilted chart it
  /// stays tilted down to 45 degrees: the sightings of the last seconds, near the zenith, must have their
  /// place in it too.
  Chart following(const Eigen::Vector3d& direction) const;

  /// Whether a target at these coordinates may stay in this chart.
  bool holds(const Eigen::Vector2d& coordinates) const;

  /// Coordinates [rad] of a direction given in the tracking frame.
  Eigen::Vector2d coordinatesOf(const Eigen::Vector3d& direction_tracking) const;

  /// Covariance [rad^2] of a sighting's coordinates; the sighting is in the tracking frame.
  Eigen::Matrix2d covarianceOf(const Sighting& sighting_tracking) const;

  /// Direction (unit vector, tracking frame) at coordinates.
  Eigen::Vector3d directionAt(const Eigen::Vector2d& coordinates) const;

  /// A motion in chart coordinates as azimuth, elevation and rates of the tracking frame.
  AngularState toTracking(const AngularState& state_chart) const;

  /// A motion in the tracking frame's angles as one in chart coordinates.
  AngularState fromTracking(const AngularState& state_tracking) const;

  /// Maps tracking frame to chart frame.
  const Eigen::Matrix3d& R_chart_tracking() const { return R_chart_tracking_; }

 private:
  static Chart around(const Eigen::Vector3d& direction, double tilt_above);

  Eigen::Matrix3d R_chart_tracking_ = Eigen::Matrix3d::Identity();
  double azimuth_ = 0.0;  // of the chart's x axis in the tracking frame [rad]
  bool tilted_ = false;
};

}  // namespace sightline::core
