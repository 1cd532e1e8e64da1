#pragma once

#include <functional>

#include <ros/node_handle.h>
#include <ros/subscriber.h>
#include <tf2/buffer_core.h>
#include <tf2_msgs/TFMessage.h>

namespace sightline_ros {

/// Fills a transform buffer from /tf and /tf_static on the node handle's own callback queue, and calls back
/// after each message: what waits for a transform continues at once, and needs no lock. (Users of
/// tf2_ros::TransformListener have to poll.)
class TransformSubscriber {
 public:
  /// Topics remap as usual. `on_change` is called after each message; `buffer` must outlive this.
  TransformSubscriber(ros::NodeHandle nh, tf2::BufferCore& buffer, std::function<void()> on_change);

 private:
  void take(const tf2_msgs::TFMessage& message, bool is_static);

  tf2::BufferCore& buffer_;
  std::function<void()> on_change_;
  ros::Time newest_;  // of the clock, to see when it goes back
  ros::Subscriber moving_;
  ros::Subscriber fixed_;
};

}  // namespace sightline_ros
