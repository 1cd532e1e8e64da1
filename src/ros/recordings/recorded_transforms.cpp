#include "sightline/ros/recordings/recorded_transforms.h"

#include <algorithm>
#include <map>
#include <string>
#include <tuple>
#include <utility>

#include <rosbag/view.h>
#include <tf2_msgs/TFMessage.h>

#include "sightline/ros/messages/conversions.h"
#include "sightline/ros/recordings/bags.h"

namespace sightline_ros {

namespace core = sightline::core;

namespace {

constexpr int kMostSteps = 100;  // up from a frame

std::vector<geometry_msgs::TransformStamped> transformsOn(const std::string& topic, const rosbag::Bag& bag) {
  std::vector<geometry_msgs::TransformStamped> transforms;
  rosbag::View view(bag, rosbag::TopicQuery(topic));
  for (const rosbag::MessageInstance& instance : view) {
    const auto message = messageIn<tf2_msgs::TFMessage>(instance);
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

RecordedTransforms::RecordedTransforms(const rosbag::Bag& bag, KnownTransforms known)
    : buffer_(ros::Duration(kReach)), fixed_(transformsOn("/tf_static", bag)) {
  auto moving = transformsOn("/tf", bag);
  std::stable_sort(moving.begin(), moving.end(), precedes);
  // The buffer would complain of each repetition.
  moving.erase(std::unique(moving.begin(), moving.end(), isRepeated), moving.end());
  std::map<std::string, core::Time> last;  // stamp, by child frame
  moving_.reserve(moving.size());
  for (geometry_msgs::TransformStamped& transform : moving) {
    const core::Time stamp = toCore(transform.header.stamp);
    moving_frames_.insert(transform.child_frame_id);
    const auto [before, is_first] = last.try_emplace(transform.child_frame_id, core::Time::min());
    moving_.push_back({known == KnownTransforms::one_further ? before->second : stamp, std::move(transform)});
    before->second = stamp;
  }
  std::stable_sort(moving_.begin(), moving_.end(),
                   [](const Moving& a, const Moving& b) { return a.due < b.due; });
  rewind();
}

void RecordedTransforms::rewind() {
  buffer_.clear();
  next_ = 0;
  for (const auto& transform : fixed_) buffer_.setTransform(transform, "bag", true);
}

std::string RecordedTransforms::platformOf(const std::string& frame) const {
  std::string at = frame, parent;
  for (int step = 0; step < kMostSteps; ++step) {
    if (moving_frames_.count(at) > 0) return at;
    if (!buffer_._getParent(at, ros::Time(0), parent)) return {};
    at = parent;
  }
  return {};
}

void RecordedTransforms::advanceTo(core::Time time) {
  for (; bringsAny(time); ++next_) buffer_.setTransform(moving_[next_].transform, "bag", false);
}

}  // namespace sightline_ros
