#pragma once

#include <cstdint>
#include <string>

#include <ros/node_handle.h>

namespace sightline_ros {

/// Messages of a topic that a node lets wait.
constexpr std::uint32_t kQueue = 1000;

/// The same of a display, which looks at them once a picture.
constexpr std::uint32_t kDisplayQueue = 100;

/// A display repeats what does not move at this interval [s].
constexpr double kStaticPeriod = 1.0;

/// A note to the operator is repeated at most once in this time [s].
constexpr double kSecondsBetweenNotes = 10.0;

/// Between two looks for scans that have waited too long for their transform [s of the wall's clock].
constexpr double kSecondsBetweenTimeoutChecks = 0.02;

/// The node's full name without the leading slash; `pnh` is its private handle.
inline std::string nameOfNode(const ros::NodeHandle& pnh) {
  return pnh.getNamespace().substr(1);
}

}  // namespace sightline_ros
