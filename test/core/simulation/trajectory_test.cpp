#include "sightline/core/simulation/trajectory.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "sightline/core/model/sphere.h"

namespace sightline::core {
namespace {

PlatformState restingPlatform() {
  return {{100.0, -50.0, 20.0}, Eigen::Vector3d::Zero(), Eigen::Matrix3d::Identity()};
}

Boost twoStages() {
  Boost boost;
  boost.stages = {{35.0, 8.0, 3.0, 1.5, 1.2}, {50.0, 12.0, 1.0, 1.2, 0.4}};
  return boost;
}

struct Named {
  const char* name;
  Trajectory trajectory;
};

/// One of each kind, at its most awkward: across the wrap, over the pole, through stages.
std::vector<Named> everyKind() {
  WhiteAcceleration white;
  white.seed = 5;
  white.rates = {0.3, -0.2};
  AngularRoute angular_route;
  angular_route.points = {{0.0, {3.0, 0.0}}, {3.0, {-3.0, 0.4}}, {9.0, {-2.0, -0.2}}};
  SpatialRoute spatial_route;
  spatial_route.points = {
      {0.0, {900.0, 0.0, 100.0}}, {5.0, {500.0, 700.0, 300.0}}, {9.0, {-900.0, 200.0, 50.0}}};
  return {{"sinusoid", Sinusoid{}},         {"line", AngularLine{{2.0, 1.0}, {0.3, 0.2}}},
          {"weave", benchmarkWeave(1.0)},   {"white acceleration", white},
          {"angular route", angular_route}, {"straight flight", StraightFlight{}},
          {"zenith pass", ZenithPass{}},    {"boost", twoStages()},
          {"spatial route", spatial_route}};
}

Eigen::Vector2d anglesAt(const Trajectory& trajectory, double time) {
  return stateSeenFrom(restingPlatform(), trajectory, time)->angles();
}

TEST(Trajectory, RatesAreTheDerivativeOfTheAnglesForEveryKind) {
  const double h = 1e-6;
  for (const Named& kind : everyKind()) {
    for (double time = 0.0531; time < 40.0; time += 0.31) {
      const AngularState state = *stateSeenFrom(restingPlatform(), kind.trajectory, time);
      const Eigen::Vector2d slope =
          angleDifference(anglesAt(kind.trajectory, time + h), anglesAt(kind.trajectory, time - h)) /
          (2.0 * h);
      EXPECT_LT((state.rates() - slope).norm(), 1e-4 * (1.0 + state.rates().norm()))
          << kind.name << " at " << time;
    }
  }
}

TEST(Trajectory, AnglesAreInTheirRangesForEver) {
  for (const Named& kind : everyKind()) {
    for (const double time : {0.0, 1.0, 100.0, 1e4, 1e6}) {
      const AngularState state = *stateSeenFrom(restingPlatform(), kind.trajectory, time);
      EXPECT_TRUE(state.mean.allFinite()) << kind.name << " at " << time;
      EXPECT_LE(std::abs(state.mean(0)), kPi) << kind.name;
      EXPECT_LE(std::abs(state.mean(1)), kPi / 2.0) << kind.name;
      EXPECT_EQ(state.covariance.norm(), 0.0) << kind.name;
    }
  }
}

TEST(Trajectory, DirectionFromThePlatformIsThatOfTheAngles) {
  for (const Named& kind : everyKind()) {
    for (double time = 0.0; time < 30.0; time += 1.7) {
      const auto direction = directionSeenFrom(restingPlatform().position, kind.trajectory, time);
      EXPECT_LT(angleBetween(*direction, directionOf(anglesAt(kind.trajectory, time))), 1e-12) << kind.name;
    }
  }
}

TEST(Trajectory, EveryDefaultIsWithoutFault) {
  for (const Named& kind : everyKind()) EXPECT_FALSE(refusalOf(kind.trajectory)) << kind.name;
  EXPECT_FALSE(refusalOf(Trajectory(Boost{})));
}

TEST(StraightFlight, IsSeenWithParallax) {
  const StraightFlight flight{{1000.0, 0.0, 0.0}, {0.0, 100.0, 0.0}};
  PlatformState platform;
  platform.velocity = {0.0, 100.0, 0.0};
  const AngularState alongside = *stateSeenFrom(platform, flight, 0.0);
  EXPECT_LT(alongside.mean.norm(), 1e-15);
  platform.velocity.setZero();
  EXPECT_NEAR(stateSeenFrom(platform, flight, 0.0)->mean(2), 0.1, 1e-15);
  platform.position = {0.0, -1000.0, 0.0};
  EXPECT_NEAR(stateSeenFrom(platform, flight, 0.0)->mean(0), kPi / 4.0, 1e-15);
}

TEST(StraightFlight, HasNoDirectionAtThePlatformItself) {
  const StraightFlight flight{{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}};
  EXPECT_FALSE(stateSeenFrom(PlatformState{}, flight, 0.0));
  EXPECT_TRUE(stateSeenFrom(PlatformState{}, flight, 1.0));
}

TEST(Trajectory, InAnglesHasNoPlaceInSpaceAndOneInMetresHas) {
  EXPECT_FALSE(positionAt(AngularLine{}, 1.0));
  const auto motion = positionAt(StraightFlight{{1.0, 2.0, 3.0}, {0.0, 10.0, 0.0}}, 2.0);
  ASSERT_TRUE(motion);
  EXPECT_EQ(motion->position, Eigen::Vector3d(1.0, 22.0, 3.0));
}

}  // namespace
}  // namespace sightline::core
