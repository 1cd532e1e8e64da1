#include "sightline/ros/diagnosis/transform_subscriber.h"

#include <boost/function.hpp>
#include <utility>

#include <ros/console.h>

namespace sightline_ros {
namespace {

constexpr std::uint32_t kTransformQueue =
    1000;  // messages; a start-up may bring many sensors' frames at once

ros::TransportHints promptly() {
  return ros::TransportHints().tcpNoDelay();
}

}  // namespace

TransformSubscriber::TransformSubscriber(ros::NodeHandle nh, tf2::BufferCore& buffer,
                                         std::function<void()> on_change)
    : buffer_(buffer), on_change_(std::move(on_change)) {
  const boost::function<void(const tf2_msgs::TFMessage::ConstPtr&)> take_moving =
      [this](const tf2_msgs::TFMessage::ConstPtr& message) { take(*message, false); };
  const boost::function<void(const tf2_msgs::TFMessage::ConstPtr&)> take_fixed =
      [this](const tf2_msgs::TFMessage::ConstPtr& message) { take(*message, true); };
  moving_ =
      nh.subscribe<tf2_msgs::TFMessage>("/tf", kTransformQueue, take_moving, ros::VoidConstPtr(), promptly());
  fixed_ = nh.subscribe<tf2_msgs::TFMessage>("/tf_static", kTransformQueue, take_fixed, ros::VoidConstPtr(),
                                             promptly());
}

void TransformSubscriber::take(const tf2_msgs::TFMessage& message, bool is_static) {
  const ros::Time now = ros::Time::now();
  if (now < newest_) {
    ROS_WARN_STREAM("the clock went back by " << (newest_ - now).toSec() << " s: transforms forgotten");
    buffer_.clear();
  }
  newest_ = now;
  for (const auto& transform : message.transforms) {
    buffer_.setTransform(transform, "tf", is_static);  // logs what it refuses
  }
  on_change_();
}

}  // namespace sightline_ros
