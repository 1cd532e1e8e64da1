#include "sightline/core/tracking/track_sensors.h"

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "support/times.h"

namespace sightline::core {
namespace {

using test::at;

using Eigen::Matrix2d;
using Eigen::Vector2d;

RevisitTime every(double interval) {
  RevisitTime revisit;
  revisit.note(interval);
  return revisit;
}

void sight(TrackSensors& sensors, const std::string& sensor, double t, const Vector2d& innovation,
           double variance = 1e-6, const Vector2d& slow_error = Vector2d::Zero()) {
  sensors.noteSighting(sensor, at(t), innovation, variance * Matrix2d::Identity(), slow_error);
  sensors.noteInterval(sensor, every(0.1));
}

TEST(TrackSensors, NamesThoseThatHaveSeenTheTargetLatelyInOrder) {
  TrackSensors sensors;
  sight(sensors, "c", 3.0, {0.0, 0.0});
  sight(sensors, "a", 4.0, {0.0, 0.0});
  sight(sensors, "b", 1.0, {0.0, 0.0});
  EXPECT_EQ(sensors.names(at(4.0), 2.0, 0.0), (std::vector<std::string>{"a", "c"}));
  EXPECT_TRUE(sensors.hasSeen("b", at(3.0), 2.0, 0.0));
  EXPECT_FALSE(sensors.hasSeen("b", at(3.1), 2.0, 0.0));
  EXPECT_FALSE(sensors.hasSeen("d", at(3.0), 2.0, 0.0));
}

TEST(TrackSensors, WhatIsLatelyGoesByThePaceOfEachSensor) {
  TrackSensors sensors;
  sight(sensors, "camera", 0.0, {0.0, 0.0});
  sight(sensors, "telescope", 0.0, {0.0, 0.0});
  sensors.noteInterval("telescope", every(60.0));
  EXPECT_DOUBLE_EQ(sensors.unit(at(1.0), 2.0, 0.0), 180.0);
  EXPECT_EQ(sensors.names(at(3.0), 2.0, 0.0), std::vector<std::string>{"telescope"});
  EXPECT_EQ(sensors.names(at(3.0), 2.0, 4.0), (std::vector<std::string>{"camera", "telescope"}));
  EXPECT_TRUE(sensors.hasSeen("telescope", at(359.0), 2.0, 0.0));
  EXPECT_FALSE(sensors.hasSeen("telescope", at(361.0), 2.0, 0.0));
  EXPECT_EQ(sensors.unit(at(361.0), 2.0, 0.0), 0.0);
}

TEST(TrackSensors, ASensorThatHasLookedOnceDoesNotHoldUpTheOthers) {
  TrackSensors sensors;
  sight(sensors, "camera", 0.0, {0.0, 0.0});
  sight(sensors, "eye", 0.0, {0.0, 0.0});
  sensors.noteInterval("eye", {});
  EXPECT_DOUBLE_EQ(sensors.unit(at(1.0), 2.0, 0.0), 1.0);
  EXPECT_EQ(sensors.unit(at(9.0), 2.0, 0.0), 0.0);
}

TEST(TrackSensors, ASensorThatHasLookedOnceIsNeverSilent) {
  TrackSensors sensors;
  sight(sensors, "eye", 0.0, {0.0, 0.0});
  sensors.noteInterval("eye", {});
  EXPECT_TRUE(std::isinf(sensors.unit(at(1e6), 2.0, 0.0)));
  EXPECT_TRUE(sensors.hasSeen("eye", at(1e6), 2.0, 0.0));
}

TEST(TrackSensors, ASensorThatKeepsMissingTheTargetProbablyCannotSeeIt) {
  TrackSensors sensors;
  EXPECT_DOUBLE_EQ(sensors.visibility("blind"), 0.5);
  double before = 0.5;
  for (int k = 0; k < 3; ++k) {
    sensors.noteMiss("blind", sensors.visibility("blind"), 0.5);
    EXPECT_LT(sensors.visibility("blind"), before);
    before = sensors.visibility("blind");
  }
  for (int k = 0; k < 100; ++k) sensors.noteMiss("blind", sensors.visibility("blind"), 0.9);
  EXPECT_DOUBLE_EQ(sensors.visibility("blind"), 0.01) << "it may have been hidden after all";
  EXPECT_DOUBLE_EQ(sensors.visibility("other"), 0.5);
  sensors.noteVisible("blind");
  EXPECT_DOUBLE_EQ(sensors.visibility("blind"), 0.5);
}

TEST(TrackSensors, TheProbabilityToSeeItFollowsBayes) {
  TrackSensors sensors;
  sensors.noteMiss("eye", 0.5, 0.9);
  EXPECT_NEAR(sensors.visibility("eye"), 0.05 / 0.55, 1e-15);
}

TEST(TrackSensors, CorroborationCountsTheOtherSensorsAndSharesTheirMedianInnovation) {
  const SensorGuard guard{GuardParams{}};
  TrackSensors sensors;
  sight(sensors, "a", 1.0, {1e-3, 1e-3});
  sight(sensors, "b", 1.0, {2e-3, -1e-3});
  sight(sensors, "c", 1.0, {9e-3, 2e-3});
  const Corroboration of_a = sensors.corroborationOf("a", at(1.0), guard, true);
  EXPECT_TRUE(of_a.has_sensor);
  EXPECT_EQ(of_a.others, 2);
  EXPECT_DOUBLE_EQ(of_a.shared.x(), 5.5e-3);
  EXPECT_DOUBLE_EQ(of_a.shared.y(), 0.0) << "of different signs";
  const Corroboration of_new = sensors.corroborationOf("d", at(1.0), guard, true);
  EXPECT_FALSE(of_new.has_sensor);
  EXPECT_EQ(of_new.others, 3);
  EXPECT_DOUBLE_EQ(of_new.shared.x(), 2e-3);
}

TEST(TrackSensors, NobodyCorroboratesForATrackThatIsNotMatureOrAfterLongSilence) {
  const SensorGuard guard{GuardParams{}};  // support 2.5 s
  TrackSensors sensors;
  sight(sensors, "a", 1.0, {1e-3, 1e-3});
  sight(sensors, "b", 1.0, {1e-3, 1e-3});
  EXPECT_EQ(sensors.corroborationOf("a", at(1.0), guard, false).others, 0);
  EXPECT_TRUE(sensors.corroborationOf("a", at(1.0), guard, false).has_sensor);
  EXPECT_EQ(sensors.corroborationOf("a", at(4.0), guard, true).others, 0);
  EXPECT_FALSE(sensors.corroborationOf("a", at(4.0), guard, true).has_sensor);
}

TEST(TrackSensors, TheSlowErrorOfThePositionIsEachSensorsByItsShareSquared) {
  TrackSensors sensors;
  EXPECT_EQ(sensors.slowErrorVariance(at(0.0)), Vector2d(0.0, 0.0));
  sight(sensors, "good", 1.0, {0.0, 0.0}, 1e-6, {0.0, 0.0});
  sight(sensors, "slow", 1.0, {0.0, 0.0}, 1e-6, {4e-6, 8e-6});
  EXPECT_NEAR(sensors.slowErrorVariance(at(1.0)).x(), 1e-6, 1e-18);
  EXPECT_NEAR(sensors.slowErrorVariance(at(1.0)).y(), 2e-6, 1e-18);
  for (int k = 1; k <= 50; ++k) sight(sensors, "good", 1.0 + 0.1 * k, {0.0, 0.0});
  EXPECT_LT(sensors.slowErrorVariance(at(6.0)).x(), 1e-8) << "the share of a silent sensor fades";
}

TEST(TrackSensors, InnovationsTurnWithTheChart) {
  const SensorGuard guard{GuardParams{}};
  TrackSensors sensors;
  sight(sensors, "a", 1.0, {1e-3, 2e-3});
  Matrix2d quarter_turn;
  quarter_turn << 0.0, -1.0, 1.0, 0.0;
  sensors.rotate(quarter_turn);
  const Corroboration corroboration = sensors.corroborationOf("b", at(1.0), guard, true);
  EXPECT_DOUBLE_EQ(corroboration.shared.x(), -2e-3);
  EXPECT_DOUBLE_EQ(corroboration.shared.y(), 1e-3);
}

TEST(TrackSensors, NoMoreThanSixtyFourSensorsAreKept) {
  TrackSensors sensors;
  for (int k = 0; k < 200; ++k) {
    sight(sensors, "sensor " + std::to_string(k), 1.0, {1e-3, 1e-3});
    sensors.noteMiss("blind " + std::to_string(k), 0.5, 0.9);
  }
  EXPECT_EQ(sensors.names(at(1.0), 1.0, 0.0).size(), 64u);
  EXPECT_LT(sensors.visibility("blind 63"), 0.5);
  EXPECT_DOUBLE_EQ(sensors.visibility("blind 64"), 0.5);
}

}  // namespace
}  // namespace sightline::core
