#include "sightline/core/model/sphere.h"

#include <cmath>
#include <limits>
#include <random>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "support/covariances.h"

namespace sightline::core {
namespace {

Eigen::Matrix3d anyRotation(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  return Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random))
      .normalized()
      .toRotationMatrix();
}

TEST(Sphere, WrapBringsAnglesIntoTheHalfOpenCircle) {
  EXPECT_EQ(wrapAngle(0.25), 0.25);
  EXPECT_DOUBLE_EQ(wrapAngle(-kPi), kPi);
  EXPECT_DOUBLE_EQ(wrapAngle(kPi), kPi);
  EXPECT_NEAR(wrapAngle(7.0), 7.0 - 2.0 * kPi, 1e-15);
  EXPECT_NEAR(wrapAngle(-1e4), std::remainder(-1e4, 2.0 * kPi), 1e-12);
  EXPECT_TRUE(std::isnan(wrapAngle(std::numeric_limits<double>::infinity())));
}

TEST(Sphere, AxesFollowRep103) {
  EXPECT_TRUE(directionOf({0.0, 0.0}).isApprox(Eigen::Vector3d::UnitX()));
  EXPECT_TRUE(directionOf({kPi / 2.0, 0.0}).isApprox(Eigen::Vector3d::UnitY()));
  EXPECT_TRUE(directionOf({1.0, kPi / 2.0}).isApprox(Eigen::Vector3d::UnitZ()));
}

TEST(Sphere, AnglesAndDirectionsAreInverse) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector2d angles(kPi * uniform(random), 0.499 * kPi * uniform(random));
    EXPECT_LT((anglesOf(3.0 * directionOf(angles)) - angles).norm(), 1e-12);
  }
  EXPECT_EQ(anglesOf(Eigen::Vector3d::UnitZ()), Eigen::Vector2d(0.0, kPi / 2.0));
  EXPECT_EQ(anglesOf(Eigen::Vector3d(-1.0, -0.0, 0.0)).x(), kPi);
}

TEST(Sphere, AngleBetweenIsExactForSmallAndForOppositeDirections) {
  EXPECT_NEAR(angleBetween(directionOf({0.3, 0.2}), directionOf({0.3, 0.2 + 1e-9})), 1e-9, 1e-15);
  EXPECT_NEAR(angleBetween(Eigen::Vector3d::UnitX(), -2.0 * Eigen::Vector3d::UnitX()), kPi, 1e-15);
}

TEST(Sphere, JacobiansAreTheDerivatives) {
  const Eigen::Vector2d angles(0.7, -0.9);
  const double step = 1e-6;
  for (int i = 0; i < 2; ++i) {
    const Eigen::Vector2d shift = step * Eigen::Vector2d::Unit(i);
    const Eigen::Vector3d slope = (directionOf(angles + shift) - directionOf(angles - shift)) / (2.0 * step);
    EXPECT_LT((directionJacobian(angles).col(i) - slope).norm(), 1e-9);
  }
  EXPECT_TRUE((anglesJacobian(directionOf(angles)) * directionJacobian(angles)).isIdentity(1e-12));
}

TEST(Sphere, AnglesJacobianAtThePoleIsHugeButFinite) {
  EXPECT_TRUE(anglesJacobian(Eigen::Vector3d::UnitZ()).allFinite());
  for (const double azimuth : {0.0, 2.0}) {  // 6e-17 off the pole
    const auto J = anglesJacobian(directionOf({azimuth, 0.5 * kPi}));
    const Eigen::Vector3d across(-std::sin(azimuth), std::cos(azimuth), 0.0);
    const Eigen::Vector3d along(std::cos(azimuth), std::sin(azimuth), 0.0);
    EXPECT_NEAR((J * across - Eigen::Vector2d(1e9, 0.0)).norm(), 0.0, 1e-3);
    EXPECT_NEAR((J * along - Eigen::Vector2d(0.0, -1.0)).norm(), 0.0, 1e-6);
  }
}

TEST(Sphere, RotatedStateMovesAsTheRotatedDirectionDoes) {
  std::mt19937_64 random(2);
  for (int trial = 0; trial < 50; ++trial) {
    const Eigen::Matrix3d R = anyRotation(random);
    AngularState state;
    state.mean << 0.4, 0.3, 0.5, -0.7;
    const AngularState turned = rotateState(state, R);
    const double h = 1e-6;
    const Eigen::Vector2d later = rotateAngles(state.angles() + h * state.rates(), R);
    const Eigen::Vector2d earlier = rotateAngles(state.angles() - h * state.rates(), R);
    const Eigen::Vector2d rates = angleDifference(later, earlier) / (2.0 * h);
    EXPECT_LT((turned.rates() - rates).norm(), 1e-6 * (1.0 + rates.norm()));
  }
}

TEST(Sphere, RotatedCovarianceIsThatOfTheDerivative) {
  std::mt19937_64 random(3);
  const Eigen::Matrix3d R =
      Eigen::AngleAxisd(0.8, Eigen::Vector3d(1.0, 2.0, 0.5).normalized()).toRotationMatrix();
  AngularState state;
  state.mean << 0.4, 0.3, 0.5, -0.7;
  Eigen::Matrix4d jacobian;
  const double step = 1e-6;
  for (int i = 0; i < 4; ++i) {
    AngularState up = state, down = state;
    up.mean(i) += step;
    down.mean(i) -= step;
    jacobian.col(i) = (rotateState(up, R).mean - rotateState(down, R).mean) / (2.0 * step);
  }
  const Eigen::Matrix4d root = Eigen::Matrix4d::Random();
  state.covariance = root * root.transpose();
  EXPECT_TRUE(
      rotateState(state, R).covariance.isApprox(jacobian * state.covariance * jacobian.transpose(), 1e-7));
}

TEST(Sphere, RotatingThereAndBackChangesNothing) {
  std::mt19937_64 random(4);
  AngularState state;
  state.mean << 1.0, 0.5, -0.2, 0.3;
  state.covariance = Eigen::Vector4d(1e-4, 2e-4, 3e-3, 4e-3).asDiagonal();
  for (int trial = 0; trial < 50; ++trial) {
    const Eigen::Matrix3d R = anyRotation(random);
    const AngularState back = rotateState(rotateState(state, R), R.transpose());
    EXPECT_LT((back.mean - state.mean).norm(), 1e-9);
    EXPECT_TRUE(back.covariance.isApprox(state.covariance, 1e-6));
  }
}

TEST(Sphere, PropagationAddsWhiteAcceleration) {
  AngularState state;
  state.mean << 1.0, 2.0, 0.5, -1.0;
  const AngularState later = propagate(state, 0.2, 3.0);
  EXPECT_TRUE(later.mean.isApprox(Eigen::Vector4d(1.1, 1.8, 0.5, -1.0)));
  EXPECT_NEAR(later.covariance(0, 0), 3.0 * 0.008 / 3.0, 1e-15);
  EXPECT_NEAR(later.covariance(0, 2), 3.0 * 0.04 / 2.0, 1e-15);
  EXPECT_NEAR(later.covariance(2, 2), 3.0 * 0.2, 1e-15);
  const AngularState earlier = propagate(state, -0.2, 3.0);
  EXPECT_GT(test::leastEigenvalue(earlier.covariance), 0.0);
}

}  // namespace
}  // namespace sightline::core
