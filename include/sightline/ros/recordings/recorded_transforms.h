#pragma once

#include <cstddef>
#include <vector>

#include <geometry_msgs/TransformStamped.h>
#include <rosbag/bag.h>
#include <tf2/buffer_core.h>

#include "sightline/core/model/time.h"

namespace sightline_ros {

/// The transforms of a recording, /tf and /tf_static, brought into a buffer as time goes on. Reading them all
/// at the beginning, in the order of their stamps, makes the result independent of when they had arrived.
class RecordedTransforms {
 public:
  /// How far lookups may go behind the time that was advanced to [s].
  static constexpr double kReach = 60.0;

  explicit RecordedTransforms(const rosbag::Bag& bag);

  /// Makes everything stamped up to `time` available.
  void advanceTo(sightline::core::Time time);

  /// Back to before the first: for a recording whose stamps go back.
  void rewind();

  const tf2::BufferCore& buffer() const { return buffer_; }

 private:
  tf2::BufferCore buffer_;
  std::vector<geometry_msgs::TransformStamped> fixed_;
  std::vector<geometry_msgs::TransformStamped> moving_;  // by stamp
  std::size_t next_ = 0;
};

}  // namespace sightline_ros
