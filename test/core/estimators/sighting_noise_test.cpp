#include "sightline/core/estimators/sighting_noise.h"

#include <gtest/gtest.h>

namespace sightline::core {
namespace {

Eigen::Matrix2d round(double sigma) {
  return sigma * sigma * Eigen::Matrix2d::Identity();
}

TEST(SightingNoise, OfEqualSightingsIsTheirCovariance) {
  Eigen::Matrix2d R;
  R << 4e-6, 1e-6, 1e-6, 2e-6;
  SightingNoise noise;
  for (int i = 0; i < 100; ++i) {
    noise.add(R);
    EXPECT_TRUE(noise.covariance().isApprox(R, 1e-12));
  }
}

TEST(SightingNoise, IsHardlyChangedByACoarseSensorThatJoinsAFineOne) {
  SightingNoise noise;
  for (int i = 0; i < 200; ++i) noise.add(round(i % 2 == 0 ? 1e-3 : 0.1));
  EXPECT_GT(noise.covariance()(0, 0), 1.5e-6);
  EXPECT_LT(noise.covariance()(0, 0), 2.5e-6);
}

TEST(SightingNoise, FollowsAFineSensorThatJoinsCoarseOnesAtOnce) {
  SightingNoise noise;
  for (int i = 0; i < 200; ++i) noise.add(round(0.1));
  noise.add(round(1e-3));
  EXPECT_LT(noise.covariance()(0, 0), 40e-6);
}

TEST(SightingNoise, KeepsTheChannelsApartWhereASensorMeasuresOnlyOne) {
  SightingNoise noise;
  for (int i = 0; i < 10; ++i) noise.add(Eigen::Vector2d(3e-4, 0.12).asDiagonal());
  EXPECT_NEAR(noise.covariance()(0, 0), 3e-4, 1e-12);
  EXPECT_NEAR(noise.covariance()(1, 1), 0.12, 1e-12);
}

TEST(SightingNoise, TurnsWithTheCoordinates) {
  Eigen::Matrix2d J;
  J << 0.8, -0.5, 0.7, 1.1;
  const Eigen::Matrix2d first = Eigen::Vector2d(1e-4, 9e-4).asDiagonal(), second = round(2e-3);
  SightingNoise before, after;
  before.add(first);
  before.add(second);
  before.transform(J);
  after.add(J * first * J.transpose());
  after.add(J * second * J.transpose());
  EXPECT_TRUE(before.covariance().isApprox(after.covariance(), 1e-12));
  before.add(first);
  after.add(first);
  EXPECT_TRUE(before.covariance().isApprox(after.covariance(), 1e-12));
}

TEST(ProcessNoise, IsAbsoluteWhereADensityIsGivenAndInProportionToTheSightingsOtherwise) {
  EXPECT_EQ((ProcessNoise{0.3, 50.0}.accelerationFor(round(0.1), 1.0)),
            Eigen::Matrix2d(0.3 * Eigen::Matrix2d::Identity()));
  EXPECT_TRUE((ProcessNoise{0.0, 50.0}.accelerationFor(round(0.1), 1.0).isApprox(round(0.1) * 50.0)));
}

TEST(PassingAcceleration, IsThatOfASensorThatLooksSeldomAndFreeOfTheScaleOfTime) {
  const Eigen::Vector2d rates(0.03, -0.04);
  EXPECT_EQ(passingAcceleration(rates, 1.0), Eigen::Matrix2d(Eigen::Matrix2d::Zero()));
  // Over the same path a hundred times as slowly: density h^3 is an angle squared.
  const double quick = passingAcceleration(rates, 1e3)(0, 0),
               slow = passingAcceleration(0.01 * rates, 1e5)(0, 0);
  EXPECT_NEAR(slow * 1e6, quick, 1e-2 * quick);
  EXPECT_NEAR(quick, 0.05 * 0.05 * 0.05, 1e-2 * quick);
}

}  // namespace
}  // namespace sightline::core
