#include "sightline/core/model/attitude.h"

#include <cmath>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "sightline/core/model/sphere.h"
#include "sightline/core/simulation/random_stream.h"

namespace sightline::core {
namespace {

const Eigen::Matrix2d kOwn = Eigen::Vector2d(1e-6, 2e-6).asDiagonal();

Eigen::Matrix2d withSigma(const Eigen::Vector2d& angles, const Eigen::Vector3d& sigma) {
  AttitudeParams params;
  params.sigma = sigma;
  return anglesCovariance(
      withAttitude(sightingOf(angles, kOwn), attitudeCovariance(params, Eigen::Vector3d::Zero())));
}

TEST(Attitude, OnTheBoresightYawIsAzimuthPitchIsElevationAndRollIsNothing) {
  const Eigen::Matrix2d covariance = withSigma({0.0, 0.0}, {0.5, 2e-3, 3e-3});
  EXPECT_NEAR(covariance(0, 0), 1e-6 + 9e-6, 1e-12);
  EXPECT_NEAR(covariance(1, 1), 2e-6 + 4e-6, 1e-12);
  EXPECT_NEAR(covariance(0, 1), 0.0, 1e-12);
}

TEST(Attitude, ToTheLeftRollIsElevationAndPitchIsNothing) {
  const Eigen::Matrix2d covariance = withSigma({1.5707963267948966, 0.0}, {2e-3, 0.5, 0.0});
  EXPECT_NEAR(covariance(0, 0), 1e-6, 1e-12);
  EXPECT_NEAR(covariance(1, 1), 2e-6 + 4e-6, 1e-12);
}

TEST(Attitude, YawIsTheSameAzimuthAtEveryElevation) {
  for (const double elevation : {0.0, 0.7, 1.4, -1.5}) {
    EXPECT_NEAR(withSigma({0.3, elevation}, {0.0, 0.0, 3e-3})(0, 0), 1e-6 + 9e-6, 1e-10) << elevation;
  }
}

TEST(Attitude, ExactAttitudeAddsNothing) {
  const Sighting sighting = sightingOf({0.4, 0.7}, kOwn);
  const Eigen::Matrix3d none = attitudeCovariance(AttitudeParams{}, {1.0, -2.0, 3.0});
  EXPECT_TRUE(none.isZero(0.0));
  EXPECT_EQ(withAttitude(sighting, none).covariance, sighting.covariance);
}

TEST(Attitude, CovarianceStaysInTheTangentPlane) {
  AttitudeParams params{{1e-3, 2e-3, 3e-3}, 1e-3};
  const Sighting sighting =
      withAttitude(sightingOf({2.0, -1.1}, kOwn), attitudeCovariance(params, {0.5, 1.0, -3.0}));
  EXPECT_LT((sighting.covariance * sighting.direction).norm(), 1e-18);
  EXPECT_EQ(sighting.covariance, sighting.covariance.transpose());
}

TEST(Attitude, TimeThatIsNotKnownIsTheTurnInThatTime) {
  AttitudeParams params;
  params.time_sigma = 1e-3;
  const Eigen::Matrix3d covariance = attitudeCovariance(params, {0.0, 0.0, 3.5});
  EXPECT_NEAR(covariance(2, 2), std::pow(3.5e-3, 2), 1e-18);
  EXPECT_NEAR(covariance.trace(), covariance(2, 2), 1e-18);
}

TEST(Attitude, AngularVelocityIsInTheTurningFrame) {
  const Eigen::Vector3d velocity(0.4, -1.0, 3.0);
  const Eigen::Matrix3d before = Eigen::AngleAxisd(2.0, Eigen::Vector3d(1.0, 1.0, 0.3).normalized()).matrix();
  const Eigen::Matrix3d after =
      before * Eigen::AngleAxisd(0.01 * velocity.norm(), velocity.normalized()).toRotationMatrix();
  EXPECT_LT((angularVelocity(before, after, 0.01) - velocity).norm(), 1e-9);
  EXPECT_LT((angularVelocity(after, before, -0.01) - velocity).norm(), 1e-9);
  EXPECT_TRUE(angularVelocity(before, before, 0.01).isZero(1e-12));
}

/// Directions turned by random small turns scatter as the covariance says: the sample variance of n normal
/// draws has a relative standard deviation of sqrt(2 / n); five of them, and second order of the turn.
TEST(Attitude, CovarianceIsThatOfDirectionsTurnedAtRandom) {
  const AttitudeParams params{{1e-3, 4e-3, 2e-3}, 2e-3};
  const Eigen::Vector3d velocity(0.3, -0.5, 3.0);
  const Eigen::Vector3d direction = directionOf({0.8, 0.9});
  RandomStream random(7);
  constexpr int kDraws = 40000;
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (int i = 0; i < kDraws; ++i) {
    const Eigen::Vector2d first = random.normalPair(), second = random.normalPair();
    const Eigen::Vector3d own(params.sigma.x() * first.x(), params.sigma.y() * first.y(),
                              params.sigma.z() * second.x());
    const Eigen::Vector3d turn = own + params.time_sigma * second.y() * velocity;
    const Eigen::Vector3d off = Eigen::AngleAxisd(turn.norm(), turn.normalized()) * direction - direction;
    scatter += off * off.transpose() / kDraws;
  }
  Sighting exact;
  exact.direction = direction;
  const Eigen::Matrix3d stated = withAttitude(exact, attitudeCovariance(params, velocity)).covariance;
  EXPECT_LT((scatter - stated).norm(), 5.0 * std::sqrt(2.0 / kDraws) * stated.norm());
}

}  // namespace
}  // namespace sightline::core
