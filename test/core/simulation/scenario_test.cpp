#include "sightline/core/simulation/scenario.h"

#include <cmath>

#include <gtest/gtest.h>

#include "sightline/core/model/sphere.h"

namespace sightline::core {
namespace {

SimulatedSensor sensorCalled(const std::string& name) {
  SimulatedSensor sensor;
  sensor.name = name;
  return sensor;
}

Scenario paper() {
  Scenario scenario;
  scenario.targets = {{1, 0.0, std::numeric_limits<double>::infinity(), Sinusoid{}}};
  scenario.sensors = {sensorCalled("tracking_1"), sensorCalled("tracking_2")};
  return scenario;
}

TEST(Scenario, TruthLastsFromStartToEndOnTheTargetsOwnTime) {
  Scenario scenario = paper();
  Target& target = scenario.targets[0];
  target.start = 2.0;
  target.end = 5.0;
  EXPECT_FALSE(truthAt(scenario, target, 1.999));
  EXPECT_NEAR(truthAt(scenario, target, 2.0)->mean(1), 1.0, 1e-15);
  EXPECT_NEAR(truthAt(scenario, target, 3.0)->mean(0), std::sin(1.0), 1e-15);
  EXPECT_FALSE(truthAt(scenario, target, 5.0));
}

TEST(Scenario, TruthIsInTheAxesOfTheWorldHoweverThePlatformTurns) {
  Scenario scenario = paper();
  const AngularState still = *truthAt(scenario, scenario.targets[0], 1.0);
  scenario.platform = OrbitPlatform{};
  EXPECT_LT((truthAt(scenario, scenario.targets[0], 1.0)->mean - still.mean).norm(), 1e-15);
}

TEST(Scenario, TruthOfANearTargetMovesWithThePlatform) {
  Scenario scenario = paper();
  scenario.platform = OrbitPlatform{};
  scenario.targets[0].trajectory = StraightFlight{{2000.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};
  const double h = 1e-5;
  for (const double time : {0.0, 10.0, 40.0}) {
    const AngularState before = *truthAt(scenario, scenario.targets[0], time + 1.0 - h);
    const AngularState after = *truthAt(scenario, scenario.targets[0], time + 1.0 + h);
    const AngularState now = *truthAt(scenario, scenario.targets[0], time + 1.0);
    EXPECT_LT((now.rates() - angleDifference(after.angles(), before.angles()) / (2.0 * h)).norm(), 1e-8);
    EXPECT_GT(now.rates().norm(), 1e-4);
  }
}

TEST(Scenario, SensorSeesTheTargetThroughPlatformAndMount) {
  SimulatedSensor sensor = sensorCalled("side");
  sensor.mount_attitude = {0.0, 0.0, kPi / 2.0};  // to the left of the platform
  PlatformState platform;
  platform.R_world_platform = rotationOf({0.0, 0.0, kPi / 2.0});  // that goes north: the sensor looks west
  Target target;
  target.trajectory = AngularLine{{kPi, 0.2}, {0.0, 0.0}};
  const Eigen::Vector2d seen = anglesOf(*directionFromSensor(sensor, platform, target, 0.0));
  EXPECT_NEAR(seen.x(), 0.0, 1e-12);
  EXPECT_NEAR(seen.y(), 0.2, 1e-12);
}

TEST(Scenario, LeverArmShowsOnNearTargetsOnly) {
  SimulatedSensor sensor = sensorCalled("mast");
  sensor.mount_position = {0.0, 0.0, 10.0};
  Target near, far;
  near.trajectory = StraightFlight{{100.0, 0.0, 10.0}, {0.0, 0.0, 0.0}};
  far.trajectory = AngularLine{{0.0, 0.1}, {0.0, 0.0}};
  EXPECT_NEAR(anglesOf(*directionFromSensor(sensor, {}, near, 0.0)).y(), 0.0, 1e-15);
  EXPECT_NEAR(anglesOf(*directionFromSensor(sensor, {}, far, 0.0)).y(), 0.1, 1e-15);
}

TEST(Scenario, FaultsNameTheirPlace) {
  EXPECT_FALSE(refusalOf(paper()));

  Scenario twins = paper();
  twins.sensors[1].name = "tracking_1";
  EXPECT_EQ(textOf(refusalOf(twins).value()), "sensor tracking_1: its name is given twice");

  Scenario same_id = paper();
  same_id.targets.push_back(same_id.targets[0]);
  EXPECT_EQ(textOf(refusalOf(same_id).value()), "target 1: its id is given twice");

  Scenario no_id = paper();
  no_id.targets[0].id = 0;
  EXPECT_EQ(textOf(refusalOf(no_id).value()), "target 0: its id must be above 0");

  Scenario backwards = paper();
  backwards.targets[0].start = 3.0;
  backwards.targets[0].end = 2.0;
  EXPECT_NE(textOf(refusalOf(backwards).value()).find("target 1: it must start"), std::string::npos);

  Scenario never_hidden = paper();
  never_hidden.targets[0].invisible = {{3.0, 3.0}};
  EXPECT_NE(textOf(refusalOf(never_hidden).value()).find("target 1: a time in which it is invisible must"),
            std::string::npos);

  Scenario degrees = paper();
  degrees.sensors[0].field_of_view = {60.0, 40.0};
  EXPECT_NE(textOf(refusalOf(degrees).value()).find("sensor tracking_1: the field of view"),
            std::string::npos);

  Scenario no_floor = paper();
  no_floor.sensors[0].relative_sigma = 0.04;
  no_floor.sensors[0].sigma.setZero();
  EXPECT_NE(textOf(refusalOf(no_floor).value()).find("floor"), std::string::npos);

  Scenario crowded = paper();
  crowded.sensors[1].clutter_density = 1e6;
  EXPECT_NE(textOf(refusalOf(crowded).value()).find("sensor tracking_2: clutter_density"), std::string::npos);
}

TEST(Scenario, SensorsOfOneSequenceMustHaveOneTiming) {
  Scenario scenario = paper();
  for (SimulatedSensor& sensor : scenario.sensors) sensor.sequence = "tracking";
  EXPECT_FALSE(refusalOf(scenario));
  scenario.sensors[1].timing.spread = 0.04;
  EXPECT_NE(textOf(refusalOf(scenario).value()).find("the same timing"), std::string::npos);
}

/// A camera on a station that looks along x, with a target 100 m in front of it.
Scenario oneStation() {
  Scenario scenario;
  scenario.stations = {{"shore", FixedPlatform{{10.0, 0.0, 0.0}, {0.0, 0.0, 0.0}}}};
  scenario.sensors = {sensorCalled("camera")};
  scenario.sensors[0].station = "shore";
  Target target;
  target.trajectory = StraightFlight{{110.0, 0.0, 0.0}, {0.0, 5.0, 0.0}};
  scenario.targets = {target};
  return scenario;
}

TEST(Scenario, SensorOfAStationIsWhereTheStationIs) {
  const Scenario scenario = oneStation();
  EXPECT_FALSE(refusalOf(scenario));
  EXPECT_EQ(carrierAt(scenario, scenario.sensors[0], 0.0).position.x(), 10.0);
  EXPECT_EQ(stationOf(scenario, sensorCalled("other")), nullptr);
  EXPECT_EQ(positionTruthAt(scenario.targets[0], 2.0)->position.y(), 10.0);
  EXPECT_FALSE(positionTruthAt(paper().targets[0], 2.0)) << "given in angles";
}

TEST(Scenario, ObstacleHidesATargetFromASensorButNotAFarOneInAngles) {
  Scenario scenario = oneStation();
  EXPECT_FALSE(isHidden(scenario, scenario.sensors[0], scenario.targets[0], 0.0));
  scenario.obstacles = {{{50.0, -1.0, -1.0}, {51.0, 1.0, 1.0}}};
  EXPECT_TRUE(isHidden(scenario, scenario.sensors[0], scenario.targets[0], 0.0));
  EXPECT_FALSE(isHidden(scenario, scenario.sensors[0], scenario.targets[0], 10.0)) << "50 m to the side";
  EXPECT_FALSE(isHidden(scenario, scenario.sensors[0], paper().targets[0], 0.0));
}

TEST(Scenario, FaultsOfStationsAreNamed) {
  Scenario scenario = oneStation();
  scenario.sensors[0].station = "ship";
  EXPECT_NE(textOf(refusalOf(scenario).value()).find("sensor camera: it is on the station \"ship\""),
            std::string::npos);
  scenario = oneStation();
  scenario.stations[0].name = "platform";
  EXPECT_NE(textOf(refusalOf(scenario).value()).find("station platform"), std::string::npos);
  scenario = oneStation();
  scenario.obstacles = {Obstacle{}};
  EXPECT_NE(textOf(refusalOf(scenario).value()).find("corner"), std::string::npos);
}

}  // namespace
}  // namespace sightline::core
