#include "sightline/ros/recordings/recorded_transforms.h"

#include <algorithm>
#include <string>
#include <tuple>

#include <rosbag/view.h>
#include <tf2_msgs/TFMessage.h>

#include "sightline/ros/messages/conversions.h"

namespace sightline_ros {
namespace {

std::vector<geometry_msgs::TransformStamped> transformsOn(const std::string& topic, const rosbag::Bag& bag) {
  std::vector<geometry_msgs::TransformStamped> transforms;
  rosbag::View view(bag, rosbag::TopicQuery(topic));
  for (const rosbag::MessageInstance& instance : view) {
    const auto message = instance.instantiate<tf2_msgs::TFMessage>();
    if (!message) continue;
    transforms.insert(transforms.end(), message->transforms.begin(), message->transforms.end());
  }
  return transforms;
}

bool precedes(const geometry_msgs::TransformStamped& a, const geometry_msgs::TransformStamped& b) {
  return std::tie(a.header.stamp, a.child_frame_id) < std::tie(b.header.stamp, b.child_frame_id);
}

bool isRepeated(const geometry_msgs::TransformStamped& a, const geometry_msgs::TransformStamped& b) {
  return std::tie(a.header.stamp, a.child_frame_id) == std::tie(b.header.stamp, b.child_frame_id);
}

}  // namespace

RecordedTransforms::RecordedTransforms(const rosbag::Bag& bag)
    : buffer_(ros::Duration(kReach)),
      fixed_(transformsOn("/tf_static", bag)),
      moving_(transformsOn("/tf", bag)) {
  std::stable_sort(moving_.begin(), moving_.end(), precedes);
  // The buffer would complain of each repetition.
  moving_.erase(std::unique(moving_.begin(), moving_.end(), isRepeated), moving_.end());
  rewind();
}

void RecordedTransforms::rewind() {
  buffer_.clear();
  next_ = 0;
  for (const auto& transform : fixed_) buffer_.setTransform(transform, "bag", true);
}

void RecordedTransforms::advanceTo(sightline::core::Time time) {
  for (; next_ < moving_.size() && toCore(moving_[next_].header.stamp) <= time; ++next_) {
    buffer_.setTransform(moving_[next_], "bag", false);
  }
}

}  // namespace sightline_ros
