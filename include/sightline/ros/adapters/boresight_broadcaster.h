#pragma once

#include <set>
#include <string>

#include <geometry_msgs/TransformStamped.h>
#include <ros/node_handle.h>
#include <ros/time.h>
#include <ros/wall_timer.h>
#include <tf2_ros/static_transform_broadcaster.h>

namespace sightline_ros {

/// The pose of the boresight frame (x forward, y left, z up) in the optical frame (z forward, x right).
geometry_msgs::TransformStamped boresightTransform(const std::string& optical_frame, const ros::Time& stamp);

/// Publishes to /tf_static the boresight frames (x forward, y left, z up) that belong to cameras' optical
/// frames.
class BoresightBroadcaster {
 public:
  explicit BoresightBroadcaster(const ros::NodeHandle& nh);

  /// From now on `<optical_frame>_boresight` is published.
  void add(const std::string& optical_frame);

 private:
  void broadcast();

  std::set<std::string> optical_frames_;
  tf2_ros::StaticTransformBroadcaster static_transforms_;
  ros::WallTimer repetition_;
};

}  // namespace sightline_ros
