#pragma once

#include <ros/time.h>

#include "sightline/core/model/time.h"
#include "sightline/ros/messages/conversions.h"

namespace sightline_ros {

/// ROS's clock, wall or simulated; 0 while a simulated one has not begun.
inline sightline::core::Time clockNow() {
  return toCore(ros::Time::now());
}

}  // namespace sightline_ros
