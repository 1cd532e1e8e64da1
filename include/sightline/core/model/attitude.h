#pragma once

#include <Eigen/Core>

#include "sightline/core/model/sighting.h"

/// How well the attitude of a sensor's frame is known, and what that does to its sightings.
///
/// An error of attitude turns all sightings of a scan together. Here each sighting gets the covariance that
/// it has on its own; what is neglected is that
///   - the errors of two sightings of one scan are correlated: two targets are known better relative to each
///     other than their covariances say;
///   - an error may last over scans: it then does not average out as white noise does, and a track is off by
///     it though its covariance has become small. State a sigma of what changes from scan to scan; a constant
///     misalignment belongs into the mount.
namespace sightline::core {

/// White from scan to scan. All zero: the attitude is exact.
struct AttitudeParams {
  /// Of roll, pitch and yaw: small turns about the axes x, y and z of the scans' frame, >= 0 [rad].
  Eigen::Vector3d sigma = Eigen::Vector3d::Zero();

  double time_sigma = 0.0;  ///< of the time for which the attitude is taken, >= 0 [s]

  bool isExact() const { return sigma.isZero(0.0) && time_sigma == 0.0; }
};

/// Velocity at which a frame turns, in that frame [rad/s], from its attitudes `seconds` (not 0) apart; each
/// maps the frame to one at rest. They must be less than half a turn apart.
Eigen::Vector3d angularVelocity(const Eigen::Matrix3d& R_rest_before, const Eigen::Matrix3d& R_rest_after,
                                double seconds);

/// Covariance of the small turn by which a frame may be off, about its axes [rad^2], when it turns at
/// `angular_velocity` (in that frame) [rad/s].
Eigen::Matrix3d attitudeCovariance(const AttitudeParams& params, const Eigen::Vector3d& angular_velocity);

/// The sighting with the covariance that an uncertain attitude of its frame adds to its own.
Sighting withAttitude(const Sighting& sighting, const Eigen::Matrix3d& attitude_covariance);

}  // namespace sightline::core
