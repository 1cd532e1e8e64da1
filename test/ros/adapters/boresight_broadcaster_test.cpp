#include "sightline/ros/adapters/boresight_broadcaster.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace {

TEST(BoresightBroadcaster, BoresightFrameLooksAlongTheOpticalAxisWithItsLeftAndUp) {
  const auto transform = sightline_ros::boresightTransform("camera_optical", ros::Time(7.0));
  EXPECT_EQ(transform.header.frame_id, "camera_optical");
  EXPECT_EQ(transform.child_frame_id, "camera_optical_boresight");
  EXPECT_EQ(transform.header.stamp, ros::Time(7.0));
  const auto& q = transform.transform.rotation;
  const Eigen::Matrix3d R_optical_boresight = Eigen::Quaterniond(q.w, q.x, q.y, q.z).toRotationMatrix();
  // Optical frame: x right, y down, z forward.
  EXPECT_LT((R_optical_boresight * Eigen::Vector3d::UnitX() - Eigen::Vector3d::UnitZ()).norm(), 1e-12);
  EXPECT_LT((R_optical_boresight * Eigen::Vector3d::UnitY() + Eigen::Vector3d::UnitX()).norm(), 1e-12);
  EXPECT_LT((R_optical_boresight * Eigen::Vector3d::UnitZ() + Eigen::Vector3d::UnitY()).norm(), 1e-12);
}

}  // namespace
