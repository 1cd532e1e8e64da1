#include "sightline/core/sensors/detection_calibration.h"

#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "sightline/core/model/sphere.h"

namespace sightline::core {
namespace {

/// A scan of `clutter` false sightings, evenly over a field of 2 `half` around `centre`.
Scan scanOf(int clutter, const Eigen::Vector2d& centre, const Eigen::Vector2d& half, double time,
            std::mt19937_64& random) {
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  Scan scan;
  scan.sensor = "camera";
  scan.time = Time(durationOf(time));
  for (int j = 0; j < clutter; ++j) {
    const Eigen::Vector2d place(uniform(random), uniform(random));
    scan.sightings.push_back(
        sightingOf(centre + half.cwiseProduct(place), Eigen::Matrix2d::Identity() * 1e-6));
  }
  return scan;
}

TEST(DetectionCalibration, LearnsTheDensityOfFalseSightingsWithoutKnowingTheField) {
  for (const Eigen::Vector2d& centre : {Eigen::Vector2d(0.0, 0.0), Eigen::Vector2d(3.1, 0.3)}) {
    DetectionCalibration detection{DetectionParams{}};
    std::mt19937_64 random(1);
    for (int k = 0; k < 1000; ++k) {
      const Scan scan = scanOf(5, centre, {0.35, 0.25}, 0.03 * k, random);
      detection.take(scan, 0, 0, std::vector<double>(5, 1.0));
    }
    const Scan scan = scanOf(0, centre, {0.35, 0.25}, 31.0, random);
    const double area = 0.7 * 0.5 * std::cos(centre.y());
    EXPECT_NEAR(detection.clutterDensity(scan), 5.0 / area, 0.15 * 5.0 / area);
    EXPECT_NEAR(detection.clutter(scan), 5.0, 0.3);
  }
}

TEST(DetectionCalibration, TakesTheFieldOfViewWhereItIsKnown) {
  DetectionCalibration detection{DetectionParams{}};
  std::mt19937_64 random(1);
  for (int k = 0; k < 1000; ++k) {  // false sightings in a corner of the field only
    Scan scan = scanOf(5, {0.0, 0.0}, {0.1, 0.1}, 0.03 * k, random);
    scan.view = FieldOfView{Eigen::Matrix3d::Identity(), {0.5, 0.5}};
    detection.take(scan, 0, 0, std::vector<double>(5, 1.0));
  }
  Scan scan = scanOf(0, {0.0, 0.0}, {0.1, 0.1}, 31.0, random);
  scan.view = FieldOfView{Eigen::Matrix3d::Identity(), {0.5, 0.5}};
  EXPECT_NEAR(detection.clutterDensity(scan), 5.0 / scan.view->solidAngle(), 0.5);
}

TEST(DetectionCalibration, LearnsHowOftenTargetsAreSeen) {
  DetectionCalibration detection{DetectionParams{}};
  std::mt19937_64 random(2);
  std::bernoulli_distribution is_seen(0.6);
  Scan scan;
  scan.sensor = "camera";
  EXPECT_EQ(detection.probability(scan), 0.9);
  for (int k = 0; k < 2000; ++k) detection.take(scan, 1, is_seen(random), {});
  // 300 looks count: standard error sqrt(0.24 / 600) of an exponential mean, and 20 looks of the prior 0.9.
  EXPECT_NEAR(detection.probability(scan), (300.0 * 0.6 + 20.0 * 0.9) / 320.0, 0.06);
}

TEST(DetectionCalibration, WhereASensorHasLookedInVainTargetsAreNewOnesOnly) {
  DetectionCalibration detection{DetectionParams{}};
  Scan scan;
  scan.sensor = "camera";
  scan.detection_probability = 0.8;
  scan.clutter_density = 2.0;
  scan.view = FieldOfView{Eigen::Matrix3d::Identity(), {0.5, 0.5}};
  detection.take(scan, 0, 0, {});
  EXPECT_NEAR(detection.newTargetOdds(scan), 0.8 * 1.0 / (2.0 * scan.view->solidAngle()), 1e-9);
  for (int k = 1; k < 100; ++k) {
    scan.time += durationOf(0.1);
    detection.take(scan, 0, 0, {});
  }
  // In balance: u = 0.2 u + 0.1 / s * 0.1 s, of which 0.8 are seen.
  EXPECT_NEAR(detection.newTargetOdds(scan), 0.01 / (2.0 * scan.view->solidAngle()), 1e-6);
}

TEST(DetectionCalibration, WhatIsToldComesFirst) {
  DetectionParams params;
  params.probability = 0.7;
  params.clutter_density = 3.0;
  const DetectionCalibration detection(params);
  Scan scan;
  scan.sensor = "camera";
  EXPECT_EQ(detection.probability(scan), 0.7);
  EXPECT_EQ(detection.clutterDensity(scan), 3.0);
  scan.detection_probability = 0.8;
  scan.clutter_density = 7.0;
  EXPECT_EQ(detection.probability(scan), 0.8);
  EXPECT_EQ(detection.clutterDensity(scan), 7.0);
}

TEST(DetectionCalibration, NoSensorIsPerfect) {
  const DetectionCalibration detection{DetectionParams{}};
  Scan scan;
  scan.sensor = "camera";
  scan.detection_probability = 1.0;
  scan.clutter_density = 0.0;
  EXPECT_LT(detection.probability(scan), 1.0);
  EXPECT_GT(detection.clutterDensity(scan), 0.0);
  EXPECT_LT(detection.clutter(scan), 0.01);
}

TEST(DetectionCalibration, ASpotOfFalseSightingsHasAPositiveDensity) {
  DetectionCalibration detection{DetectionParams{}};
  std::mt19937_64 random(1);
  for (int k = 0; k < 3000; ++k) {
    const Scan scan = scanOf(2, {0.1, 0.1}, {0.0, 0.0}, 0.03 * k, random);
    detection.take(scan, 0, 0, {1.0, 1.0});
  }
  const Scan scan = scanOf(0, {0.1, 0.1}, {0.0, 0.0}, 91.0, random);
  EXPECT_TRUE(std::isfinite(detection.clutterDensity(scan)));
  EXPECT_GT(detection.clutterDensity(scan), 0.0);
}

TEST(DetectionCalibration, RemembersABoundedNumberOfSensors) {
  DetectionCalibration detection{DetectionParams{}};
  Scan scan;
  for (int k = 0; k < 10000; ++k) {
    scan.sensor = "sensor " + std::to_string(k);
    detection.take(scan, 0, 0, {});
  }
  EXPECT_LE(detection.sensors().size(), 256u);
}

TEST(DetectionCalibration, RefusesParametersOutOfRange) {
  DetectionParams params;
  params.probability = 1.1;
  EXPECT_THROW(DetectionCalibration{params}, std::invalid_argument);
  params = {};
  params.clutter_density = std::nan("");
  EXPECT_THROW(DetectionCalibration{params}, std::invalid_argument);
  params = {};
  params.memory = 1.0;
  EXPECT_THROW(DetectionCalibration{params}, std::invalid_argument);
}

}  // namespace
}  // namespace sightline::core
