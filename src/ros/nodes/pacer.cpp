#include "sightline/ros/nodes/pacer.h"

#include <ros/console.h>

#include "sightline/ros/diagnosis/refusals.h"

namespace sightline_ros {
namespace {

constexpr double kAtOnce = 1e-6;           // [s]: a timer's period must be above 0
constexpr double kClockPoll = 0.01;        // [s]: how often to look for a clock that has not started
constexpr double kNoticeableDelay = 0.25;  // [s]

}  // namespace

Pacer::Pacer(const ros::NodeHandle& nh, Work work)
    : work_(std::move(work)),
      timer_(nh.createTimer(
          ros::Duration(kAtOnce), [this](const ros::TimerEvent&) { run(); }, true, false)),
      wake_up_(nh.createWallTimer(
          ros::WallDuration(kAtOnce), [this](const ros::WallTimerEvent&) { run(); }, true, false)) {}

void Pacer::wake() {
  due_.reset();
  wake_up_.stop();
  wake_up_.setPeriod(ros::WallDuration(kAtOnce));
  wake_up_.start();
}

void Pacer::run() {
  do {
    const ros::Time now = ros::Time::now();
    if (now.isZero()) {  // simulated time has not begun
      wake_up_.stop();
      wake_up_.setPeriod(ros::WallDuration(kClockPoll));
      return wake_up_.start();
    }
    if (due_ && (now - *due_).toSec() > kNoticeableDelay) {
      ROS_WARN_STREAM_THROTTLE(kSecondsBetweenWarnings,
                               "runs " << (now - *due_).toSec()
                                       << " s late: the machine is too slow, was suspended, or "
                                          "the clock has jumped");
    }
    due_ = work_(now);
  } while (due_ && !sleepsUntil(*due_));
}

/// False when it is that time already. A timer counts its period from the clock at its start: one that a
/// simulated clock has passed by meanwhile, or stands still at, would be late by that step, or for ever.
bool Pacer::sleepsUntil(const ros::Time& due) {
  ros::Time from;
  do {
    timer_.stop();
    from = ros::Time::now();
    if (from >= due) return false;
    timer_.setPeriod(due - from);
    timer_.start();
  } while (ros::Time::isSimTime() && ros::Time::now() != from);
  return true;
}

}  // namespace sightline_ros
