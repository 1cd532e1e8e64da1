#pragma once

#include <string>

#include <ros/node_handle.h>

namespace sightline_ros {

/// The node's full name without the leading slash; `pnh` is its private handle.
inline std::string nameOfNode(const ros::NodeHandle& pnh) {
  return pnh.getNamespace().substr(1);
}

}  // namespace sightline_ros
