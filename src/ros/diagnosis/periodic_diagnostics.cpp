#include "sightline/ros/diagnosis/periodic_diagnostics.h"

#include <utility>

namespace sightline_ros {
namespace {

constexpr double kPeriod = 1.0;  // [s]

}  // namespace

PeriodicDiagnostics::PeriodicDiagnostics(const ros::NodeHandle& nh, const ros::NodeHandle& pnh,
                                         const std::string& name, Task task)
    : task_(std::move(task)), updater_(nh, pnh, pnh.getNamespace()) {
  updater_.setHardwareID("none");
  updater_.add(name, this, &PeriodicDiagnostics::run);
  timer_ = nh.createWallTimer(ros::WallDuration(kPeriod),
                              [this](const ros::WallTimerEvent&) { updater_.force_update(); });
}

void PeriodicDiagnostics::run(diagnostic_updater::DiagnosticStatusWrapper& status) {
  const ros::WallTime now = ros::WallTime::now();
  const double elapsed = last_run_ ? (now - *last_run_).toSec() : 0.0;
  last_run_ = now;
  task_(status, elapsed);
}

}  // namespace sightline_ros
