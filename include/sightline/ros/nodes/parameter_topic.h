#pragma once

#include <map>
#include <string>
#include <vector>

#include <ros/node_handle.h>
#include <ros/publisher.h>
#include <std_msgs/String.h>

#include "sightline/ros/params/param_reader.h"
#include "sightline/ros/params/reconfiguration.h"

namespace sightline_ros {

/// A node's parameters on `~parameters` (std_msgs/String, latched), a line `key: value` each, defaults
/// included: so that a recording tells them, and those that change in flight once more.
class ParameterTopic {
 public:
  /// `reader`: with which they have been read.
  ParameterTopic(const ros::NodeHandle& pnh, const ParamReader& reader)
      : publisher_(ros::NodeHandle(pnh).advertise<std_msgs::String>("parameters", 1, true)) {
    publish(reader);
  }

  /// Again, with those that `reader` has read since.
  void publish(const ParamReader& reader) {
    for (const ReadParam& param : reader.readParams()) values_[param.key] = shortText(param.value);
    std_msgs::String message;
    for (const auto& [key, value] : values_) message.data += key + ": " + value + "\n";
    publisher_.publish(message);
  }

 private:
  std::map<std::string, std::string> values_;
  ros::Publisher publisher_;
};

}  // namespace sightline_ros
