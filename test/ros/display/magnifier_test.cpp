#include "sightline/ros/display/magnifier.h"

#include <cmath>

#include <gtest/gtest.h>

#include "sightline/core/model/sphere.h"

namespace {

namespace core = sightline::core;

TEST(Magnifier, FactorMakesAnyUncertaintyFillAPartOfTheInset) {
  using sightline_ros::Magnifier;
  for (double two_sigma = 1e-8; two_sigma < 0.01; two_sigma *= 1.7) {
    const double filled = Magnifier::factorFor(two_sigma, 0.0) * two_sigma / Magnifier::kRadius;
    EXPECT_GE(filled, 0.139) << two_sigma;
    EXPECT_LE(filled, 0.351) << two_sigma;
  }
}

TEST(Magnifier, FactorStaysWhileItServes) {
  using sightline_ros::Magnifier;
  const double factor = Magnifier::factorFor(1e-5, 0.0);
  EXPECT_EQ(Magnifier::factorFor(1.5e-5, factor), factor);
  EXPECT_EQ(Magnifier::factorFor(0.8e-5, factor), factor);
  EXPECT_LT(Magnifier::factorFor(1e-4, factor), factor);
  EXPECT_GT(Magnifier::factorFor(1e-6, factor), factor);
}

TEST(Magnifier, OffsetsAreScaledRoundTheTargetOfTheirMoment) {
  const Eigen::Vector2d target(3.1, 0.4), then(2.9, 0.3);
  const sightline_ros::Magnifier magnifier(target, {0.0, -1.0}, 1000.0);
  const Eigen::Vector3d seen = sightline_ros::walk(then, {5e-5, -2e-5});
  const Eigen::Vector2d place = magnifier.place(seen, then);
  EXPECT_TRUE(magnifier.shows(place));
  const Eigen::Vector2d offset = sightline_ros::tangentTo(magnifier.centre(), core::directionOf(place));
  EXPECT_NEAR(offset.x(), 0.05, 1e-6);
  EXPECT_NEAR(offset.y(), -0.02, 1e-6);
  EXPECT_FALSE(magnifier.shows(magnifier.place(sightline_ros::walk(then, {1e-2, 0.0}), then)));
}

TEST(Magnifier, CovarianceGrowsWithTheSquareOfTheFactorAndIsAnArc) {
  const sightline_ros::Magnifier magnifier({0.0, 0.0}, {1.0, 0.0}, 100.0);
  const Eigen::Vector2d angles(0.3, 1.0);
  const Eigen::Matrix2d magnified =
      magnifier.magnified(angles, Eigen::Vector2d(4e-10, 1e-10).asDiagonal().toDenseMatrix());
  EXPECT_NEAR(magnified(0, 0), 1e4 * 4e-10 * std::pow(std::cos(1.0), 2), 1e-15);
  EXPECT_NEAR(magnified(1, 1), 1e-6, 1e-15);
}

TEST(Magnifier, OnlyErrorsThatCannotBeSeenAreMagnified) {
  EXPECT_TRUE(sightline_ros::Magnifier::isNeededFor(9e-3));
  EXPECT_FALSE(sightline_ros::Magnifier::isNeededFor(0.02));
}

}  // namespace
