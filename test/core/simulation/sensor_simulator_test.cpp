#include "sightline/core/simulation/sensor_simulator.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

#include "sightline/core/model/sphere.h"

namespace sightline::core {
namespace {

using std::chrono::milliseconds;

const Time kStart = timeOf(1'600'000'000'000'000'000);

SimulatedSensor sensorCalled(const std::string& name) {
  SimulatedSensor sensor;
  sensor.name = name;
  return sensor;
}

Target standingAt(double azimuth, double elevation, std::uint32_t id = 1) {
  Target target;
  target.id = id;
  target.trajectory = AngularLine{{azimuth, elevation}, {0.0, 0.0}};
  return target;
}

/// The paper's target before two sensors.
Scenario paper() {
  Scenario scenario;
  scenario.seed = 42;
  scenario.targets.resize(1);
  scenario.sensors = {sensorCalled("acquisition_1"), sensorCalled("tracking_1")};
  return scenario;
}

/// One sensor, called "eye", before a target at (azimuth, elevation) in its frame.
Scenario eyeOn(double azimuth, double elevation) {
  Scenario scenario;
  scenario.targets = {standingAt(azimuth, elevation)};
  scenario.sensors = {sensorCalled("eye")};
  return scenario;
}

std::vector<SimulatedScan> scansOf(const Scenario& scenario, const std::string& sensor, int count) {
  SensorSimulator simulator(scenario, sensor, kStart);
  std::vector<SimulatedScan> scans;
  while (static_cast<int>(scans.size()) < count) {
    auto scan = simulator.next();
    if (!scan) break;
    scans.push_back(std::move(*scan));
  }
  return scans;
}

std::vector<SimulatedScan> scansOfEye(const Scenario& scenario, int count) {
  return scansOf(scenario, "eye", count);
}

/// Errors of the sightings of a target that stands at `truth` in the sensor's frame.
std::vector<Eigen::Vector2d> errorsAgainst(const std::vector<SimulatedScan>& scans,
                                           const Eigen::Vector2d& truth) {
  std::vector<Eigen::Vector2d> errors;
  for (const SimulatedScan& scan : scans) {
    for (const Sighting& sighting : scan.scan.sightings) {
      errors.push_back(angleDifference(anglesOf(sighting.direction), truth));
    }
  }
  return errors;
}

Eigen::Vector2d meanOf(const std::vector<Eigen::Vector2d>& errors) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const auto& error : errors) sum += error;
  return sum / static_cast<double>(errors.size());
}

Eigen::Vector2d varianceOf(const std::vector<Eigen::Vector2d>& errors, const Eigen::Vector2d& mean) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const auto& error : errors) sum += (error - mean).cwiseAbs2();
  return sum / static_cast<double>(errors.size());
}

void expectSameScans(const std::vector<SimulatedScan>& a, const std::vector<SimulatedScan>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_EQ(a[i].scan.time, b[i].scan.time);
    ASSERT_EQ(a[i].publish_time, b[i].publish_time);
    ASSERT_EQ(a[i].origins, b[i].origins);
    for (std::size_t j = 0; j < a[i].scan.sightings.size(); ++j) {
      ASSERT_EQ(a[i].scan.sightings[j].direction, b[i].scan.sightings[j].direction);
    }
  }
}

// ---- reproducible ----

TEST(SensorSimulator, SameSeedGivesTheSameScans) {
  expectSameScans(scansOf(paper(), "tracking_1", 200), scansOf(paper(), "tracking_1", 200));
}

TEST(SensorSimulator, AnotherSeedOrSensorGivesOtherScans) {
  Scenario other = paper();
  other.seed = 43;
  const auto base = scansOf(paper(), "tracking_1", 50);
  for (const auto& scans : {scansOf(other, "tracking_1", 50), scansOf(paper(), "acquisition_1", 50)}) {
    EXPECT_NE(base[5].scan.sightings[0].direction, scans[5].scan.sightings[0].direction);
    EXPECT_FALSE(std::equal(base.begin(), base.end(), scans.begin(),
                            [](const auto& a, const auto& b) { return a.scan.time == b.scan.time; }));
  }
}

TEST(SensorSimulator, WhatRunsBesideChangesNothing) {
  Scenario crowded = paper();
  crowded.sensors.insert(crowded.sensors.begin(), sensorCalled("another"));
  expectSameScans(scansOf(paper(), "tracking_1", 200), scansOf(crowded, "tracking_1", 200));
}

TEST(SensorSimulator, OneCauseOfRandomnessDoesNotMoveTheOthers) {
  const auto base = scansOf(paper(), "tracking_1", 300);
  Scenario changed = paper();
  changed.sensors[1].clutter_density = 2.0;
  changed.sensors[1].detection_probability = 0.7;
  changed.sensors[1].latency_jitter = 0.003;
  changed.targets.push_back(standingAt(0.3, 0.2, 2));
  int compared = 0;
  const auto scans = scansOf(changed, "tracking_1", 300);
  for (std::size_t i = 0; i < scans.size(); ++i) {
    ASSERT_EQ(scans[i].scan.time, base[i].scan.time);
    for (std::size_t j = 0; j < scans[i].origins.size(); ++j) {
      if (scans[i].origins[j] != 1) continue;
      ASSERT_EQ(scans[i].scan.sightings[j].direction, base[i].scan.sightings[0].direction);
      ++compared;
    }
  }
  EXPECT_GT(compared, 150);
}

TEST(SensorSimulator, SensorsOfOneSequenceLookAtTheSameTimesWithTheirOwnNoise) {
  Scenario scenario = paper();
  for (SimulatedSensor& sensor : scenario.sensors) sensor.sequence = "platform";
  const auto a = scansOf(scenario, "acquisition_1", 300), b = scansOf(scenario, "tracking_1", 300);
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_EQ(a[i].scan.time, b[i].scan.time);
    ASSERT_NE(a[i].scan.sightings[0].direction, b[i].scan.sightings[0].direction);
  }
}

// ---- what a scan says of itself ----

TEST(SensorSimulator, ScanCarriesTheSensorsStatements) {
  Scenario scenario = eyeOn(0.1, 0.2);
  SimulatedSensor& eye = scenario.sensors[0];
  eye.ifov = 0.003;
  eye.sigma = {0.01, 0.02};
  eye.clutter_density = 0.5;
  eye.detection_probability = 0.9;
  for (const SimulatedScan& simulated : scansOfEye(scenario, 50)) {
    EXPECT_EQ(simulated.scan.sensor, "eye");
    EXPECT_EQ(simulated.scan.ifov, 0.003);
    EXPECT_EQ(simulated.scan.detection_probability, 0.9);
    EXPECT_EQ(simulated.scan.clutter_density, 0.5);
    ASSERT_TRUE(simulated.scan.view);
    EXPECT_EQ(simulated.scan.view->half_widths, eye.field_of_view);
    EXPECT_EQ(simulated.origins.size(), simulated.scan.sightings.size());
    for (const Sighting& sighting : simulated.scan.sightings) {
      const Eigen::Matrix2d covariance = anglesCovariance(sighting);
      EXPECT_NEAR(covariance(0, 0), 1e-4, 1e-12);
      EXPECT_NEAR(covariance(1, 1), 4e-4, 1e-12);
      EXPECT_NEAR(covariance(0, 1), 0.0, 1e-12);
      EXPECT_FALSE(rejectionOf(anglesOf(sighting.direction), covariance));
    }
  }
}

TEST(SensorSimulator, ExposuresStartAtTimeZeroAndAscend) {
  const auto scans = scansOf(paper(), "tracking_1", 500);
  EXPECT_EQ(scans[0].scan.time, kStart);
  for (std::size_t i = 1; i < scans.size(); ++i) EXPECT_GT(scans[i].scan.time, scans[i - 1].scan.time);
}

TEST(SensorSimulator, EndsWithTheScenario) {
  Scenario scenario = paper();
  scenario.duration = 2.0;
  const auto scans = scansOf(scenario, "tracking_1", 100000);
  EXPECT_GT(scans.size(), 50U);
  EXPECT_LT(scans.back().scan.time, kStart + std::chrono::seconds(2));
}

TEST(SensorSimulator, SightingsAreInAscendingAzimuth) {
  Scenario scenario = paper();
  scenario.sensors[1].clutter_density = 3.0;
  bool target_first = true, target_last = true;
  for (const SimulatedScan& simulated : scansOf(scenario, "tracking_1", 200)) {
    const auto& sightings = simulated.scan.sightings;
    for (std::size_t i = 1; i < sightings.size(); ++i) {
      ASSERT_LE(anglesOf(sightings[i - 1].direction).x(), anglesOf(sightings[i].direction).x());
    }
    target_first = target_first && simulated.origins.front() == 1;
    target_last = target_last && simulated.origins.back() == 1;
  }
  EXPECT_FALSE(target_first);
  EXPECT_FALSE(target_last);
}

// ---- statistics ----

TEST(SensorSimulator, NoiseIsUnbiasedWithTheStatedSigmaInBothChannels) {
  Scenario scenario = eyeOn(0.4, -0.3);
  scenario.sensors[0].sigma = {0.15, 0.08};
  const auto errors = errorsAgainst(scansOfEye(scenario, 20000), {0.4, -0.3});
  const double n = static_cast<double>(errors.size());
  const Eigen::Vector2d mean = meanOf(errors), variance = varianceOf(errors, mean);
  for (int i = 0; i < 2; ++i) {
    const double sigma = scenario.sensors[0].sigma(i);
    EXPECT_NEAR(mean(i), 0.0, 5.0 * sigma / std::sqrt(n));
    EXPECT_NEAR(variance(i) / (sigma * sigma), 1.0, 5.0 * std::sqrt(2.0 / n));
  }
}

TEST(SensorSimulator, NoiseOfMicroradiansIsExact) {
  Scenario scenario = eyeOn(2e-4, 1e-4);
  scenario.sensors[0].sigma = {1e-5, 1e-5};
  scenario.sensors[0].field_of_view = {1e-3, 1e-3};
  const auto errors = errorsAgainst(scansOfEye(scenario, 20000), {2e-4, 1e-4});
  const double n = static_cast<double>(errors.size());
  EXPECT_NEAR(varianceOf(errors, meanOf(errors)).x() / 1e-10, 1.0, 5.0 * std::sqrt(2.0 / n));
}

TEST(SensorSimulator, RelativeNoiseGrowsWithTheAngleOverItsFloor) {
  Scenario scenario = eyeOn(-0.9, 0.0);  // the paper's eta r would have the wrong sign left of the boresight
  scenario.sensors[0].sigma = {0.01, 0.01};
  scenario.sensors[0].relative_sigma = 0.04;
  const auto scans = scansOfEye(scenario, 20000);
  const auto errors = errorsAgainst(scans, {-0.9, 0.0});
  const double n = static_cast<double>(errors.size());
  const Eigen::Vector2d variance = varianceOf(errors, meanOf(errors));
  EXPECT_NEAR(variance.x() / (0.036 * 0.036 + 1e-4), 1.0, 5.0 * std::sqrt(2.0 / n));
  EXPECT_NEAR(variance.y() / 1e-4, 1.0, 5.0 * std::sqrt(2.0 / n));
  for (const SimulatedScan& simulated : scans) {  // stated at the measured angle
    const Sighting& sighting = simulated.scan.sightings[0];
    const double azimuth = anglesOf(sighting.direction).x();
    ASSERT_NEAR(anglesCovariance(sighting)(0, 0), 1e-4 + 0.0016 * azimuth * azimuth, 1e-12);
  }
}

TEST(SensorSimulator, BiasShiftsAndIsNotStated) {
  Scenario scenario = eyeOn(0.2, 0.1);
  scenario.sensors[0].sigma = {0.01, 0.01};
  scenario.sensors[0].bias = {0.03, -0.02};
  const auto scans = scansOfEye(scenario, 5000);
  const Eigen::Vector2d mean = meanOf(errorsAgainst(scans, {0.2, 0.1}));
  EXPECT_LT((mean - scenario.sensors[0].bias).cwiseAbs().maxCoeff(), 5.0 * 0.01 / std::sqrt(5000.0));
  EXPECT_NEAR(anglesCovariance(scans[0].scan.sightings[0])(0, 0), 1e-4, 1e-12);
}

TEST(SensorSimulator, DetectionProbabilityIsTheShareOfScansWithTheTarget) {
  Scenario scenario = eyeOn(0.2, 0.1);
  scenario.sensors[0].detection_probability = 0.85;
  const int n = 20000;
  int seen = 0;
  for (const SimulatedScan& simulated : scansOfEye(scenario, n))
    seen += static_cast<int>(simulated.origins.size());
  EXPECT_NEAR(seen, 0.85 * n, 5.0 * std::sqrt(0.85 * 0.15 * n));
}

TEST(SensorSimulator, ClutterIsPoissonAndUniformInSolidAngle) {
  Scenario scenario = eyeOn(0.0, 0.0);
  scenario.targets.clear();
  SimulatedSensor& eye = scenario.sensors[0];
  eye.field_of_view = {0.8, 1.3};
  eye.clutter_density = 2.0;
  const double mean = 2.0 * 4.0 * 0.8 * std::sin(1.3);
  const int n = 10000;
  double sum = 0.0, squares = 0.0, above_half_height = 0.0, left = 0.0;
  for (const SimulatedScan& simulated : scansOfEye(scenario, n)) {
    const double count = static_cast<double>(simulated.origins.size());
    sum += count;
    squares += (count - mean) * (count - mean);
    for (const Sighting& sighting : simulated.scan.sightings) {
      ASSERT_TRUE(inView(eye, sighting.direction));
      above_half_height += sighting.direction.z() > 0.5 * std::sin(1.3);
      left += sighting.direction.y() > 0.0;
    }
  }
  EXPECT_NEAR(sum / n, mean, 5.0 * std::sqrt(mean / n));
  EXPECT_NEAR(squares / n, mean, 5.0 * std::sqrt((mean + 2.0 * mean * mean) / n));
  EXPECT_NEAR(above_half_height / sum, 0.25, 5.0 * std::sqrt(0.25 * 0.75 / sum));
  EXPECT_NEAR(left / sum, 0.5, 5.0 * std::sqrt(0.25 / sum));
}

TEST(SensorSimulator, RateIsThatOfThePaper) {
  const int n = 20000;
  const auto scans = scansOf(paper(), "tracking_1", n + 1);
  const double mean_interval = seconds(scans.back().scan.time - scans.front().scan.time) / n;
  EXPECT_NEAR(mean_interval, 0.030, 5.0 * 0.010 * std::sqrt(2.0 / n));
}

// ---- field of view, wrap, poles ----

TEST(SensorSimulator, SeesWithinTheRimsOfTheFieldOfViewAndNotBeyond) {
  struct Place {
    double azimuth, elevation;
    bool seen;
  };
  for (const Place place : {Place{0.499, 0.0, true}, Place{0.501, 0.0, false}, Place{-0.499, 0.299, true},
                            Place{-0.501, 0.0, false}, Place{0.0, 0.301, false}, Place{0.0, -0.301, false},
                            Place{0.5, 0.3, true}, Place{3.0, 0.0, false}}) {
    Scenario scenario = eyeOn(place.azimuth, place.elevation);
    scenario.sensors[0].field_of_view = {0.5, 0.3};
    EXPECT_EQ(!scansOfEye(scenario, 1)[0].origins.empty(), place.seen)
        << place.azimuth << ", " << place.elevation;
  }
}

TEST(SensorSimulator, NothingInViewGivesEmptyScans) {
  Scenario scenario = eyeOn(3.0, 0.0);
  const auto scans = scansOfEye(scenario, 100);
  ASSERT_EQ(scans.size(), 100U);
  for (const SimulatedScan& simulated : scans) EXPECT_TRUE(simulated.scan.sightings.empty());
}

TEST(SensorSimulator, NarrowSensorLooksWhereItIsMounted) {
  Scenario scenario = eyeOn(2.0, 0.7);
  scenario.sensors[0].field_of_view = {0.01, 0.01};
  scenario.sensors[0].sigma = {1e-6, 1e-6};
  EXPECT_TRUE(scansOfEye(scenario, 1)[0].origins.empty());
  scenario.sensors[0].mount_attitude = {0.0, -0.7, 2.0};
  const auto scans = scansOfEye(scenario, 1);
  ASSERT_EQ(scans[0].origins.size(), 1U);
  EXPECT_LT(anglesOf(scans[0].scan.sightings[0].direction).norm(), 1e-5);
}

TEST(SensorSimulator, TargetBehindIsSeenAcrossTheWrap) {
  Scenario scenario = eyeOn(kPi, 0.0);
  scenario.sensors[0].field_of_view = {kPi, 1.0};
  scenario.sensors[0].sigma = {0.05, 0.05};
  const auto scans = scansOfEye(scenario, 5000);
  const auto errors = errorsAgainst(scans, {kPi, 0.0});
  ASSERT_EQ(errors.size(), 5000U);
  EXPECT_NEAR(varianceOf(errors, meanOf(errors)).x() / 0.0025, 1.0, 5.0 * std::sqrt(2.0 / 5000.0));
  const auto positive = std::count_if(scans.begin(), scans.end(), [](const SimulatedScan& simulated) {
    return anglesOf(simulated.scan.sightings[0].direction).x() > 0.0;
  });
  EXPECT_NEAR(static_cast<double>(positive), 2500.0, 5.0 * std::sqrt(1250.0));
}

TEST(SensorSimulator, UpwardSensorHasRoundNoiseAtTheZenith) {
  Scenario scenario = eyeOn(0.0, kPi / 2.0);
  scenario.sensors[0].mount_attitude = {0.0, -kPi / 2.0, 0.0};
  scenario.sensors[0].sigma = {0.01, 0.01};
  double across = 0.0, along = 0.0;
  const int n = 5000;
  for (const SimulatedScan& simulated : scansOfEye(scenario, n)) {
    const Sighting world = rotate(simulated.scan.sightings[0], R_platform_sensor(scenario.sensors[0]));
    across += world.direction.x() * world.direction.x() / n;
    along += world.direction.y() * world.direction.y() / n;
  }
  EXPECT_NEAR(across / 1e-4, 1.0, 5.0 * std::sqrt(2.0 / n));
  EXPECT_NEAR(along / 1e-4, 1.0, 5.0 * std::sqrt(2.0 / n));
}

TEST(SensorSimulator, NoiseOverThePoleGivesSightingsInRangeThatTrackersAccept) {
  Scenario scenario = eyeOn(0.3, 1.5);
  scenario.sensors[0].field_of_view = {kPi, kPi / 2.0};
  scenario.sensors[0].sigma = {0.1, 0.1};
  int over = 0;
  for (const SimulatedScan& simulated : scansOfEye(scenario, 2000)) {
    const Sighting& sighting = simulated.scan.sightings[0];
    const Eigen::Vector2d angles = anglesOf(sighting.direction);
    ASSERT_LE(std::abs(angles.y()), kPi / 2.0);
    ASSERT_FALSE(rejectionOf(angles, anglesCovariance(sighting)));
    over += std::abs(angleDifference(angles, {0.3, 0.0}).x()) > kPi / 2.0;
  }
  EXPECT_GT(over, 300);  // a quarter is beyond 0.7 sigma
}

// ---- time and trouble ----

TEST(SensorSimulator, LatencyLiesBetweenItsBoundsAndFillsThem) {
  Scenario scenario = eyeOn(0.0, 0.0);
  scenario.sensors[0].latency = 0.004;
  scenario.sensors[0].latency_jitter = 0.006;  // below the shortest interval: nothing waits
  double shortest = 1.0, longest = 0.0, sum = 0.0;
  const int n = 5000;
  for (const SimulatedScan& simulated : scansOfEye(scenario, n)) {
    const double latency = seconds(simulated.publish_time - simulated.scan.time);
    shortest = std::min(shortest, latency);
    longest = std::max(longest, latency);
    sum += latency;
  }
  EXPECT_GE(shortest, 0.004);
  EXPECT_LT(longest, 0.010 + 1e-9);
  EXPECT_LT(shortest, 0.0041);
  EXPECT_GT(longest, 0.0099);
  EXPECT_NEAR(sum / n, 0.007, 5.0 * 0.006 / std::sqrt(12.0 * n));
}

TEST(SensorSimulator, ScansDoNotOvertakeEachOther) {
  Scenario scenario = eyeOn(0.0, 0.0);
  scenario.sensors[0].latency_jitter = 0.2;  // many intervals
  Time last{};
  int waited = 0;
  for (const SimulatedScan& simulated : scansOfEye(scenario, 2000)) {
    ASSERT_GE(simulated.publish_time, last);
    ASSERT_GE(simulated.publish_time, simulated.scan.time);
    ASSERT_LT(seconds(simulated.publish_time - simulated.scan.time), 0.2 + 1e-9);
    waited += simulated.publish_time == last;
    last = simulated.publish_time;
  }
  EXPECT_GT(waited, 100);
}

TEST(SensorSimulator, ScansOfDifferentSensorsMayArriveOutOfOrder) {
  Scenario scenario = paper();
  scenario.sensors[0].latency = 0.08;
  const auto late = scansOf(scenario, "acquisition_1", 100), prompt = scansOf(scenario, "tracking_1", 100);
  const bool overtaken = std::any_of(late.begin(), late.end(), [&](const SimulatedScan& slow) {
    return std::any_of(prompt.begin(), prompt.end(), [&](const SimulatedScan& quick) {
      return quick.scan.time > slow.scan.time && quick.publish_time < slow.publish_time;
    });
  });
  EXPECT_TRUE(overtaken);
}

TEST(SensorSimulator, OutageIsSilenceAndChangesNothingElse) {
  Scenario scenario = paper();
  scenario.sensors[1].outages = {{1.0, 2.0}, {3.0, 3.5}};
  auto expected = scansOf(paper(), "tracking_1", 200);
  expected.erase(std::remove_if(expected.begin(), expected.end(),
                                [](const SimulatedScan& simulated) {
                                  const double time = seconds(simulated.scan.time - kStart);
                                  return (time >= 1.0 && time < 2.0) || (time >= 3.0 && time < 3.5);
                                }),
                 expected.end());
  ASSERT_LT(expected.size(), 180U);
  expectSameScans(scansOf(scenario, "tracking_1", static_cast<int>(expected.size())), expected);
}

TEST(SensorSimulator, OutageWithoutEndEndsTheScans) {
  Scenario scenario = paper();
  scenario.sensors[1].outages = {{1.0, std::numeric_limits<double>::infinity()}};
  const auto scans = scansOf(scenario, "tracking_1", 1000);
  EXPECT_LT(scans.size(), 100U);
  EXPECT_LT(scans.back().scan.time, kStart + std::chrono::seconds(1));
}

TEST(SensorSimulator, DegradationChangesTheNoiseButNotTheStatement) {
  Scenario scenario = eyeOn(0.1, 0.1);
  SimulatedSensor& eye = scenario.sensors[0];
  eye.sigma = {0.01, 0.01};
  eye.degradations = {{{60.0, 120.0}, 3.0, {0.0, 0.0}}, {{180.0, 240.0}, 1.0, {0.05, -0.05}}};
  std::vector<Eigen::Vector2d> healthy, noisy, shifted;
  for (const SimulatedScan& simulated : scansOfEye(scenario, 8000)) {
    const double time = seconds(simulated.scan.time - kStart);
    const Sighting& sighting = simulated.scan.sightings[0];
    const Eigen::Vector2d error = anglesOf(sighting.direction) - Eigen::Vector2d(0.1, 0.1);
    ASSERT_NEAR(anglesCovariance(sighting)(1, 1), 1e-4, 1e-12);
    if (time >= 60.0 && time < 120.0)
      noisy.push_back(error);
    else if (time >= 180.0 && time < 240.0)
      shifted.push_back(error);
    else
      healthy.push_back(error);
  }
  ASSERT_GT(noisy.size(), 1800U);
  ASSERT_GT(shifted.size(), 1700U);
  const auto band = [](const std::vector<Eigen::Vector2d>& errors) {
    return 5.0 * std::sqrt(2.0 / static_cast<double>(errors.size()));
  };
  EXPECT_NEAR(varianceOf(healthy, meanOf(healthy)).x() / 1e-4, 1.0, band(healthy));
  EXPECT_NEAR(varianceOf(noisy, meanOf(noisy)).x() / 9e-4, 1.0, band(noisy));
  EXPECT_NEAR(varianceOf(shifted, meanOf(shifted)).y() / 1e-4, 1.0, band(shifted));
  EXPECT_LT((meanOf(shifted) - Eigen::Vector2d(0.05, -0.05)).norm(), 5.0 * 0.01 * std::sqrt(2.0 / 1700.0));
}

TEST(SensorSimulator, TargetThatLeavesAndAnotherThatComesAreToldApart) {
  Scenario scenario = eyeOn(0.1, 0.1);
  scenario.targets[0].end = 1.0;
  scenario.targets.push_back(standingAt(-0.2, 0.0, 7));
  scenario.targets[1].start = 2.0;
  for (const SimulatedScan& simulated : scansOfEye(scenario, 100)) {
    const double time = seconds(simulated.scan.time - kStart);
    const std::vector<std::uint32_t> expected = time < 1.0    ? std::vector<std::uint32_t>{1}
                                                : time >= 2.0 ? std::vector<std::uint32_t>{7}
                                                              : std::vector<std::uint32_t>{};
    ASSERT_EQ(simulated.origins, expected) << time;
  }
}

TEST(SensorSimulator, InvisibleTargetIsNotSeenAndNothingElseChanges) {
  Scenario scenario = eyeOn(0.1, 0.1);
  scenario.sensors[0].sigma = {1e-3, 1e-3};
  scenario.targets.push_back(standingAt(-0.2, 0.0, 7));
  const auto all = scansOfEye(scenario, 200);
  scenario.targets[1].invisible = {{1.0, 2.0}, {3.0, 3.5}};
  const auto fewer = scansOfEye(scenario, 200);
  ASSERT_EQ(fewer.size(), all.size());
  int hidden = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const double time = seconds(fewer[i].scan.time - kStart);
    const bool is_hidden = (time >= 1.0 && time < 2.0) || (time >= 3.0 && time < 3.5);
    hidden += is_hidden;
    const std::vector<std::uint32_t> both{7, 1}, other{1};
    ASSERT_EQ(all[i].origins, both);
    ASSERT_EQ(fewer[i].origins, is_hidden ? other : both);
    EXPECT_EQ(fewer[i].scan.sightings.front().direction, all[i].scan.sightings[is_hidden].direction);
    EXPECT_TRUE(truthAt(scenario, scenario.targets[1], time)) << "it is there all the same";
  }
  EXPECT_GT(hidden, 20);
}

// ---- refusals ----

TEST(SensorSimulator, UnknownSensorIsRefusedWithTheKnownOnes) {
  try {
    SensorSimulator(paper(), "tracking_9", kStart);
    FAIL() << "no refusal";
  } catch (const std::invalid_argument& refusal) {
    EXPECT_STREQ(refusal.what(),
                 "the scenario has no sensor \"tracking_9\", it has: acquisition_1, tracking_1");
  }
}

TEST(SensorSimulator, FaultyScenarioIsRefused) {
  Scenario scenario = paper();
  scenario.sensors[1].detection_probability = 0.0;
  EXPECT_THROW(SensorSimulator(scenario, "tracking_1", kStart), std::invalid_argument);
}

/// A camera called "eye" on a station, with a target 1 km along its boresight.
Scenario stationBefore(const Station& station) {
  Scenario scenario;
  scenario.stations = {station};
  scenario.sensors = {sensorCalled("eye")};
  scenario.sensors[0].station = station.name;
  scenario.sensors[0].sigma = {1e-6, 1e-6};
  Target target;
  target.trajectory = StraightFlight{{1000.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};
  scenario.targets = {target};
  return scenario;
}

TEST(SensorSimulator, StampsOfAStationAreItsClocksAndItsScansAreNoEarlier) {
  Station station{"shore", FixedPlatform{}};
  const auto right = scansOfEye(stationBefore(station), 50);
  station.clock_behind = 0.05;
  station.clock_drift = 0.001;
  const auto behind = scansOfEye(stationBefore(station), 50);
  ASSERT_EQ(right.size(), behind.size());
  for (std::size_t i = 0; i < right.size(); ++i) {
    const double late = seconds(right[i].scan.time - behind[i].scan.time);
    EXPECT_NEAR(late, 0.05 + 0.001 * seconds(right[i].scan.time - kStart), 1e-9);
    EXPECT_EQ(right[i].publish_time, behind[i].publish_time);
  }
}

TEST(SensorSimulator, MisorientationTurnsWhatAStationSeesAboutTheAxesOfTheWorld) {
  Station station{"shore", FixedPlatform{{0.0, 0.0, 0.0}, {0.0, 0.0, 0.4}}};
  station.misorientation = {0.0, 0.0, 0.01};
  Scenario scenario = stationBefore(station);
  const auto scans = scansOfEye(scenario, 20);
  EXPECT_LT(meanOf(errorsAgainst(scans, {-0.4 + 0.01, 0.0})).norm(), 1e-6);
  // One about the line of sight turns nothing, one about the horizontal across it moves the target down.
  station.misorientation = {0.02, 0.0, 0.0};
  EXPECT_LT(meanOf(errorsAgainst(scansOfEye(stationBefore(station), 20), {-0.4, 0.0})).norm(), 1e-6);
  station.misorientation = {0.0, 0.02, 0.0};
  EXPECT_NEAR(meanOf(errorsAgainst(scansOfEye(stationBefore(station), 20), {-0.4, 0.0})).y(), -0.02, 1e-6);
}

TEST(SensorSimulator, WhatAnObstacleHidesGivesNoSighting) {
  Scenario scenario = stationBefore({"shore", FixedPlatform{}});
  scenario.obstacles = {{{500.0, -1.0, -1.0}, {501.0, 1.0, 1.0}}};
  for (const SimulatedScan& scan : scansOfEye(scenario, 20)) EXPECT_TRUE(scan.scan.sightings.empty());
}

TEST(SensorSimulator, StationThatMovesSeesFromWhereItIs) {
  Scenario scenario = stationBefore({"ship", StraightPlatform{{0.0, -100.0, 0.0}, {0.0, 100.0, 0.0}}});
  scenario.sensors[0].mount_attitude = {0.0, 0.0, -kPi / 2.0};  // to starboard
  for (const SimulatedScan& scan : scansOfEye(scenario, 40)) {
    const double y = -100.0 + 100.0 * seconds(scan.scan.time - kStart);
    ASSERT_EQ(scan.scan.sightings.size(), 1U);
    EXPECT_NEAR(anglesOf(scan.scan.sightings[0].direction).x(), std::atan2(-y, 1000.0), 1e-5);
  }
}

}  // namespace
}  // namespace sightline::core
