#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "sightline/core/model/field_of_view.h"
#include "sightline/core/model/refusal.h"
#include "sightline/core/model/time.h"

namespace sightline::core {

/// A measured direction. Kept as a vector so that wrap and zenith are ordinary places.
struct Sighting {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  ///< unit vector, in the frame of its scan
  Eigen::Matrix3d covariance =
      Eigen::Matrix3d::Zero();  ///< of `direction` [rad^2]; rank 2, in the tangent plane
  double snr = std::numeric_limits<double>::quiet_NaN();  ///< amplitude ratio, NaN = not known
};

/// One exposure of one sensor. No sightings means: looked, and saw nothing.
struct Scan {
  Time time{};                                             ///< middle of the exposure
  std::string sensor;                                      ///< unique name
  double ifov = std::numeric_limits<double>::quiet_NaN();  ///< angle of one detector element [rad]
  double detection_probability = std::numeric_limits<double>::quiet_NaN();  ///< NaN = the tracker's parameter
  double clutter_density = std::numeric_limits<double>::quiet_NaN();        ///< [1/sr], NaN = the tracker's
  double noise_scale = 1.0;         ///< factor on the stated variances that `sightings` have in them already
  std::optional<FieldOfView> view;  ///< what the sensor looked at; nullopt = not known
  std::vector<Sighting> sightings;
};

/// Sighting of (azimuth, elevation) [rad] with its 2x2 covariance [rad^2] (azimuth variance of the azimuth
/// itself). Angles and covariance must have passed `rejectionOf`.
Sighting sightingOf(const Eigen::Vector2d& angles, const Eigen::Matrix2d& covariance,
                    double snr = std::numeric_limits<double>::quiet_NaN());

/// Covariance of the sighting's (azimuth, elevation) in its frame, 2x2 [rad^2].
Eigen::Matrix2d anglesCovariance(const Sighting& sighting);

/// The same sighting in a frame turned by R_to_from.
Sighting rotate(const Sighting& sighting, const Eigen::Matrix3d& R_to_from);

/// Why a sighting cannot be used (invalid), naming the field, the value and the remedy; nullopt when it can.
/// Refused: an angle that is not finite or out of range (|azimuth| > 2 pi, |elevation| > pi/2: degrees for
/// radians?), a covariance that is not finite, not symmetric, or not positive definite (zero means nothing
/// here), a sigma on the sphere below 1e-9 rad or above pi/2 rad.
std::optional<Refusal> rejectionOf(const Eigen::Vector2d& angles, const Eigen::Matrix2d& covariance);

/// Covariance of the white noise of a sighting whose stated covariance is `R` [rad^2]: each coordinate's
/// standard deviation times the root of its `noise_scale` [1].
Eigen::Matrix2d noiseCovariance(const Eigen::Matrix2d& R, const Eigen::Vector2d& noise_scale);

}  // namespace sightline::core
