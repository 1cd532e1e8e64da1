#pragma once

#include <string>

#include <Eigen/Geometry>

#include <geometry_msgs/TransformStamped.h>
#include <ros/time.h>

namespace sightline_ros {

/// Static transforms are repeated at this interval [s of the wall's clock]: of several latched messages of
/// one process roscpp keeps only the last, so that late subscribers would receive the transforms of only one
/// of the nodelets in a manager.
constexpr double kSecondsBetweenStaticTransforms = 0.5;

/// The pose of frame `child` in frame `parent`: position of its origin [m], and the rotation that maps child
/// to parent.
inline geometry_msgs::TransformStamped transformMessage(const ros::Time& stamp, const std::string& parent,
                                                        const std::string& child,
                                                        const Eigen::Vector3d& position_parent,
                                                        const Eigen::Matrix3d& R_parent_child) {
  const Eigen::Quaterniond turn(R_parent_child);
  geometry_msgs::TransformStamped message;
  message.header.stamp = stamp;
  message.header.frame_id = parent;
  message.child_frame_id = child;
  message.transform.translation.x = position_parent.x();
  message.transform.translation.y = position_parent.y();
  message.transform.translation.z = position_parent.z();
  message.transform.rotation.x = turn.x();
  message.transform.rotation.y = turn.y();
  message.transform.rotation.z = turn.z();
  message.transform.rotation.w = turn.w();
  return message;
}

/// The rotation of a transform, from child to parent; its quaternion need not have unit length.
inline Eigen::Matrix3d rotationOf(const geometry_msgs::TransformStamped& transform) {
  const auto& q = transform.transform.rotation;
  return Eigen::Quaterniond(q.w, q.x, q.y, q.z).normalized().toRotationMatrix();
}

}  // namespace sightline_ros
