#pragma once

#include <cstddef>
#include <set>
#include <string>
#include <vector>

#include <geometry_msgs/TransformStamped.h>
#include <rosbag/bag.h>
#include <tf2/buffer_core.h>

#include "sightline/core/model/time.h"

namespace sightline_ros {

/// Which transforms of a recording are known at a time.
enum class KnownTransforms {
  up_to_time,   ///< those stamped up to it, as a live tracker knows them
  one_further,  ///< and of each frame the next one, however much later: for whatever time there is one before
                ///< and one after, no more than `kReach` apart
};

/// The transforms of a recording (/tf and /tf_static), put into a buffer as time advances. All are read at
/// the beginning and ordered by their stamps, so the result does not depend on when they arrived.
class RecordedTransforms {
 public:
  /// How far lookups may go behind the time that was advanced to [s].
  static constexpr double kReach = 60.0;

  explicit RecordedTransforms(const rosbag::Bag& bag, KnownTransforms known = KnownTransforms::one_further);

  /// Makes the transforms that are known at `time` available.
  void advanceTo(sightline::core::Time time);

  /// Whether `advanceTo(time)` would bring any.
  bool bringsAny(sightline::core::Time time) const {
    return next_ < moving_.size() && moving_[next_].due <= time;
  }

  /// Starts before the first again: for a recording whose stamps go back.
  void rewind();

  const tf2::BufferCore& buffer() const { return buffer_; }

  /// The frame nearest above `frame`, or itself, that /tf moves and not /tf_static: the platform on which it
  /// is mounted. Empty where there is none, as far as transforms are known at the time that was advanced to.
  std::string platformOf(const std::string& frame) const;

 private:
  struct Moving {
    sightline::core::Time due{};  // when it becomes known
    geometry_msgs::TransformStamped transform;
  };

  tf2::BufferCore buffer_;
  std::vector<geometry_msgs::TransformStamped> fixed_;
  std::vector<Moving> moving_;  // by `due`
  std::set<std::string> moving_frames_;
  std::size_t next_ = 0;
};

}  // namespace sightline_ros
