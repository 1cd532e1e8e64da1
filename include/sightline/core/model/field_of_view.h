#pragma once

#include <Eigen/Core>

#include "sightline/core/model/sphere.h"

namespace sightline::core {

/// The part of the sky that a sensor looks at: a rectangle in azimuth and elevation of the sensor's frame
/// (x forward along the boresight, y left, z up), symmetric to the boresight.
struct FieldOfView {
  Eigen::Matrix3d R_sensor_tracking =
      Eigen::Matrix3d::Identity();              ///< maps the tracking frame to the sensor's
  Eigen::Vector2d half_widths{kPi, kPi / 2.0};  ///< azimuth (0, pi],
                                                ///< elevation (0, pi/2] [rad]

  /// Whether a direction (tracking frame, any length but 0) lies in it; the rim belongs to it.
  bool holds(const Eigen::Vector3d& direction_tracking) const;

  double solidAngle() const;  ///< [sr]
};

}  // namespace sightline::core
