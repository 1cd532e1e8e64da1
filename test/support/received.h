#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <ros/ros.h>

constexpr double kPatience = 30.0;  // [s], for what takes milliseconds on an idle machine

/// Keeps everything that was said on a topic.
template <typename Message>
class Heard {
 public:
  Heard(ros::NodeHandle& nh, const std::string& topic)
      : subscriber_(nh.subscribe(topic, 10000, &Heard::take, this, ros::TransportHints().tcpNoDelay())) {}

  const std::vector<Message>& messages() const { return messages_; }
  std::uint32_t publishers() const { return subscriber_.getNumPublishers(); }
  bool isConnected() const { return publishers() > 0; }
  void forget() { messages_.clear(); }

 private:
  void take(const boost::shared_ptr<const Message>& message) { messages_.push_back(*message); }

  std::vector<Message> messages_;
  ros::Subscriber subscriber_;
};

/// Serves callbacks until the condition holds, doing something about it every `pace` meanwhile; false when it
/// does not within kPatience.
inline bool eventually(
    const std::function<bool()>& condition, const std::function<void()>& meanwhile = [] {},
    ros::WallDuration pace = ros::WallDuration(0.002)) {
  const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(kPatience);
  while (ros::ok() && ros::WallTime::now() < end) {
    ros::spinOnce();
    if (condition()) return true;
    meanwhile();
    pace.sleep();
  }
  return condition();
}
