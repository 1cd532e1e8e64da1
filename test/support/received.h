#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <ros/ros.h>

#include "support/waiting.h"

/// Keeps every message of a topic.
template <typename Message>
class Received {
 public:
  Received(ros::NodeHandle& nh, const std::string& topic)
      : subscriber_(nh.subscribe(topic, 10000, &Received::take, this, ros::TransportHints().tcpNoDelay())) {}

  const std::vector<Message>& messages() const { return messages_; }
  std::uint32_t publishers() const { return subscriber_.getNumPublishers(); }
  bool isConnected() const { return publishers() > 0; }
  void forget() { messages_.clear(); }

 private:
  void take(const boost::shared_ptr<const Message>& message) { messages_.push_back(*message); }

  std::vector<Message> messages_;
  ros::Subscriber subscriber_;
};
