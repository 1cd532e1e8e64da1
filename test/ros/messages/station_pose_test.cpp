#include "sightline/ros/messages/station_pose.h"

#include <cmath>

#include <gtest/gtest.h>

#include <tf2/exceptions.h>

namespace {

using sightline_ros::isPoseKnown;
using sightline_ros::poseOf;

/// Puts the mast at (x, 2, 3) m, turned by `yaw` [rad] about z of the map.
void setMast(tf2::BufferCore& transforms, double stamp, double x, double yaw, bool is_static = false) {
  geometry_msgs::TransformStamped transform;
  transform.header.stamp = ros::Time(stamp);
  transform.header.frame_id = "map";
  transform.child_frame_id = "mast";
  transform.transform.translation.x = x;
  transform.transform.translation.y = 2.0;
  transform.transform.translation.z = 3.0;
  transform.transform.rotation.z = std::sin(yaw / 2.0);
  transform.transform.rotation.w = std::cos(yaw / 2.0);
  transforms.setTransform(transform, "test", is_static);
}

TEST(StationPose, HasTheTranslationAndTheRotationOfTheStation) {
  tf2::BufferCore transforms;
  setMast(transforms, 10.0, 7.0, 0.5, true);
  const auto pose = poseOf("mast", ros::Time(11.0), "map", transforms);
  EXPECT_LT((pose.origin - Eigen::Vector3d(7.0, 2.0, 3.0)).norm(), 1e-12);
  // The mast's x axis in the map.
  const Eigen::Vector3d forward = pose.R_metric_station.col(0);
  EXPECT_LT((forward - Eigen::Vector3d(std::cos(0.5), std::sin(0.5), 0.0)).norm(), 1e-12);
  EXPECT_EQ(pose.velocity.norm(), 0.0);
}

TEST(StationPose, IsInterpolatedAndNeverExtrapolatedAndKnowsItsVelocity) {
  tf2::BufferCore transforms;
  setMast(transforms, 10.0, 0.0, 0.0);
  setMast(transforms, 11.0, 4.0, 0.2);
  const auto pose = poseOf("mast", ros::Time(10.5), "map", transforms);
  EXPECT_NEAR(pose.origin.x(), 2.0, 1e-9);
  EXPECT_LT((pose.velocity - Eigen::Vector3d(4.0, 0.0, 0.0)).norm(), 1e-6);
  EXPECT_LT((poseOf("mast", ros::Time(10.0), "map", transforms).velocity - pose.velocity).norm(), 1e-6);
  for (const double outside : {9.9, 11.1}) {
    EXPECT_FALSE(isPoseKnown("mast", ros::Time(outside), "map", transforms)) << outside;
    EXPECT_THROW(poseOf("mast", ros::Time(outside), "map", transforms), tf2::TransformException) << outside;
  }
}

TEST(StationPose, StationInTheMetricFrameItselfStandsAtItsOrigin) {
  const tf2::BufferCore none;
  EXPECT_TRUE(isPoseKnown("map", ros::Time(1.0), "map", none));
  const auto pose = poseOf("map", ros::Time(1.0), "map", none);
  EXPECT_EQ(pose.origin.norm(), 0.0);
  EXPECT_EQ(pose.R_metric_station, Eigen::Matrix3d::Identity());
}

}  // namespace
