#include "sightline/core/model/kinematics.h"

namespace sightline::core {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

}  // namespace

/// With J = d angles_to / d angles, rates_to = J rates and accelerations_to = J accelerations + dJ/dt rates.
Vector6 rotateMean(const Vector6& motion, const Eigen::Matrix3d& R) {
  const Eigen::Matrix4d jacobian = rotateStateJacobian(motion.head<4>(), R);
  const Eigen::Matrix2d J = jacobian.topLeftCorner<2, 2>();
  const Eigen::Matrix2d J_rate = jacobian.bottomLeftCorner<2, 2>();
  const Eigen::Vector2d rates = motion.segment<2>(2), accelerations = motion.segment<2>(4);
  Vector6 result;
  result << rotateAngles(motion.head<2>(), R), J * rates, J * accelerations + J_rate * rates;
  return result;
}

Motion<4> rotateMotion(const Motion<4>& motion, const Eigen::Matrix3d& R_new_old) {  // (S-14)
  const AngularState state = rotateState(motion.angularState(), R_new_old);
  return {state.mean, state.covariance};
}

Motion<6> rotateMotion(const Motion<6>& motion, const Eigen::Matrix3d& R_new_old) {
  // Central differences: in rates and accelerations the map is quadratic and they are exact; in the angles a
  // step of 1e-4 rad leaves a relative error of about 1e-8.
  constexpr double kStep = 1e-4;
  Motion<6> result;
  result.mean = rotateMean(motion.mean, R_new_old);
  Matrix6 jacobian;
  for (int i = 0; i < 6; ++i) {
    const Vector6 step = kStep * Vector6::Unit(i);
    Vector6 difference =
        rotateMean(motion.mean + step, R_new_old) - rotateMean(motion.mean - step, R_new_old);
    difference(0) = wrapAngle(difference(0));
    jacobian.col(i) = difference / (2.0 * kStep);
  }
  result.covariance = symmetric(jacobian * motion.covariance * jacobian.transpose());
  return result;
}

}  // namespace sightline::core
