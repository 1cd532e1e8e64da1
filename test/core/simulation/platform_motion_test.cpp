#include "sightline/core/simulation/platform_motion.h"

#include <cmath>

#include <gtest/gtest.h>

#include "sightline/core/model/sphere.h"

namespace sightline::core {
namespace {

Eigen::Vector3d forward(const PlatformState& state) {
  return state.R_world_platform.col(0);
}

TEST(Rotation, FollowsRep103) {
  EXPECT_LT((rotationOf({0.0, 0.0, 0.3}) * Eigen::Vector3d::UnitX() -
             Eigen::Vector3d(std::cos(0.3), std::sin(0.3), 0.0))
                .norm(),
            1e-15);
  EXPECT_LT((rotationOf({0.0, -0.3, 0.0}) * Eigen::Vector3d::UnitX() -  // a negative pitch looks up
             Eigen::Vector3d(std::cos(0.3), 0.0, std::sin(0.3)))
                .norm(),
            1e-15);
  EXPECT_LT((rotationOf({0.3, 0.0, 0.0}) * Eigen::Vector3d::UnitY() -
             Eigen::Vector3d(0.0, std::cos(0.3), std::sin(0.3)))
                .norm(),
            1e-15);
  // about fixed axes, roll first: yaw then turns what pitch has raised
  EXPECT_LT((rotationOf({0.0, -kPi / 2.0, 1.0}) * Eigen::Vector3d::UnitX() - Eigen::Vector3d::UnitZ()).norm(),
            1e-15);
}

TEST(PlatformMotion, FixedStaysWhereItIs) {
  const FixedPlatform fixed{{1.0, 2.0, 3.0}, {0.0, 0.0, kPi / 2.0}};
  const PlatformState state = platformAt(fixed, 1e6);
  EXPECT_EQ((state.position - fixed.position).norm(), 0.0);
  EXPECT_EQ(state.velocity.norm(), 0.0);
  EXPECT_LT((forward(state) - Eigen::Vector3d::UnitY()).norm(), 1e-15);
}

TEST(PlatformMotion, StraightLooksWhereItGoes) {
  const StraightPlatform straight{{1.0, 0.0, 0.0}, {-3.0, 4.0, 0.0}, {0.0, 0.0, 0.0}};
  const PlatformState state = platformAt(straight, 10.0);
  EXPECT_LT((state.position - Eigen::Vector3d(-29.0, 40.0, 0.0)).norm(), 1e-12);
  EXPECT_LT((5.0 * forward(state) - straight.velocity).norm(), 1e-12);
}

TEST(PlatformMotion, SwingTurnsThePlatformAboutItsCourseAndMovesItNowhere) {
  StraightPlatform straight{{0.0, 0.0, 0.0}, {0.0, 60.0, 0.0}, {0.0, 0.0, 0.0}};
  straight.swing = {0.0, 0.0, 1.0};
  straight.swing_period = 1.8;
  const auto yaw = [&](double time) {
    const Eigen::Vector3d ahead = forward(platformAt(straight, time));
    return std::atan2(ahead.y(), ahead.x()) - kPi / 2.0;
  };
  double fastest = 0.0, farthest = 0.0;
  for (double time = 0.0; time < 3.6; time += 0.01) {
    fastest = std::max(fastest, std::abs(yaw(time + 1e-4) - yaw(time - 1e-4)) / 2e-4);
    farthest = std::max(farthest, std::abs(yaw(time)));
    EXPECT_NEAR(yaw(time + 1.8), yaw(time), 1e-12);
    EXPECT_LT((platformAt(straight, time).position - Eigen::Vector3d(0.0, 60.0 * time, 0.0)).norm(), 1e-12);
  }
  EXPECT_NEAR(farthest, 1.0, 1e-3);
  EXPECT_NEAR(fastest, 2.0 * kPi / 1.8, 1e-2);
}

TEST(PlatformMotion, SwingGoesThroughItsAnglesOneAfterTheOther) {
  StraightPlatform straight;
  straight.swing = {0.3, 0.2, 0.1};
  straight.swing_period = 3.0;
  const double side = std::sqrt(0.75);
  EXPECT_LT((platformAt(straight, 0.0).R_world_platform - rotationOf({0.0, 0.2 * side, -0.1 * side})).norm(),
            1e-12);
  EXPECT_LT((platformAt(straight, 1.0).R_world_platform - rotationOf({0.3 * side, -0.2 * side, 0.0})).norm(),
            1e-12);
}

TEST(PlatformMotion, SwingNeedsAPeriod) {
  StraightPlatform straight;
  straight.swing_period = 0.0;
  EXPECT_NE(textOf(refusalOf(PlatformMotion(straight)).value()).find("swing_period"), std::string::npos);
}

TEST(PlatformMotion, OrbitKeepsItsRadiusAndTurnsWithItsCourse) {
  for (const double rate : {0.05, -0.2}) {
    OrbitPlatform orbit;
    orbit.centre = {10.0, 20.0, 30.0};
    orbit.angular_rate = rate;
    orbit.phase = 1.0;
    const double h = 1e-4;
    for (const double time : {0.0, 7.0, 100.0}) {
      const PlatformState state = platformAt(orbit, time);
      EXPECT_NEAR((state.position - orbit.centre).norm(), orbit.radius, 1e-9);
      const Eigen::Vector3d slope =
          (platformAt(orbit, time + h).position - platformAt(orbit, time - h).position) / (2.0 * h);
      EXPECT_LT((state.velocity - slope).norm(), 1e-5);
      EXPECT_LT((forward(state) - state.velocity.normalized()).norm(), 1e-12);
    }
    const double round = 2.0 * kPi / std::abs(rate);
    EXPECT_LT((platformAt(orbit, round).position - platformAt(orbit, 0.0).position).norm(), 1e-9);
  }
}

TEST(PlatformMotion, OrbitThatDoesNotMoveIsRefused) {
  OrbitPlatform orbit;
  orbit.angular_rate = 0.0;
  EXPECT_NE(textOf(refusalOf(PlatformMotion(orbit)).value()).find("fixed"), std::string::npos);
  EXPECT_FALSE(refusalOf(PlatformMotion(OrbitPlatform{})));
  EXPECT_FALSE(refusalOf(PlatformMotion(FixedPlatform{})));
  EXPECT_FALSE(refusalOf(PlatformMotion(StraightPlatform{})));
}

}  // namespace
}  // namespace sightline::core
