#include "sightline/core/model/sphere.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

namespace sightline::core {
namespace {

constexpr double kPoleDistance = 1e-9;

}  // namespace

double wrapAngle(double angle) {
  const double wrapped = std::remainder(angle, 2.0 * kPi);
  return wrapped <= -kPi ? kPi : wrapped;
}

Eigen::Vector3d directionOf(const Eigen::Vector2d& angles) {  // (S-12)
  const double horizontal = std::cos(angles.y());
  return {horizontal * std::cos(angles.x()), horizontal * std::sin(angles.x()), std::sin(angles.y())};
}

Eigen::Vector2d anglesOf(const Eigen::Vector3d& direction) {  // (S-12)
  const double azimuth = std::atan2(direction.y(), direction.x());
  return {azimuth <= -kPi ? kPi : azimuth,
          std::atan2(direction.z(), std::hypot(direction.x(), direction.y()))};
}

double angleBetween(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

Eigen::Vector2d angleDifference(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return {wrapAngle(a.x() - b.x()), a.y() - b.y()};
}

Eigen::Matrix<double, 3, 2> directionJacobian(const Eigen::Vector2d& angles) {  // (S-12)
  const double ca = std::cos(angles.x()), sa = std::sin(angles.x());
  const double ce = std::cos(angles.y()), se = std::sin(angles.y());
  Eigen::Matrix<double, 3, 2> jacobian;
  jacobian << -ce * sa, -se * ca,  //
      ce * ca, -se * sa,           //
      0.0, ce;
  return jacobian;
}

Eigen::Matrix<double, 2, 3> anglesJacobian(const Eigen::Vector3d& direction) {  // (S-12)
  const double distance = std::hypot(direction.x(), direction.y());
  const double rho = std::max(distance, kPoleDistance);
  // At the pole itself the azimuth is that of the little that is left, and 0 where nothing is.
  const double ca = distance > 0.0 ? direction.x() / distance : 1.0;
  const double sa = distance > 0.0 ? direction.y() / distance : 0.0;
  Eigen::Matrix<double, 2, 3> jacobian;
  jacobian << -sa / rho, ca / rho, 0.0,  //
      -direction.z() * ca, -direction.z() * sa, rho;
  return jacobian;
}

Eigen::Vector2d rotateAngles(const Eigen::Vector2d& angles, const Eigen::Matrix3d& R_to_from) {  // (S-13)
  return anglesOf(R_to_from * directionOf(angles));
}

Eigen::Matrix2d rotationJacobian(const Eigen::Vector2d& angles, const Eigen::Matrix3d& R_to_from) {  // (S-13)
  return anglesJacobian(R_to_from * directionOf(angles)) * R_to_from * directionJacobian(angles);
}

namespace {

/// d/dt of directionJacobian along a motion with the given rates, 3x2.
Eigen::Matrix<double, 3, 2> directionJacobianRate(const Eigen::Vector2d& angles,
                                                  const Eigen::Vector2d& rates) {
  const double ca = std::cos(angles.x()), sa = std::sin(angles.x());
  const double ce = std::cos(angles.y()), se = std::sin(angles.y());
  Eigen::Matrix<double, 3, 2> daz, del;  // derivatives of the Jacobian by azimuth and by elevation
  daz << -ce * ca, se * sa, -ce * sa, -se * ca, 0.0, 0.0;
  del << se * sa, -ce * ca, -se * ca, -ce * sa, 0.0, -se;
  return daz * rates.x() + del * rates.y();
}

/// A motion seen from a turned frame, and how its errors turn.
struct TurnedMotion {
  Eigen::Vector4d mean;
  Eigen::Matrix4d jacobian;
};

TurnedMotion turn(const Eigen::Vector4d& mean, const Eigen::Matrix3d& R_to_from) {  // (S-14)
  const Eigen::Vector2d from = mean.head<2>(), rates = mean.tail<2>();
  const Eigen::Vector2d to = rotateAngles(from, R_to_from);
  const Eigen::Matrix2d J = rotationJacobian(from, R_to_from);
  const Eigen::Vector2d rates_to = J * rates;

  // With D = d direction / d angles, D_to J = R D_from holds along the motion, so that
  // dJ/dt = A_to (R dD_from/dt - dD_to/dt J); as partial derivatives commute, d rates_to / d angles = dJ/dt.
  const Eigen::Matrix2d J_rate =
      anglesJacobian(directionOf(to)) *
      (R_to_from * directionJacobianRate(from, rates) - directionJacobianRate(to, rates_to) * J);
  TurnedMotion turned;
  turned.mean << to, rates_to;
  turned.jacobian << J, Eigen::Matrix2d::Zero(), J_rate, J;
  return turned;
}

}  // namespace

Eigen::Matrix4d rotateStateJacobian(const Eigen::Vector4d& mean, const Eigen::Matrix3d& R_to_from) {
  return turn(mean, R_to_from).jacobian;
}

AngularState rotateState(const AngularState& state, const Eigen::Matrix3d& R_to_from) {
  const TurnedMotion turned = turn(state.mean, R_to_from);
  AngularState result;
  result.mean = turned.mean;
  result.covariance = symmetric(turned.jacobian * state.covariance * turned.jacobian.transpose());
  return result;
}

AngularState propagate(const AngularState& state, double h, double q) {  // (S-17)
  Eigen::Matrix4d F = Eigen::Matrix4d::Identity();
  F.topRightCorner<2, 2>().diagonal().setConstant(h);
  const double age = std::abs(h);
  AngularState result;
  result.mean = F * state.mean;
  result.covariance = F * state.covariance * F.transpose();
  result.covariance.topLeftCorner<2, 2>().diagonal().array() += q * age * age * age / 3.0;
  result.covariance.topRightCorner<2, 2>().diagonal().array() += q * h * age / 2.0;
  result.covariance.bottomLeftCorner<2, 2>().diagonal().array() += q * h * age / 2.0;
  result.covariance.bottomRightCorner<2, 2>().diagonal().array() += q * age;
  result.covariance = symmetric(result.covariance);
  return result;
}

}  // namespace sightline::core
