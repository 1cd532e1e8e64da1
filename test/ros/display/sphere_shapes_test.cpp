#include "sightline/ros/display/sphere_shapes.h"

#include <cmath>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "sightline/core/model/sphere.h"

namespace {

namespace core = sightline::core;
using sightline_ros::Directions;

/// Ordinary places, the wrap, near the zenith, the zenith and the nadir (azimuth, elevation) [rad].
const std::vector<Eigen::Vector2d>& places() {
  static const std::vector<Eigen::Vector2d> all = {{0.0, 0.0},
                                                   {0.7, -0.4},
                                                   {core::kPi - 1e-3, 0.2},
                                                   {-2.0, core::kPi / 2.0 - 1e-4},
                                                   {1.0, core::kPi / 2.0},
                                                   {0.3, -core::kPi / 2.0}};
  return all;
}

TEST(SphereShapes, TangentIsTheWayThatAWalkGoes) {
  for (const Eigen::Vector2d& place : places()) {
    for (const Eigen::Vector2d& way : {Eigen::Vector2d(0.3, 0.0), Eigen::Vector2d(-0.2, 0.9),
                                       Eigen::Vector2d(1e-7, -2e-7), Eigen::Vector2d(0.0, 0.0)}) {
      const Eigen::Vector3d end = sightline_ros::walk(place, way);
      EXPECT_NEAR(end.norm(), 1.0, 1e-12);
      EXPECT_NEAR(core::angleBetween(core::directionOf(place), end), way.norm(), 1e-12);
      EXPECT_LT((sightline_ros::tangentTo(place, end) - way).norm(), 1e-12) << place.transpose();
    }
  }
}

TEST(SphereShapes, TangentPointsAlongGrowingAzimuthAndElevation) {
  const Eigen::Vector2d place(core::kPi - 1e-4, 0.5);
  const Eigen::Vector3d across_the_wrap = core::directionOf({-core::kPi + 1e-4, 0.5});
  EXPECT_NEAR(sightline_ros::tangentTo(place, across_the_wrap).x(), 2e-4 * std::cos(0.5), 1e-10);
  EXPECT_NEAR(sightline_ros::tangentTo(place, core::directionOf({place.x(), 0.6})).y(), 0.1, 1e-12);
}

TEST(SphereShapes, EllipseLiesAtTwoSigmaOfTheDirection) {
  Eigen::Matrix2d tangent;  // what a sensor there would have in arc length [rad^2]
  tangent << 4e-4, 1e-4, 1e-4, 1e-4;
  for (const Eigen::Vector2d& place : places()) {
    const Directions outline = sightline_ros::ellipseOutline(place, tangent, 2.0);
    ASSERT_EQ(outline.size(), 49U);
    EXPECT_EQ(outline.front(), outline.back());
    for (const Eigen::Vector3d& corner : outline) {
      EXPECT_NEAR(corner.norm(), 1.0, 1e-12);
      const Eigen::Vector2d offset = sightline_ros::tangentTo(place, corner);
      EXPECT_NEAR(offset.dot(tangent.ldlt().solve(offset)), 4.0, 1e-6) << place.transpose();
    }
  }
}

TEST(SphereShapes, EllipseOfARoundErrorIsRoundAtAnyElevation) {
  constexpr double kSigma = 0.01;
  for (const double elevation : {0.0, 1.0, 1.55, core::kPi / 2.0 - 1e-5}) {
    const Eigen::Vector2d place(3.1, elevation);
    // The azimuth's own variance grows towards the zenith.
    const double sigma_azimuth = kSigma / std::cos(elevation);
    const Eigen::Matrix2d covariance =
        Eigen::Vector2d(sigma_azimuth * sigma_azimuth, kSigma * kSigma).asDiagonal();
    const Eigen::Matrix2d tangent = sightline_ros::tangentCovariance(place, covariance);
    for (const Eigen::Vector3d& corner : sightline_ros::ellipseOutline(place, tangent, 2.0)) {
      EXPECT_NEAR(core::angleBetween(core::directionOf(place), corner), 2.0 * kSigma, 1e-9);
    }
  }
}

TEST(SphereShapes, SemiAxesAreTheRootsOfTheEigenvaluesTheLargerFirst) {
  const Eigen::Rotation2Dd turn(0.6);
  const Eigen::Matrix2d R = turn.toRotationMatrix();
  const Eigen::Matrix2d covariance = R * Eigen::Vector2d(4e-10, 9e-10).asDiagonal() * R.transpose();
  EXPECT_NEAR(sightline_ros::semiAxes(covariance).x(), 3e-5, 1e-9);
  EXPECT_NEAR(sightline_ros::semiAxes(covariance).y(), 2e-5, 1e-9);
}

TEST(SphereShapes, RectangleKeepsItsSidesAcrossTheWrap) {
  const sightline_ros::AngleRectangle rectangle{{core::kPi - 0.05, 0.3}, {0.2, 0.1}};
  for (const Eigen::Vector3d& corner : sightline_ros::rectangleOutline(rectangle, 0.02)) {
    const Eigen::Vector2d off = core::angleDifference(core::anglesOf(corner), rectangle.centre).cwiseAbs();
    const bool on_upright = std::abs(off.x() - 0.2) < 1e-9 && off.y() < 0.1 + 1e-9;
    const bool on_level = std::abs(off.y() - 0.1) < 1e-9 && off.x() < 0.2 + 1e-9;
    EXPECT_TRUE(on_upright || on_level) << off.transpose();
  }
}

TEST(SphereShapes, RectangleIsCutAtThePoleAndAtOneTurn) {
  const sightline_ros::AngleRectangle cap{{0.3, 1.5}, {100.0, 0.3}};
  const Directions patch = sightline_ros::rectanglePatch(cap, 0.05);
  ASSERT_EQ(patch.size() % 3, 0U);
  EXPECT_LE(patch.size(), 6U * 24U * 24U);
  for (const Eigen::Vector3d& vertex : patch) EXPECT_GE(core::anglesOf(vertex).y(), 1.2 - 1e-9);
}

TEST(SphereShapes, PatchCoversItsSolidAngle) {
  const sightline_ros::AngleRectangle rectangle{{2.0, 0.6}, {0.3, 0.2}};
  const Directions patch = sightline_ros::rectanglePatch(rectangle, 0.02);
  double area = 0.0;
  for (std::size_t i = 0; i < patch.size(); i += 3) {
    area += 0.5 * (patch[i + 1] - patch[i]).cross(patch[i + 2] - patch[i]).norm();
  }
  const double exact = 2.0 * 0.3 * (std::sin(0.8) - std::sin(0.4));
  EXPECT_NEAR(area, exact, 1e-3 * exact);
}

TEST(SphereShapes, GridLineGoesStraightInItsAnglesInSmallSteps) {
  const Directions parallel = sightline_ros::gridLine({3.0, 0.5}, {4.0, 0.5}, 0.1);
  EXPECT_EQ(parallel.size(), 11U);
  for (const Eigen::Vector3d& point : parallel) EXPECT_NEAR(core::anglesOf(point).y(), 0.5, 1e-12);
  EXPECT_LT((parallel.back() - core::directionOf({4.0, 0.5})).norm(), 1e-12);
}

}  // namespace
