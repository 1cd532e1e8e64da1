#include "sightline/ros/messages/scenario_messages.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace {

namespace core = sightline::core;

core::Scenario scenario() {
  core::Scenario scenario;
  scenario.platform = core::FixedPlatform{{10.0, 20.0, 5.0}, {0.0, 0.0, 0.5}};
  core::Target always, late;
  always.id = 2;
  always.trajectory = core::AngularLine{{0.5, 0.25}, {0.125, 0.0}};
  late.id = 4;
  late.start = 5.0;
  late.trajectory = core::AngularLine{};
  scenario.targets = {always, late};
  return scenario;
}

TEST(ScenarioMessages, TruthHoldsTheTargetsThatAreThereWithoutUncertainty) {
  const auto truth = sightline_ros::truthMessage(scenario(), 2.0, ros::Time(102.0));
  EXPECT_EQ(truth.header.stamp, ros::Time(102.0));
  EXPECT_EQ(truth.header.frame_id, "platform_enu");
  ASSERT_EQ(truth.tracks.size(), 1u);
  EXPECT_EQ(truth.tracks[0].id, 2u);
  EXPECT_NEAR(truth.tracks[0].azimuth, 0.75, 1e-12);
  EXPECT_NEAR(truth.tracks[0].azimuth_rate, 0.125, 1e-12);
  for (const double entry : truth.tracks[0].covariance) EXPECT_EQ(entry, 0.0);
  EXPECT_EQ(sightline_ros::truthMessage(scenario(), 6.0, ros::Time(106.0)).tracks.size(), 2u);
}

TEST(ScenarioMessages, PlatformEnuHasThePlatformsPlaceAndTheWorldsAxes) {
  const auto transforms = sightline_ros::platformTransforms(scenario(), 0.0, ros::Time(100.0));
  ASSERT_EQ(transforms.size(), 2u);
  EXPECT_EQ(transforms[0].child_frame_id, "platform");
  EXPECT_NEAR(transforms[0].transform.rotation.z, std::sin(0.25), 1e-12);
  EXPECT_EQ(transforms[1].child_frame_id, "platform_enu");
  EXPECT_EQ(transforms[1].transform.rotation.w, 1.0);
  EXPECT_EQ(transforms[1].transform.translation.x, 10.0);
}

TEST(ScenarioMessages, AMountIsTheSensorsPoseOnThePlatform) {
  core::SimulatedSensor sensor;
  sensor.name = "eye";
  sensor.mount_position = {1.0, 0.0, 0.5};
  sensor.mount_attitude = {0.0, 0.0, 1.0};
  const auto mount = sightline_ros::mountTransform(sensor, ros::Time(1.0));
  EXPECT_EQ(mount.header.frame_id, "platform");
  EXPECT_EQ(mount.child_frame_id, "eye");
  EXPECT_EQ(mount.transform.translation.z, 0.5);
  EXPECT_NEAR(mount.transform.rotation.z, std::sin(0.5), 1e-12);
}

TEST(ScenarioMessages, OnlyAFixedPlatformIsFixed) {
  EXPECT_TRUE(sightline_ros::isFixed(core::FixedPlatform{}));
  EXPECT_FALSE(sightline_ros::isFixed(core::StraightPlatform{}));
}

core::Scenario ofTwoStations() {
  core::Scenario two = scenario();
  two.targets[0].trajectory = core::StraightFlight{{1.0, 2.0, 3.0}, {0.0, 4.0, 0.0}};
  two.stations = {{"shore", core::FixedPlatform{{7.0, 0.0, 0.0}, {0.0, 0.0, 1.0}}},
                  {"ship", core::StraightPlatform{}}};
  return two;
}

TEST(ScenarioMessages, TruePositionsAreThoseOfTargetsInMetres) {
  const auto truth = sightline_ros::positionTruthMessage(ofTwoStations(), 6.0, ros::Time(106.0));
  EXPECT_EQ(truth.header.frame_id, "world");
  EXPECT_EQ(truth.tracker, "truth");
  ASSERT_EQ(truth.tracks.size(), 1u);
  EXPECT_EQ(truth.tracks[0].id, 2u);
  EXPECT_EQ(truth.tracks[0].status, sightline::PositionTrack::CONFIRMED);
  EXPECT_EQ(truth.tracks[0].position.y, 26.0);
  EXPECT_EQ(truth.tracks[0].velocity.y, 4.0);
}

TEST(ScenarioMessages, StationsThatStandAndThoseThatMoveHaveTheirTransforms) {
  const auto fixed = sightline_ros::fixedTransforms(ofTwoStations(), ros::Time(100.0));
  ASSERT_EQ(fixed.size(), 4u);
  EXPECT_EQ(fixed[2].child_frame_id, "shore");
  EXPECT_NEAR(fixed[2].transform.rotation.z, std::sin(0.5), 1e-12);
  EXPECT_EQ(fixed[3].child_frame_id, "shore_enu");
  EXPECT_EQ(fixed[3].transform.rotation.w, 1.0);
  EXPECT_EQ(fixed[3].transform.translation.x, 7.0);
  const auto moving = sightline_ros::movingTransforms(ofTwoStations(), 2.0, ros::Time(102.0));
  ASSERT_EQ(moving.size(), 2u);
  EXPECT_EQ(moving[1].child_frame_id, "ship_enu");
  EXPECT_EQ(moving[1].transform.translation.x, 10.0);
}

TEST(ScenarioMessages, SensorOfAStationIsMountedOnIt) {
  core::SimulatedSensor sensor;
  sensor.name = "eye";
  sensor.station = "ship";
  EXPECT_EQ(sightline_ros::mountTransform(sensor, ros::Time(1.0)).header.frame_id, "ship");
}

}  // namespace
