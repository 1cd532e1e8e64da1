#pragma once

#include <functional>

#include <ros/callback_queue.h>
#include <ros/ros.h>

constexpr double kPatience = 60.0;  // [s] of the wall's clock, for what takes milliseconds on an idle machine

/// Serves callbacks as they come until the condition holds; false when it does not within `patience` [s] of
/// the wall's clock (a simulated one may stand still). Calls `meanwhile` every `pace`; the condition is
/// looked at after every callback, and at least every `pace`, for what no callback tells.
inline bool eventually(
    const std::function<bool()>& condition, const std::function<void()>& meanwhile = [] {},
    ros::WallDuration pace = ros::WallDuration(0.002), double patience = kPatience) {
  const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(patience);
  ros::WallTime next_act = ros::WallTime::now();
  while (ros::ok() && ros::WallTime::now() < end) {
    ros::getGlobalCallbackQueue()->callAvailable(pace);
    if (condition()) return true;
    if (ros::WallTime::now() < next_act) continue;
    meanwhile();
    next_act = ros::WallTime::now() + pace;
  }
  return condition();
}
