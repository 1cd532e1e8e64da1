#include "sightline/ros/messages/sensor_turn.h"

#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include <tf2/exceptions.h>

namespace {

using sightline_ros::FrameChangeParams;

std_msgs::Header headerAt(double stamp, const std::string& frame = "eye_frame") {
  std_msgs::Header header;
  header.stamp = ros::Time(stamp);
  header.frame_id = frame;
  return header;
}

/// Turns the sensor by `yaw` [rad] about z of the tracking frame.
void setYaw(tf2::BufferCore& transforms, double stamp, double yaw) {
  geometry_msgs::TransformStamped transform;
  transform.header.stamp = ros::Time(stamp);
  transform.header.frame_id = "platform_enu";
  transform.child_frame_id = "eye_frame";
  transform.transform.rotation.z = std::sin(yaw / 2.0);
  transform.transform.rotation.w = std::cos(yaw / 2.0);
  transforms.setTransform(transform, "test", false);
}

TEST(SensorTurn, ScanInTheTrackingFrameIsNotTurned) {
  const tf2::BufferCore none;
  EXPECT_TRUE(isTurnKnown(headerAt(1.0, "platform_enu"), FrameChangeParams{}, none));
  EXPECT_FALSE(turnOf(headerAt(1.0, "platform_enu"), FrameChangeParams{}, none));
}

TEST(SensorTurn, IsInterpolatedBetweenTransformsAndNeverExtrapolated) {
  tf2::BufferCore transforms;
  setYaw(transforms, 10.0, 0.0);
  setYaw(transforms, 11.0, 1.0);
  const FrameChangeParams params;
  const auto turn = turnOf(headerAt(10.5), params, transforms);
  EXPECT_NEAR(std::atan2(turn->R_tracking_sensor(1, 0), turn->R_tracking_sensor(0, 0)), 0.5, 1e-9);
  EXPECT_FALSE(turn->attitude_covariance);
  for (const double outside : {9.9, 11.1}) {
    EXPECT_FALSE(isTurnKnown(headerAt(outside), params, transforms)) << outside;
    EXPECT_THROW(turnOf(headerAt(outside), params, transforms), tf2::TransformException) << outside;
  }
}

TEST(SensorTurn, TimeOfTheTransformsCountsByTheRateOfTurn) {
  tf2::BufferCore transforms;
  setYaw(transforms, 10.0, 0.0);
  setYaw(transforms, 10.5, 1.0);  // 2 rad/s
  FrameChangeParams params;
  params.attitude.time_sigma = 1e-3;
  const auto covariance = turnOf(headerAt(10.2), params, transforms)->attitude_covariance;
  ASSERT_TRUE(covariance);
  EXPECT_NEAR((*covariance)(2, 2), std::pow(1e-3 * 2.0, 2), 1e-10);
  EXPECT_NEAR((*covariance)(0, 0), 0.0, 1e-12);
}

TEST(SensorTurn, FieldOfViewIsThatOfTheSensorByName) {
  FrameChangeParams params;
  params.fields_of_view["eye"] = {0.3, 0.2};
  EXPECT_FALSE(viewOf("ear", params, std::nullopt));
  sightline_ros::Turn turn;
  turn.R_tracking_sensor << 0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0;
  const auto view = viewOf("eye", params, turn);
  EXPECT_EQ(view->half_widths, Eigen::Vector2d(0.3, 0.2));
  EXPECT_TRUE(view->holds(Eigen::Vector3d::UnitY()));
  EXPECT_FALSE(view->holds(Eigen::Vector3d::UnitX()));
}

}  // namespace
