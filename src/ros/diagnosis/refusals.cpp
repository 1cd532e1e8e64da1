#include "sightline/ros/diagnosis/refusals.h"

#include <sstream>

#include <diagnostic_msgs/DiagnosticStatus.h>

namespace sightline_ros {

namespace core = sightline::core;

std::optional<std::string> Refusals::note(const core::Refusal& refusal, core::Time now) {
  Counted& counted = counts_[refusal.kind];
  ++counted.count;
  // A clock that goes back must not silence the warnings.
  if (counted.last_warning && now >= *counted.last_warning &&
      core::seconds(now - *counted.last_warning) < kSecondsBetweenWarnings) {
    return std::nullopt;
  }
  std::ostringstream warning;
  warning << refusal.kind << " (" << counted.count - counted.count_warned << " new, " << counted.count
          << " in all): " << core::readableDetail(refusal);
  counted.last_warning = now;
  counted.count_warned = counted.count;
  return warning.str();
}

void Refusals::diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) {
  for (auto& [kind, counted] : counts_) {
    if (counted.count > counted.count_before) {
      status.mergeSummary(
          diagnostic_msgs::DiagnosticStatus::WARN,
          "refused, " + kind + ": " + std::to_string(counted.count - counted.count_before) + " new");
    }
    status.add("refused, " + kind, counted.count);
    counted.count_before = counted.count;
  }
}

}  // namespace sightline_ros
