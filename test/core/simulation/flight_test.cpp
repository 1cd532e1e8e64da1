#include "sightline/core/simulation/flight.h"

#include <cmath>

#include <gtest/gtest.h>

#include "sightline/core/model/sphere.h"
#include "sightline/core/simulation/trajectory.h"

#include "support/integrated.h"

namespace sightline::core {
namespace {

using test::integrated;

Boost twoStages() {
  Boost boost;
  boost.stages = {{35.0, 8.0, 3.0, 1.5, 1.2}, {50.0, 12.0, 1.0, 1.2, 0.4}};
  return boost;
}

TEST(ZenithPass, ComesAsNearToTheZenithAsAskedAndNoNearer) {
  for (const double distance : {0.3, 0.02, 1e-4, -0.02}) {
    ZenithPass pass;
    pass.zenith_distance = distance;
    double nearest = kPi;
    for (double time = 0.0; time < 2.0 * pass.closest_time; time += 0.01) {
      const double elevation = stateSeenFrom(PlatformState{}, pass, time)->mean(1);
      nearest = std::min(nearest, kPi / 2.0 - elevation);
    }
    EXPECT_NEAR(nearest, std::abs(distance), 1e-9);
    const AngularState closest = *stateSeenFrom(PlatformState{}, pass, pass.closest_time);
    EXPECT_NEAR(kPi / 2.0 - closest.mean(1), std::abs(distance), 1e-9);
    EXPECT_NEAR(closest.mean(3), 0.0, 1e-9);
    const double side = wrapAngle(closest.mean(0) - pass.course);
    EXPECT_NEAR(side, std::copysign(kPi / 2.0, distance), 1e-6);  // to the left when positive
  }
}

TEST(Boost, IntegratesThrustAndGravityThroughItsStages) {
  const Boost boost = twoStages();
  const auto thrust = [&](double t) -> Eigen::Vector2d {
    for (const BoostStage& stage : boost.stages) {
      if (t < stage.burn) {
        const double elevation =
            stage.elevation_start + (stage.elevation_end - stage.elevation_start) * t / stage.burn;
        return stage.acceleration * Eigen::Vector2d(std::cos(elevation), std::sin(elevation));
      }
      t -= stage.burn + stage.coast;
      if (t < 0.0) return Eigen::Vector2d::Zero();
    }
    return Eigen::Vector2d::Zero();
  };
  for (const double time : {0.5, 8.0, 9.5, 11.0, 20.0, 23.0, 60.0}) {
    const SpatialMotion motion = motionAt(boost, time);
    const Eigen::Vector3d flown = motion.position - boost.site;
    const double downrange = integrated([&](double t) { return thrust(t).x(); }, 0.0, 0.0, time);
    const double height = integrated([&](double t) { return thrust(t).y() - kGravity; }, 0.0, 0.0, time);
    EXPECT_NEAR(flown.head<2>().norm(), downrange, 0.5) << time;  // Simpson's rule stumbles at each staging
    EXPECT_NEAR(flown.z(), height, 0.5) << time;
    EXPECT_NEAR(std::atan2(flown.y(), flown.x()), boost.course, 1e-9);
  }
}

TEST(Boost, SpeedIsContinuousThroughStaging) {
  const Boost boost = twoStages();
  for (const double border : {8.0, 11.0, 23.0, 24.0}) {
    const SpatialMotion before = motionAt(boost, border - 1e-9), after = motionAt(boost, border + 1e-9);
    EXPECT_LT((before.velocity - after.velocity).norm(), 1e-6);
    EXPECT_LT((before.position - after.position).norm(), 1e-5);
  }
}

TEST(Boost, StandsOnTheGroundAtLaunchAndRestsThereAfterTheFall) {
  const Boost boost = twoStages();
  EXPECT_EQ((motionAt(boost, 0.0).position - boost.site).norm(), 0.0);
  EXPECT_EQ(motionAt(boost, 0.0).velocity.norm(), 0.0);
  const SpatialMotion rest = motionAt(boost, 1e5);
  EXPECT_EQ(rest.position.z(), boost.site.z());
  EXPECT_EQ(rest.velocity.norm(), 0.0);
  EXPECT_EQ((motionAt(boost, 2e5).position - rest.position).norm(), 0.0);
  for (double time = 0.0; time < 400.0; time += 0.5)
    EXPECT_GE(motionAt(boost, time).position.z(), boost.site.z());
}

TEST(Boost, FlyingIntoTheGroundUnderThrustEndsThere) {
  Boost dive;
  dive.stages = {{20.0, 5.0, 0.0, 1.2, 1.0}, {20.0, 60.0, 0.0, -1.0, -1.2}};
  EXPECT_EQ(motionAt(dive, 64.0).position.z(), dive.site.z());
  EXPECT_EQ(motionAt(dive, 64.0).velocity.norm(), 0.0);
}

TEST(Boost, ThatCannotLiftOffIsRefused) {
  Boost boost;
  boost.stages = {{9.0, 10.0, 0.0, 1.5, 1.5}};
  EXPECT_NE(textOf(refusalOf(boost).value()).find("does not lift off"), std::string::npos);
  boost.stages = {{40.0, 0.0, 0.0, 1.5, 1.5}};
  EXPECT_NE(textOf(refusalOf(boost).value()).find("burn > 0 s"), std::string::npos);
  boost.stages.clear();
  EXPECT_TRUE(refusalOf(boost));
}

TEST(ZenithPass, FaultsAreNamed) {
  ZenithPass pass;
  pass.zenith_distance = 2.0;
  EXPECT_NE(textOf(refusalOf(pass).value()).find("degrees"), std::string::npos);
  pass = ZenithPass{};
  pass.altitude = -1.0;
  EXPECT_NE(textOf(refusalOf(pass).value()).find("altitude"), std::string::npos);
}

TEST(SpatialOrbit, KeepsItsRadiusAndItsSpeed) {
  const SpatialOrbit orbit{{10.0, 20.0, 30.0}, 25.0, -0.4, 1.0};
  for (const double time : {0.0, 3.0, 100.0}) {
    const SpatialMotion motion = motionAt(orbit, time);
    EXPECT_NEAR((motion.position - orbit.centre).norm(), 25.0, 1e-12);
    EXPECT_NEAR(motion.velocity.norm(), 10.0, 1e-12);
    const double h = 1e-5;
    const Eigen::Vector3d slope =
        (motionAt(orbit, time + h).position - motionAt(orbit, time - h).position) / (2.0 * h);
    EXPECT_LT((motion.velocity - slope).norm(), 1e-6);
  }
  EXPECT_TRUE(refusalOf(SpatialOrbit{{0.0, 0.0, 0.0}, 0.0, 1.0, 0.0}));
}

TEST(SpatialWhiteAcceleration, HasTheDensityOnEachAxisAndIsDrawnByItsSeed) {
  // The variance of a velocity after 4 s is 4 q.
  Eigen::Vector3d squares = Eigen::Vector3d::Zero();
  constexpr int kPaths = 400;
  SpatialWhiteAcceleration path;
  path.velocity = {1.0, -2.0, 0.5};
  path.density = 0.5;
  for (int i = 0; i < kPaths; ++i) {
    path.seed = static_cast<std::uint64_t>(i);
    squares += (motionAt(path, 4.0).velocity - path.velocity).cwiseAbs2();
  }
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(squares(axis) / kPaths, 2.0, 0.45) << axis;
  EXPECT_EQ(motionAt(path, 4.0).position, motionAt(path, 4.0).position);
  EXPECT_EQ(motionAt(path, 0.0).position, path.position);
  path.density = -1.0;
  EXPECT_NE(textOf(refusalOf(path).value()).find("density"), std::string::npos);
}

}  // namespace
}  // namespace sightline::core
