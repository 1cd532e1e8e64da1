#include "sightline/ros/diagnosis/callback_guard.h"

#include <diagnostic_msgs/DiagnosticStatus.h>
#include <ros/console.h>

namespace sightline_ros {
namespace {

constexpr double kSecondsBetweenLines = 5.0;  // of the wall's clock

}  // namespace

void CallbackGuard::note(const std::string& what, const std::string& problem) {
  Failures& failures = failures_[what];
  ++failures.count;
  failures.latest = problem;
  const ros::WallTime now = ros::WallTime::now();
  if (failures.last_line && (now - *failures.last_line).toSec() < kSecondsBetweenLines) return;
  ROS_ERROR_STREAM(node_ << ": dropped what came from " << what << " ("
                         << failures.count - failures.count_warned << " new, " << failures.count
                         << " in all), as its handling failed: " << problem << "; please report this");
  failures.last_line = now;
  failures.count_warned = failures.count;
}

void CallbackGuard::diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) {
  for (auto& [what, failures] : failures_) {
    status.add("failed, " + what, std::to_string(failures.count) + ", the last: " + failures.latest);
    if (failures.count > failures.count_before) {
      status.mergeSummary(
          diagnostic_msgs::DiagnosticStatus::ERROR,
          std::to_string(failures.count - failures.count_before) + " messages of " + what + " failed");
    }
    failures.count_before = failures.count;
  }
}

}  // namespace sightline_ros
