#include "sightline/core/model/line_of_sight.h"

#include <cmath>
#include <limits>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <gtest/gtest.h>

#include "sightline/core/model/sphere.h"
#include "sightline/core/simulation/random_stream.h"

namespace sightline::core {
namespace {

const Eigen::Matrix3d kUnit = Eigen::Matrix3d::Identity();

TEST(LineOfSight, APointsCovarianceCountsAcrossTheLineOfSightOnlyAndByTheSquareOfTheRange) {
  const Eigen::Matrix3d covariance = Eigen::Vector3d(25.0, 1.0, 4.0).asDiagonal();  // [m^2]
  const auto sighting = sightingOfPoint({100.0, 0.0, 0.0}, covariance);
  ASSERT_TRUE(sighting);
  const Eigen::Matrix2d angles = anglesCovariance(*sighting);
  EXPECT_NEAR(angles(0, 0), 1e-4, 1e-12);  // (1 m / 100 m)^2
  EXPECT_NEAR(angles(1, 1), 4e-4, 1e-12);
  EXPECT_NEAR(angles(0, 1), 0.0, 1e-12);
  EXPECT_NEAR((sighting->covariance * sighting->direction).norm(), 0.0, 1e-15);
}

TEST(LineOfSight, DirectionsOfNoisyPointsScatterAsTheCovarianceSays) {
  const Eigen::Vector3d point(40.0, -30.0, 20.0);  // [m]
  Eigen::Matrix3d covariance;
  covariance << 0.09, 0.02, -0.01, 0.02, 0.04, 0.015, -0.01, 0.015, 0.16;  // [m^2]
  const auto sighting = sightingOfPoint(point, covariance);
  ASSERT_TRUE(sighting);
  const Eigen::LLT<Eigen::Matrix2d> stated(anglesCovariance(*sighting));
  ASSERT_EQ(stated.info(), Eigen::Success);
  const Eigen::Matrix3d root = covariance.llt().matrixL();
  RandomStream stream(1);
  constexpr int kDraws = 20000;
  double nees = 0.0;
  for (int i = 0; i < kDraws; ++i) {
    const Eigen::Vector2d a = stream.normalPair(), b = stream.normalPair();
    const Eigen::Vector3d noisy = point + root * Eigen::Vector3d(a.x(), a.y(), b.x());
    const Eigen::Vector2d error = angleDifference(anglesOf(noisy), anglesOf(point));
    nees += error.dot(stated.solve(error)) / 2.0;
  }
  // Mean of chi^2_2 / 2 has standard deviation 1/sqrt(n): four of them, and room for the curvature.
  EXPECT_NEAR(nees / kDraws, 1.0, 4.0 / std::sqrt(double(kDraws)) + 0.002);
}

TEST(LineOfSight, LengthOfARayDoesNotMatterWhenItsCovarianceGrowsWithIt) {
  const Eigen::Vector3d ray(0.3, -0.2, 1.0);
  const Eigen::Matrix3d covariance = Eigen::Vector3d(1e-6, 2e-6, 1e-7).asDiagonal();
  const auto near = sightingOfPoint(ray, covariance), far = sightingOfPoint(1e3 * ray, 1e6 * covariance);
  ASSERT_TRUE(near && far);
  EXPECT_TRUE(near->direction.isApprox(far->direction, 1e-12));
  EXPECT_TRUE(near->covariance.isApprox(far->covariance, 1e-9));
}

TEST(LineOfSight, WithoutDirectionOrWithoutCovarianceThereIsNoSighting) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(sightingOfPoint(Eigen::Vector3d::Zero(), kUnit));
  EXPECT_FALSE(sightingOfPoint({nan, 0.0, 1.0}, kUnit));
  EXPECT_FALSE(sightingOfPoint({1.0, 0.0, 0.0}, Eigen::Matrix3d::Zero()));
  EXPECT_FALSE(sightingOfPoint({1.0, 0.0, 0.0}, -kUnit));
  EXPECT_FALSE(sightingOfPoint({1.0, 0.0, 0.0}, nan * kUnit));
  const Eigen::Matrix3d along_only = Eigen::Vector3d(1.0, 0.0, 0.0).asDiagonal();
  EXPECT_FALSE(sightingOfPoint({1.0, 0.0, 0.0}, along_only));
  EXPECT_FALSE(sightingAlong(Eigen::Vector3d::Zero(), {1e-3, 1e-3}));
  EXPECT_FALSE(sightingAlong({0.0, std::numeric_limits<double>::infinity(), 0.0}, {1e-3, 1e-3}));
}

TEST(LineOfSight, StatedSigmasAreArcsSoThatTheAzimuthVarianceGrowsTowardsThePole) {
  const double elevation = 1.2;  // [rad]
  const auto sighting = sightingAlong(directionOf({0.5, elevation}), {2e-3, 1e-3});
  ASSERT_TRUE(sighting);
  const Eigen::Matrix2d angles = anglesCovariance(*sighting);
  EXPECT_NEAR(std::sqrt(angles(0, 0)), 2e-3 / std::cos(elevation), 1e-12);
  EXPECT_NEAR(std::sqrt(angles(1, 1)), 1e-3, 1e-12);
}

TEST(LineOfSight, VeryShortAndVeryLongVectorsHaveTheirDirection) {
  for (const double length : {1e-300, 1e-150, 1e150, 1e300}) {
    const auto sighting = sightingAlong(length * Eigen::Vector3d(1.0, 1.0, 0.0), {1e-3, 1e-3});
    ASSERT_TRUE(sighting) << length;
    EXPECT_NEAR(anglesOf(sighting->direction).x(), 0.25 * 3.14159265358979, 1e-12);
  }
}

TEST(LineOfSight, TheBoresightFrameLooksAlongXWithLeftAndUpPositive) {
  const Eigen::Matrix3d R = R_boresight_optical();
  EXPECT_TRUE((R * R.transpose()).isIdentity(1e-15));
  EXPECT_NEAR(R.determinant(), 1.0, 1e-15);
  EXPECT_TRUE((R * Eigen::Vector3d::UnitZ()).isApprox(Eigen::Vector3d::UnitX()));
  EXPECT_GT(anglesOf(R * Eigen::Vector3d(-0.1, 0.0, 1.0)).x(), 0.0);  // left in the image: azimuth grows
  EXPECT_GT(anglesOf(R * Eigen::Vector3d(0.0, -0.1, 1.0)).y(), 0.0);  // up in the image: elevation grows
}

}  // namespace
}  // namespace sightline::core
