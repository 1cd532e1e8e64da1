#pragma once

#include <string>

#include <ros/node_handle.h>
#include <ros/time.h>

#include "sightline/core/model/time.h"
#include "sightline/ros/messages/conversions.h"

namespace sightline_ros {

/// ROS's clock, wall or simulated; 0 while a simulated one has not begun.
inline sightline::core::Time clockNow() {
  return toCore(ros::Time::now());
}

/// The node's full name without the leading slash; `pnh` is its private handle.
inline std::string nameOfNode(const ros::NodeHandle& pnh) {
  return pnh.getNamespace().substr(1);
}

}  // namespace sightline_ros
