#pragma once

#include <functional>
#include <optional>

#include <ros/node_handle.h>
#include <ros/time.h>
#include <ros/timer.h>
#include <ros/wall_timer.h>

namespace sightline_ros {

/// Runs work at the times that it asks for, on ROS's clock, wall or simulated. The times are absolute: the
/// duration of one run does not delay the next, and neither does a simulated clock that jumps meanwhile.
/// Warns (throttled) when it falls behind.
class Pacer {
 public:
  /// Does everything that is due at `now`; returns when it is next due, nullopt when there is nothing to wait
  /// for.
  using Work = std::function<std::optional<ros::Time>(const ros::Time& now)>;

  /// `work` is called from the handle's callback queue, not from the constructor.
  Pacer(const ros::NodeHandle& nh, Work work);

  /// Runs the work as soon as the queue gets there, whatever it waits for.
  void wake();

 private:
  void run();
  bool sleepsUntil(const ros::Time& due);

  Work work_;
  std::optional<ros::Time> due_;  // what the timer waits for
  ros::Timer timer_;
  ros::WallTimer wake_up_;  // by the wall's clock: a simulated one may stand still
};

}  // namespace sightline_ros
