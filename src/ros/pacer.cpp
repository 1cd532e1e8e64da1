#include "sightline/ros/pacer.h"

#include <algorithm>

#include <ros/console.h>

namespace sightline_ros {
namespace {

constexpr double kShortestSleep = 1e-6;    // [s]: a timer's period must be above 0
constexpr double kClockPoll = 0.01;        // [s]: how often to look for a clock that has not started
constexpr double kNoticeableDelay = 0.25;  // [s]
constexpr double kSecondsBetweenWarnings = 5.0;

}  // namespace

Pacer::Pacer(const ros::NodeHandle& nh, Work work)
    : work_(std::move(work)),
      timer_(nh.createTimer(
          ros::Duration(kShortestSleep), [this](const ros::TimerEvent&) { run(); }, true, false)) {}

void Pacer::wake() {
  due_.reset();
  const ros::Time now = ros::Time::now();
  sleepUntil(now, now);
}

void Pacer::run() {
  const ros::Time now = ros::Time::now();
  if (now.isZero()) return sleepUntil(now + ros::Duration(kClockPoll), now);  // simulated time has not begun
  if (due_ && (now - *due_).toSec() > kNoticeableDelay) {
    ROS_WARN_STREAM_THROTTLE(kSecondsBetweenWarnings,
                             "runs " << (now - *due_).toSec()
                                     << " s late: the machine is too slow, was suspended, or "
                                        "the clock has jumped");
  }
  due_ = work_(now);
  if (due_) sleepUntil(*due_, now);
}

void Pacer::sleepUntil(const ros::Time& due, const ros::Time& now) {
  timer_.stop();
  timer_.setPeriod(ros::Duration(std::max((due - now).toSec(), kShortestSleep)));
  timer_.start();
}

}  // namespace sightline_ros
