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

}  // namespace
