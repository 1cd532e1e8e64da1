#include "sightline/core/model/kinematics.h"

#include <random>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <gtest/gtest.h>

#include "support/covariances.h"
#include "support/simulated.h"

namespace sightline::core {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

template <int N>
Motion<N> randomMotion(unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  const auto draw = [&](double) { return 0.3 * normal(random); };
  Motion<N> motion;
  motion.mean = motion.mean.unaryExpr(draw);
  const Eigen::Matrix<double, N, N> root = Eigen::Matrix<double, N, N>::Zero().unaryExpr(draw);
  motion.covariance = symmetric(root * root.transpose());
  return motion;
}

Matrix6 transition(double h) {
  Matrix6 F = Matrix6::Identity();
  F.block<2, 2>(0, 2).diagonal().setConstant(h);
  F.block<2, 2>(2, 4).diagonal().setConstant(h);
  F.block<2, 2>(0, 4).diagonal().setConstant(0.5 * h * h);
  return F;
}

TEST(Kinematics, MovesByTheTransitionMatrix) {
  const double h = 0.7;
  const Motion<6> six = randomMotion<6>(1);
  Motion<6> moved = six;
  moveOn(moved, h);
  const Matrix6 F = transition(h);
  EXPECT_TRUE(moved.mean.isApprox(F * six.mean, 1e-14));
  EXPECT_TRUE(moved.covariance.isApprox(F * six.covariance * F.transpose(), 1e-14));

  const Motion<4> four = randomMotion<4>(2);
  Motion<4> moved_four = four;
  moveOn(moved_four, h);
  const Eigen::Matrix4d F_four = F.topLeftCorner<4, 4>();
  EXPECT_TRUE(moved_four.mean.isApprox(F_four * four.mean, 1e-14));
  EXPECT_TRUE(moved_four.covariance.isApprox(F_four * four.covariance * F_four.transpose(), 1e-14));
}

TEST(Kinematics, NoiseOfTwoStepsIsThatOfOne) {
  Eigen::Matrix2d density;
  density << 0.3, 0.1, 0.1, 0.7;
  const auto inSteps = [&](auto add, const std::vector<double>& steps) {
    Motion<6> motion;
    for (const double h : steps) {
      moveOn(motion, h);
      add(motion, h);
    }
    return motion.covariance;
  };
  const auto jerk = [&](Motion<6>& motion, double h) { addWhiteJerk(motion, density, h); };
  EXPECT_TRUE(inSteps(jerk, {0.2, 0.5}).isApprox(inSteps(jerk, {0.7}), 1e-13));
  const auto acceleration = [&](Motion<6>& motion, double h) { addWhiteAcceleration(motion, density, h); };
  EXPECT_TRUE(inSteps(acceleration, {0.2, 0.5}).isApprox(inSteps(acceleration, {0.7}), 1e-13));
}

TEST(Kinematics, WhiteAccelerationAgreesWithPropagate) {
  const Motion<4> motion = randomMotion<4>(3);
  for (const double h : {0.4, -0.4}) {
    Motion<4> moved = motion;
    moveOn(moved, h);
    addWhiteAcceleration(moved, Eigen::Matrix2d(0.2 * Eigen::Matrix2d::Identity()), h);
    const AngularState expected = propagate(motion.angularState(), h, 0.2);
    EXPECT_TRUE(moved.mean.isApprox(expected.mean, 1e-14));
    EXPECT_TRUE(moved.covariance.isApprox(expected.covariance, 1e-13));
  }
}

TEST(Kinematics, ConditionsAsTheTextbookDoes) {
  const Motion<6> prior = randomMotion<6>(4);
  Eigen::Matrix2d R;
  R << 0.02, 0.01, 0.01, 0.03;
  const Eigen::Vector2d z(0.4, -0.2);
  Motion<6> posterior = prior;
  const double log_likelihood = condition(posterior, z, R).logLikelihood();

  Eigen::Matrix<double, 2, 6> H = Eigen::Matrix<double, 2, 6>::Zero();
  H.leftCols<2>().setIdentity();
  const Eigen::Matrix2d S = H * prior.covariance * H.transpose() + R;
  const Eigen::Matrix<double, 6, 2> K = prior.covariance * H.transpose() * S.inverse();
  const Eigen::Vector2d innovation = z - H * prior.mean;
  EXPECT_TRUE(posterior.mean.isApprox(prior.mean + K * innovation, 1e-12));
  EXPECT_TRUE(posterior.covariance.isApprox(prior.covariance - K * H * prior.covariance, 1e-11));
  const double density = std::exp(-0.5 * innovation.dot(S.inverse() * innovation)) /
                         (2.0 * 3.14159265358979323846 * std::sqrt(S.determinant()));
  EXPECT_NEAR(log_likelihood, std::log(density), 1e-12);
}

TEST(Kinematics, StaysACovarianceWhereThePriorIsEighteenOrdersWider) {
  Motion<4> motion;
  motion.covariance.diagonal() << 1e-10, 1e-10, 1.0, 1.0;
  const Eigen::Matrix2d R = 1e-10 * Eigen::Matrix2d::Identity();
  moveOn(motion, 1e4);
  addWhiteAcceleration(motion, R, 1e4);
  condition(motion, Eigen::Vector2d(0.1, 0.2), R);
  EXPECT_TRUE(test::isCovariance(motion.covariance));
  EXPECT_NEAR(motion.covariance(0, 0), 1e-10, 1e-16);
}

/// Directions of a motion with constant accelerations of its angles, seen from a turned frame.
Vector6 seenAt(const Vector6& motion, const Eigen::Matrix3d& R) {
  const auto anglesAt = [&](double t) -> Eigen::Vector2d {
    return rotateAngles(motion.segment<2>(0) + t * motion.segment<2>(2) + 0.5 * t * t * motion.segment<2>(4),
                        R);
  };
  const double h = 1e-3;
  Vector6 seen;
  seen << anglesAt(0.0), (anglesAt(h) - anglesAt(-h)) / (2.0 * h),
      (anglesAt(h) - 2.0 * anglesAt(0.0) + anglesAt(-h)) / (h * h);
  return seen;
}

const Eigen::Matrix3d kTurn =
    (Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitY()))
        .toRotationMatrix();

TEST(Kinematics, TurnsRatesAndAccelerationsAsTheDirectionsThemselvesTurn) {
  Motion<6> motion = randomMotion<6>(5);
  const Motion<6> turned = rotateMotion(motion, kTurn);
  EXPECT_LT((turned.mean - seenAt(motion.mean, kTurn)).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(Kinematics, TurnsThereAndBackToWhatItWas) {
  const Motion<6> motion = randomMotion<6>(6);
  const Motion<6> back = rotateMotion(rotateMotion(motion, kTurn), kTurn.transpose());
  EXPECT_TRUE(back.mean.isApprox(motion.mean, 1e-12));
  EXPECT_TRUE(back.covariance.isApprox(motion.covariance, 1e-6));
  EXPECT_TRUE(test::isCovariance(rotateMotion(motion, kTurn).covariance));
}

TEST(Kinematics, TurnsPositionAndRateAlikeWithAndWithoutAcceleration) {
  Motion<6> motion = randomMotion<6>(7);
  const AngularState expected = rotateState(motion.angularState(), kTurn);
  const AngularState turned = rotateMotion(motion, kTurn).angularState();
  EXPECT_TRUE(turned.mean.isApprox(expected.mean, 1e-12));
  EXPECT_TRUE(turned.covariance.isApprox(expected.covariance, 1e-6));
}

}  // namespace
}  // namespace sightline::core
