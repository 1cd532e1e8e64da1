#include "sightline/ros/messages/transform_messages.h"

#include <gtest/gtest.h>

namespace {

TEST(TransformMessages, ATransformIsThePoseOfTheChildInTheParent) {
  const Eigen::Matrix3d R_parent_child =
      (Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(-0.2, Eigen::Vector3d::UnitX()))
          .toRotationMatrix();
  const auto message =
      sightline_ros::transformMessage(ros::Time(3.5), "parent", "child", {1.0, 2.0, 3.0}, R_parent_child);
  EXPECT_EQ(message.header.stamp, ros::Time(3.5));
  EXPECT_EQ(message.header.frame_id, "parent");
  EXPECT_EQ(message.child_frame_id, "child");
  EXPECT_EQ(message.transform.translation.y, 2.0);
  const auto& q = message.transform.rotation;
  EXPECT_LT((Eigen::Quaterniond(q.w, q.x, q.y, q.z).toRotationMatrix() - R_parent_child).norm(), 1e-12);
}

}  // namespace
