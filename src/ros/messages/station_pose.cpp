#include "sightline/ros/messages/station_pose.h"

#include <Eigen/Geometry>

#include <tf2/exceptions.h>

#include "sightline/ros/messages/transform_messages.h"

namespace sightline_ros {

namespace core = sightline::core;

namespace {

constexpr double kVelocityStep = 0.05;  // over which the velocity is measured [s]

Eigen::Vector3d originOf(const geometry_msgs::TransformStamped& transform) {
  const auto& t = transform.transform.translation;
  return {t.x, t.y, t.z};
}

/// Whether a moment earlier or later is a stamp: time 0 means "the latest" to tf.
bool isStamp(const ros::Time& stamp, double step) {
  return stamp.toSec() + step > 0.0;
}

}  // namespace

bool isPoseKnown(const std::string& frame, const ros::Time& stamp, const std::string& metric_frame,
                 const tf2::BufferCore& transforms) {
  return frame == metric_frame || transforms.canTransform(metric_frame, frame, stamp);
}

core::StationPose poseOf(const std::string& frame, const ros::Time& stamp, const std::string& metric_frame,
                         const tf2::BufferCore& transforms) {
  core::StationPose pose;
  if (frame == metric_frame) return pose;
  const auto here = transforms.lookupTransform(metric_frame, frame, stamp);
  pose.origin = originOf(here);
  pose.R_metric_station = rotationOf(here);
  for (const double step : {-kVelocityStep, kVelocityStep}) {
    if (!isStamp(stamp, step)) continue;
    const ros::Time other = stamp + ros::Duration(step);
    if (!transforms.canTransform(metric_frame, frame, other)) continue;
    pose.velocity = (originOf(transforms.lookupTransform(metric_frame, frame, other)) - pose.origin) / step;
    break;
  }
  return pose;
}

}  // namespace sightline_ros
