#include "sightline/core/model/attitude.h"

#include <Eigen/Geometry>

namespace sightline::core {
namespace {

/// Maps a small turn to what it does to the direction: delta x direction.
Eigen::Matrix3d turnToDirection(const Eigen::Vector3d& direction) {
  Eigen::Matrix3d J;
  J << 0.0, direction.z(), -direction.y(),  //
      -direction.z(), 0.0, direction.x(),   //
      direction.y(), -direction.x(), 0.0;
  return J;
}

}  // namespace

Eigen::Vector3d angularVelocity(const Eigen::Matrix3d& R_rest_before, const Eigen::Matrix3d& R_rest_after,
                                double seconds) {
  const Eigen::AngleAxisd turn(Eigen::Matrix3d(R_rest_before.transpose() * R_rest_after));
  return turn.angle() / seconds * turn.axis();
}

// (S-16)
Eigen::Matrix3d attitudeCovariance(const AttitudeParams& params, const Eigen::Vector3d& angular_velocity) {
  const Eigen::Vector3d sigma_of_time = params.time_sigma * angular_velocity;
  Eigen::Matrix3d covariance = sigma_of_time * sigma_of_time.transpose();
  covariance.diagonal() += params.sigma.cwiseAbs2();
  return covariance;
}

Sighting withAttitude(const Sighting& sighting, const Eigen::Matrix3d& attitude_covariance) {  // (S-16)
  const Eigen::Matrix3d J = turnToDirection(sighting.direction);
  Sighting uncertain = sighting;
  const Eigen::Matrix3d sum = sighting.covariance + J * attitude_covariance * J.transpose();
  uncertain.covariance = 0.5 * (sum + sum.transpose());  // symmetric to the last bit
  return uncertain;
}

}  // namespace sightline::core
