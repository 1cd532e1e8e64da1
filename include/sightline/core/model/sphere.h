#pragma once

#include <Eigen/Core>

/// Directions on the unit sphere. Angles are (azimuth, elevation) [rad] as REP-103: x forward, y left, z up,
/// azimuth = atan2(y, x) in (-pi, pi], elevation = atan2(z, hypot(x, y)) in [-pi/2, pi/2].
/// Rotations are named R_to_from and map coordinates of `from` to coordinates of `to`.
namespace sightline::core {

inline constexpr double kPi = 3.14159265358979323846;
inline constexpr double kDegree = kPi / 180.0;  ///< [rad]

/// A direction whose standard deviation [rad] is larger may be anywhere on the sphere.
inline constexpr double kLargestDirectionSigma = kPi;

/// An angle brought into (-pi, pi] [rad]. Not finite in, NaN out.
double wrapAngle(double angle);

/// Unit vector of (azimuth, elevation).
Eigen::Vector3d directionOf(const Eigen::Vector2d& angles);

/// (azimuth, elevation) of a direction of any length but zero. At a pole the azimuth is that of the
/// remaining horizontal part, 0 when there is none.
Eigen::Vector2d anglesOf(const Eigen::Vector3d& direction);

/// Angle between two directions of any length [rad], in [0, pi], exact for small angles too.
double angleBetween(const Eigen::Vector3d& a, const Eigen::Vector3d& b);

/// Difference `a - b` of two (azimuth, elevation) pairs with the azimuth wrapped [rad].
/// Only for directions away from the poles; a Chart sees to that.
Eigen::Vector2d angleDifference(const Eigen::Vector2d& a, const Eigen::Vector2d& b);

/// d direction / d (azimuth, elevation), 3x2.
Eigen::Matrix<double, 3, 2> directionJacobian(const Eigen::Vector2d& angles);

/// d (azimuth, elevation) / d direction, 2x3, at a unit direction. Within 1e-9 of a pole the distance from it
/// counts as 1e-9, so that the azimuth's variance there is huge but finite.
Eigen::Matrix<double, 2, 3> anglesJacobian(const Eigen::Vector3d& direction);

/// (azimuth, elevation) seen from a frame turned by R_to_from.
Eigen::Vector2d rotateAngles(const Eigen::Vector2d& angles, const Eigen::Matrix3d& R_to_from);

/// d rotateAngles / d angles, 2x2.
Eigen::Matrix2d rotationJacobian(const Eigen::Vector2d& angles, const Eigen::Matrix3d& R_to_from);

/// Motion of a target seen from one point: mean and covariance over
/// (azimuth, elevation, azimuth_rate, elevation_rate) [rad, rad, rad/s, rad/s].
struct AngularState {
  Eigen::Vector4d mean = Eigen::Vector4d::Zero();
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();

  Eigen::Vector2d angles() const { return mean.head<2>(); }
  Eigen::Vector2d rates() const { return mean.tail<2>(); }
  Eigen::Matrix2d anglesCovariance() const { return covariance.topLeftCorner<2, 2>(); }
};

/// The same motion in a frame turned by R_to_from (constant in time); the covariance by the 4x4 Jacobian,
/// which includes the curvature of the angles' grid in the rates.
AngularState rotateState(const AngularState& state, const Eigen::Matrix3d& R_to_from);

/// d (mean of rotateState) / d mean, 4x4: how errors of a motion turn.
Eigen::Matrix4d rotateStateJacobian(const Eigen::Vector4d& mean, const Eigen::Matrix3d& R_to_from);

/// State `h` seconds later (or earlier) at constant angular rates, plus white angular acceleration of
/// density `q` [rad^2/s^3] in each channel: Q = q [[h^3/3, h^2/2], [h^2/2, h]] for |h|.
AngularState propagate(const AngularState& state, double h, double q);

/// The nearest symmetric matrix; every covariance that leaves the core goes through it.
template <typename Matrix>
typename Matrix::PlainObject symmetric(const Eigen::MatrixBase<Matrix>& matrix) {
  return 0.5 * (matrix + matrix.transpose());
}

}  // namespace sightline::core
