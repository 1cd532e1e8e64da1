#pragma once

#include <cstddef>
#include <vector>

#include <geometry_msgs/TransformStamped.h>
#include <rosbag/bag.h>
#include <tf2/buffer_core.h>

#include "sightline/core/model/time.h"

namespace sightline_ros {

/// The transforms of a recording (/tf and /tf_static), put into a buffer as time advances. All are read at
/// the beginning and ordered by their stamps, so the result does not depend on when they arrived.
class RecordedTransforms {
 public:
  /// How far lookups may go behind the time that was advanced to [s].
  static constexpr double kReach = 60.0;

  explicit RecordedTransforms(const rosbag::Bag& bag);

  /// Makes the transforms stamped up to `time` available.
  void advanceTo(sightline::core::Time time);

  /// Starts before the first again: for a recording whose stamps go back.
  void rewind();

  const tf2::BufferCore& buffer() const { return buffer_; }

 private:
  tf2::BufferCore buffer_;
  std::vector<geometry_msgs::TransformStamped> fixed_;
  std::vector<geometry_msgs::TransformStamped> moving_;  // by stamp
  std::size_t next_ = 0;
};

}  // namespace sightline_ros
