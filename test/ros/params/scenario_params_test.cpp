#include "sightline/ros/params/scenario_params.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <unistd.h>

#include <gtest/gtest.h>

#include "sightline/core/simulation/sensor_simulator.h"

#include "support/paths.h"

namespace {

namespace core = sightline::core;
namespace fs = std::filesystem;
using sightline_ros::loadScenario;
using sightline_ros::ParamError;
using sightline_ros::ParamReader;

const fs::path kConfig = fs::path(sightline::test::sourceDirectory()) / "config";
const std::string kSixSensors = kConfig / "sensors/six_sensors.yaml";

core::Scenario shipped(const std::string& name) {
  return loadScenario(ParamReader::fromYamlFiles({kSixSensors, kConfig / "scenarios" / (name + ".yaml")}));
}

/// Those of the six sensors, or those that have stations and sensors themselves.
std::vector<std::string> namesOfShipped(bool with_stations = false) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(kConfig / "scenarios")) {
    if (ParamReader::fromYaml(entry.path()).has("stations") == with_stations)
      names.push_back(entry.path().stem());
  }
  return names;
}

core::Scenario shippedWithStations(const std::string& name) {
  return loadScenario(ParamReader::fromYaml(kConfig / "scenarios" / (name + ".yaml")));
}

core::Scenario loadText(const std::string& yaml) {
  const fs::path file =
      fs::temp_directory_path() / ("scenario_params_test_" + std::to_string(getpid()) + ".yaml");
  std::ofstream(file) << yaml;
  const ParamReader reader = ParamReader::fromYaml(file);
  fs::remove(file);
  return loadScenario(reader);
}

/// The complaint about a scenario, without the name of its file.
std::string refusalOf(const std::string& yaml) {
  try {
    loadText(yaml);
  } catch (const ParamError& refusal) {
    const std::string message = refusal.what();
    return message.substr(message.find(".yaml") + 5);
  }
  return "no refusal";
}

const core::SimulatedSensor& sensorOf(const core::Scenario& scenario, const std::string& name) {
  for (const core::SimulatedSensor& sensor : scenario.sensors) {
    if (sensor.name == name) return sensor;
  }
  throw std::out_of_range(name);
}

/// Share of a sensor's scans that show each target, of those in which it exists and can be seen, before
/// `until` seconds, over the probability of detection: 1 = always in view.
std::vector<double> sharesInView(const core::Scenario& scenario, const core::SimulatedSensor& sensor,
                                 double until) {
  core::SensorSimulator simulator(scenario, sensor.name, core::Time{});
  std::vector<int> there(scenario.targets.size()), seen(scenario.targets.size());
  while (const auto simulated = simulator.next()) {
    const double time = core::seconds(simulated->scan.time.time_since_epoch());
    if (time >= until) break;
    for (std::size_t i = 0; i < scenario.targets.size(); ++i) {
      const core::Target& target = scenario.targets[i];
      there[i] += core::truthAt(scenario, target, time) && core::isVisible(target, time);
      for (const auto origin : simulated->origins) seen[i] += origin == target.id;
    }
  }
  std::vector<double> shares;
  for (std::size_t i = 0; i < scenario.targets.size(); ++i) {
    shares.push_back(there[i] > 0 ? seen[i] / (sensor.detection_probability * there[i]) : 0.0);
  }
  return shares;
}

// ---- the shipped files ----

TEST(ScenarioParams, EveryShippedScenarioLoadsWithTheSixSensors) {
  const auto names = namesOfShipped();
  EXPECT_GE(names.size(), 18U);
  for (const std::string& name : names) {
    SCOPED_TRACE(name);
    core::Scenario scenario;
    ASSERT_NO_THROW(scenario = shipped(name));
    EXPECT_EQ(scenario.sensors.size(), 6U);
    EXPECT_FALSE(scenario.targets.empty());
  }
}

TEST(ScenarioParams, EveryTargetOfAShippedScenarioIsSeenByMostSensors) {
  for (const std::string& name : namesOfShipped()) {
    const core::Scenario scenario = shipped(name);
    std::vector<double> in_view(scenario.targets.size());  // sensors' worth of sightings
    for (const core::SimulatedSensor& sensor : scenario.sensors) {
      const std::vector<double> shares = sharesInView(scenario, sensor, 45.0);
      for (std::size_t i = 0; i < shares.size(); ++i) in_view[i] += shares[i];
    }
    // The sensors of the moving platform share the horizon among them, three to a direction.
    for (std::size_t i = 0; i < in_view.size(); ++i) {
      EXPECT_GE(in_view[i], name == "moving_platform" ? 1.9 : 4.5)
          << name << ", target " << scenario.targets[i].id;
    }
  }
}

TEST(ScenarioParams, EveryShippedScenarioOfStationsHasItsSensorsOnThemAndTargetsInMetres) {
  const auto names = namesOfShipped(true);
  EXPECT_GE(names.size(), 6U);
  for (const std::string& name : names) {
    SCOPED_TRACE(name);
    core::Scenario scenario;
    ASSERT_NO_THROW(scenario = shippedWithStations(name));
    EXPECT_GE(scenario.stations.size(), 2U);
    for (const core::SimulatedSensor& sensor : scenario.sensors)
      EXPECT_NE(core::stationOf(scenario, sensor), nullptr) << sensor.name;
    for (const core::Target& target : scenario.targets)
      EXPECT_TRUE(core::positionAt(target.trajectory, 1.0)) << target.id;
  }
}

TEST(ScenarioParams, EveryTargetOfAShippedScenarioOfStationsIsSeenByTwoOfThem) {
  for (const std::string& name : namesOfShipped(true)) {
    const core::Scenario scenario = shippedWithStations(name);
    std::vector<double> in_view(scenario.targets.size());  // sensors' worth of sightings
    for (const core::SimulatedSensor& sensor : scenario.sensors) {
      const std::vector<double> shares = sharesInView(scenario, sensor, 30.0);
      for (std::size_t i = 0; i < shares.size(); ++i) in_view[i] += shares[i];
    }
    for (std::size_t i = 0; i < in_view.size(); ++i)
      EXPECT_GE(in_view[i], 1.8) << name << ", target " << scenario.targets[i].id;
  }
}

TEST(ScenarioParams, StationsAndObstaclesAreReadWithTheirErrors) {
  const core::Scenario scenario = shippedWithStations("stations_field");
  ASSERT_EQ(scenario.stations.size(), 4U);
  EXPECT_EQ(scenario.stations[1].name, "station_2");
  EXPECT_EQ(scenario.stations[1].clock_behind, 0.003);
  EXPECT_EQ(scenario.stations[1].clock_drift, 2e-6);
  EXPECT_EQ(scenario.stations[2].misorientation, Eigen::Vector3d(0.0002, 0.0, 0.0004));
  EXPECT_EQ(core::platformAt(scenario.stations[3].motion, 0.0).position, Eigen::Vector3d(-25.0, 110.0, 6.0));
  ASSERT_EQ(scenario.obstacles.size(), 1U);
  EXPECT_EQ(scenario.obstacles[0].high.z(), 18.0);
  EXPECT_NE(refusalOf("targets: []\nsensors: {a: {station: ship}}").find("there is no such station"),
            std::string::npos);
  EXPECT_NE(refusalOf("targets: []\nstations: {a: {clock_drift: 0.1}}").find("/stations/a/clock_drift"),
            std::string::npos);
  EXPECT_NE(refusalOf("targets: []\nobstacles: [{low: [0, 0, 0], high: [1, 1, 0]}]").find("corner"),
            std::string::npos);
}

TEST(ScenarioParams, DefaultScenarioIsThePapersBenchmark) {
  const core::Scenario scenario = shipped("six_sensors_paper");
  for (const double time : {0.0, 1.0, 4.0, 100.0}) {
    const core::AngularState truth = *core::truthAt(scenario, scenario.targets.at(0), time);
    EXPECT_NEAR(truth.mean(0), core::wrapAngle(std::sin(time)), 1e-12);
    EXPECT_NEAR(truth.mean(1), std::cos(time), 1e-12);
  }
  for (const core::SimulatedSensor& sensor : scenario.sensors) {
    const double sigma = sensor.name.find("acquisition") == 0 ? 0.15 : 0.08;
    EXPECT_EQ(sensor.sigma, Eigen::Vector2d::Constant(sigma));
    EXPECT_NEAR(core::expectedRate(sensor.timing), 100.0 / 3.0, 1e-9);
    EXPECT_TRUE(sensor.sequence.empty());
  }
  EXPECT_TRUE(std::isinf(scenario.duration));
}

TEST(ScenarioParams, PaperFileSaysTheDefaultsOfTheCore) {
  const core::Scenario scenario = shipped("six_sensors_paper");
  const core::SimulatedSensor bare = loadText("targets: []\nsensors: {a: {}}").sensors.at(0);
  const core::SimulatedSensor& tracking = sensorOf(scenario, "tracking_1");
  EXPECT_EQ(tracking.sigma, bare.sigma);
  EXPECT_EQ(tracking.relative_sigma, bare.relative_sigma);
  EXPECT_EQ(tracking.bias, bare.bias);
  EXPECT_EQ(tracking.field_of_view, bare.field_of_view);
  EXPECT_EQ(tracking.clutter_density, bare.clutter_density);
  EXPECT_EQ(tracking.mount_attitude, bare.mount_attitude);
  EXPECT_EQ(tracking.mount_position, bare.mount_position);
  EXPECT_EQ(tracking.ifov, bare.ifov);
  EXPECT_TRUE(tracking.timing == bare.timing);
  EXPECT_EQ(tracking.detection_probability, bare.detection_probability);
  EXPECT_EQ(scenario.seed, core::Scenario{}.seed);
}

TEST(ScenarioParams, ScenarioFileOverridesTheSensorsFileKeyByKey) {
  const core::SimulatedSensor tracking = sensorOf(shipped("small_angle"), "tracking_2");
  EXPECT_EQ(tracking.sigma, Eigen::Vector2d::Constant(1e-5));  // of the scenario
  EXPECT_EQ(tracking.latency, 0.002);                          // of the sensors' file
  const core::Scenario degraded = shipped("degraded_sensor");
  EXPECT_EQ(sensorOf(degraded, "tracking_1").degradations.size(), 1U);  // of the scenario, for one sensor
  EXPECT_EQ(sensorOf(degraded, "tracking_1").sigma, Eigen::Vector2d::Constant(0.08));
  EXPECT_TRUE(sensorOf(degraded, "tracking_3").degradations.empty());
}

// ---- structure ----

TEST(ScenarioParams, SensorWinsOverItsGroup) {
  const core::Scenario scenario = loadText(
      "targets: []\n"
      "groups: {fine: {ifov: 0.002, sigma: [0.1, 0.2], timing: {kind: fixed, rate: 20.0}, outages: [{from: "
      "1.0}]}}\n"
      "sensors:\n"
      "  a: {group: fine, ifov: 0.003, timing: {rate: 25}}\n"
      "  b: {group: fine, outages: []}\n"
      "  c: {}\n");
  const auto &a = sensorOf(scenario, "a"), &b = sensorOf(scenario, "b"), &c = sensorOf(scenario, "c");
  EXPECT_EQ(a.ifov, 0.003);
  EXPECT_EQ(a.sigma, Eigen::Vector2d(0.1, 0.2));
  EXPECT_EQ(a.timing.kind, core::SightingTiming::Kind::fixed);
  EXPECT_EQ(a.timing.rate, 25.0);
  ASSERT_EQ(a.outages.size(), 1U);
  EXPECT_TRUE(std::isinf(a.outages[0].to));
  EXPECT_EQ(b.ifov, 0.002);
  EXPECT_EQ(b.timing.rate, 20.0);
  EXPECT_TRUE(b.outages.empty());
  EXPECT_EQ(c.ifov, core::SimulatedSensor{}.ifov);
}

TEST(ScenarioParams, SynchronousGroupsLookAtTheSameTimes) {
  const std::string sensors = "sensors: {a: {group: x}, b: {group: x}, c: {group: y}, d: {}}\ntargets: []\n";
  const core::Scenario alone = loadText(sensors);
  for (const auto& sensor : alone.sensors) EXPECT_EQ(sensor.sequence, "");
  const core::Scenario together = loadText(sensors + "synchronous_groups: true\n");
  EXPECT_EQ(sensorOf(together, "a").sequence, "x");
  EXPECT_EQ(sensorOf(together, "b").sequence, "x");
  EXPECT_EQ(sensorOf(together, "c").sequence, "y");
  EXPECT_EQ(sensorOf(together, "d").sequence, "");
}

TEST(ScenarioParams, ZeroMeansForEverWhereATimeEnds) {
  const core::Scenario scenario =
      loadText("duration: 0.0\ntargets: [{trajectory: line, end: 0.0}, {end: 5}]");
  EXPECT_TRUE(std::isinf(scenario.duration));
  EXPECT_TRUE(std::isinf(scenario.targets[0].end));
  EXPECT_EQ(scenario.targets[1].end, 5.0);
  EXPECT_EQ(scenario.targets[1].id, 2U);
}

TEST(ScenarioParams, SeedChangesARandomTrajectory) {
  const std::string targets = "targets: [{trajectory: white_acceleration, density: 0.1}]\n";
  const auto angles = [&](const std::string& seed) {
    const core::Scenario scenario = loadText(targets + seed);
    return core::truthAt(scenario, scenario.targets[0], 3.0)->angles();
  };
  EXPECT_EQ(angles("seed: 3"), angles("seed: 3"));
  EXPECT_NE(angles("seed: 3"), angles("seed: 4"));
}

TEST(ScenarioParams, EveryKindOfTrajectoryIsRead) {
  const core::Scenario scenario = loadText(
      "targets:\n"
      "  - {trajectory: sinusoid, amplitude: [0.1, 0.2], frequency: [2, 3], phase: [0, 0], offset: [1, 0]}\n"
      "  - {trajectory: line, angles: [0.1, 0.2], rates: [0.3, 0.4]}\n"
      "  - {trajectory: weave, angles: [0.1, 0], rates: [0, 0], azimuth: [{from: 0, to: 1, constant: 2.0}]}\n"
      "  - {trajectory: white_acceleration, density: 0.0, angles: [0.5, 0], rates: [0.1, 0]}\n"
      "  - {trajectory: waypoints, waypoints: [{time: 0, angles: [0, 0]}, {time: 1, angles: [0.5, 0]}]}\n"
      "  - {trajectory: waypoints, waypoints: [{time: 0, position: [9, 0, 0]}, {time: 1, position: [9, 9, "
      "0]}]}\n"
      "  - {trajectory: flight, position: [7, 0, 0], velocity: [0, 7, 0]}\n"
      "  - {trajectory: zenith_pass, altitude: 10, zenith_distance: 0.1, closest_time: 1.0, speed: 1.0}\n"
      "  - {trajectory: boost, site: [0, 10, 0], stages: [{acceleration: 19.80665, burn: 5, elevation_start: "
      "deg(90)}]}\n");
  const auto at = [&](std::size_t target, double time) {
    return core::truthAt(scenario, scenario.targets.at(target), time)->angles();
  };
  EXPECT_NEAR(at(0, 0.5).x(), 1.0 + 0.1 * std::sin(1.0), 1e-12);
  EXPECT_NEAR(at(1, 1.0).y(), 0.6, 1e-12);
  EXPECT_NEAR(at(2, 1.0).x(), 1.1, 1e-12);
  EXPECT_NEAR(at(3, 4.0).x(), 0.9, 1e-12);
  EXPECT_NEAR(at(4, 1.0).x(), 0.5, 1e-12);
  EXPECT_NEAR(at(5, 1.0).x(), M_PI / 4.0, 1e-12);
  EXPECT_NEAR(at(6, 1.0).x(), M_PI / 4.0, 1e-12);
  EXPECT_NEAR(at(7, 1.0).y(), M_PI / 2.0 - 0.1, 1e-12);
  EXPECT_NEAR(at(8, std::sqrt(2.0)).y(), M_PI / 4.0, 1e-12);  // 10 m up at a net 10 m/s^2
}

TEST(ScenarioParams, EveryKindOfPlatformMotionIsRead) {
  const auto at = [](const std::string& platform, double time) {
    return core::platformAt(loadText("targets: []\nplatform: " + platform).platform, time).position;
  };
  EXPECT_LT((at("{motion: fixed, position: [1, 2, 3]}", 9.0) - Eigen::Vector3d(1, 2, 3)).norm(), 1e-12);
  EXPECT_LT((at("{motion: straight, velocity: [1, 2, 3]}", 2.0) - Eigen::Vector3d(2, 4, 6)).norm(), 1e-12);
  EXPECT_LT((at("{motion: orbit, radius: 10, centre: [5, 0, 0]}", 0.0) - Eigen::Vector3d(15, 0, 0)).norm(),
            1e-12);
}

TEST(ScenarioParams, SwingOfAPlatformAndTimesOfInvisibilityAreRead) {
  const core::Scenario scenario = loadText(
      "{targets: [{trajectory: line, invisible: [{from: 2, to: 3.5}, {from: 9}]}],"
      " platform: {motion: straight, swing: [0.1, 0.2, 1], swing_period: 1.8}}");
  const auto platform = std::get<core::StraightPlatform>(scenario.platform);
  EXPECT_EQ(platform.swing, Eigen::Vector3d(0.1, 0.2, 1.0));
  EXPECT_EQ(platform.swing_period, 1.8);
  const core::Target& target = scenario.targets.at(0);
  EXPECT_TRUE(core::isVisible(target, 1.99));
  EXPECT_FALSE(core::isVisible(target, 2.0));
  EXPECT_TRUE(core::isVisible(target, 3.5));
  EXPECT_FALSE(core::isVisible(target, 1e6));
}

// ---- refusals ----

TEST(ScenarioParams, MissingScenarioSaysWhatToLoad) {
  EXPECT_EQ(refusalOf("{}"),
            "/targets: expected a list of targets, but it is not set (load a file of config/scenarios here)");
}

TEST(ScenarioParams, UnknownKeysAreRefusedAtEveryLevel) {
  EXPECT_NE(refusalOf("targets: []\nseeed: 1").find("did you mean"), std::string::npos);
  EXPECT_NE(refusalOf("targets: [{trajectory: line, amplitude: [1, 1]}]").find("/targets[0]/amplitude"),
            std::string::npos);
  EXPECT_NE(refusalOf("targets: []\nsensors: {a: {timing: {rte: 3.0}}}").find("/sensors/a/timing/rte"),
            std::string::npos);
  EXPECT_NE(
      refusalOf("targets: []\nsensors: {a: {group: g}}\ngroups: {g: {sigmas: 1.0}}").find("/groups/g/sigmas"),
      std::string::npos);
  EXPECT_NE(refusalOf("targets: []\nsensors: {a: {group: g}}\ngroups: {h: {ifov: 0.1}}").find("/groups/h"),
            std::string::npos);
}

TEST(ScenarioParams, WrongValuesAreRefusedWithPlaceAndUnit) {
  EXPECT_NE(refusalOf("targets: []\nsensors: {a: {sigma: [0.1]}}")
                .find("/sensors/a/sigma: expected a list of 2 numbers [rad], got 1"),
            std::string::npos);
  EXPECT_NE(refusalOf("targets: []\nsensors: {a: {sigma: [1e-5, 1e-5]}}").find("/sensors/a/sigma"),
            std::string::npos);
  EXPECT_NE(
      refusalOf("targets: []\nsensors: {a: {field_of_view: [60.0, 40.0]}}").find("/sensors/a/field_of_view"),
      std::string::npos);
  EXPECT_NE(refusalOf("targets: []\nsensors: {a: {latency: -0.1}}").find("[s]"), std::string::npos);
  EXPECT_NE(
      refusalOf("targets: [{trajectory: zigzag}]").find("/targets[0]/trajectory: expected one of boost, "),
      std::string::npos);
  EXPECT_NE(
      refusalOf("targets: []\nplatform: {motion: orbit, angular_rate: 0.0}").find("/platform/motion: orbit"),
      std::string::npos);
  EXPECT_NE(refusalOf("targets: [{trajectory: boost}]").find("/targets[0]/trajectory: boost: a boost needs"),
            std::string::npos);
  EXPECT_NE(refusalOf("targets: [{trajectory: waypoints, waypoints: [{time: 0, angles: [0, 0]}, {time: 1}]}]")
                .find("/targets[0]/waypoints[1]/angles"),
            std::string::npos);
  EXPECT_NE(refusalOf("targets: [{id: 3}, {id: 3}]").find("target 3: its id is given twice"),
            std::string::npos);
  EXPECT_NE(refusalOf("targets: []\nsensors: {2nd: {}}").find("a sensor's name must consist"),
            std::string::npos);
}

}  // namespace
