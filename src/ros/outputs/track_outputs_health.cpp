#include "sightline/ros/outputs/track_outputs_health.h"

#include <diagnostic_msgs/DiagnosticStatus.h>

#include "sightline/report/value_text.h"
#include "sightline/ros/messages/conversions.h"

namespace sightline_ros {

namespace core = sightline::core;
using diagnostic_msgs::DiagnosticStatus;
using sightline::report::valueOf;

std::vector<std::string> TrackOutputsHealth::note(const OutputResult& result, core::Time now) {
  std::vector<std::string> lines;
  if (!result.notice.empty()) lines.push_back(result.notice);
  for (const core::Refusal& refusal : result.refusals) {
    if (const auto line = refusals_.note(refusal, now)) lines.push_back(*line);
  }
  if (result.tracks) {
    ++messages_;
    tracks_ = result.tracks->tracks.size();
    newest_ = toCore(result.tracks->header.stamp);
  }
  return lines;
}

std::vector<std::string> TrackOutputsHealth::note(const core::Refusal& refusal, core::Time now) {
  const auto line = refusals_.note(refusal, now);
  return line ? std::vector<std::string>{*line} : std::vector<std::string>{};
}

void TrackOutputsHealth::diagnose(core::Time now, const HeadPointer* head,
                                  diagnostic_updater::DiagnosticStatusWrapper& status) {
  status.summary(DiagnosticStatus::OK, std::to_string(tracks_) + " tracks of " + topic_);
  const double age = newest_ ? core::seconds(now - *newest_) : 0.0;
  if (!newest_) {
    status.summary(DiagnosticStatus::WARN, "nothing yet on " + topic_);
  } else if (age > silence_) {
    status.summary(DiagnosticStatus::WARN, "no tracks on " + topic_ + " for " + valueOf(age, "s"));
  }
  status.add("messages", messages_);
  status.add("tracks", tracks_);
  if (newest_) status.add("age of the last message [s]", age);
  status.add("head", head != nullptr ? head->words() : "nobody listens");
  if (head != nullptr && !head->followed()) status.mergeSummary(DiagnosticStatus::WARN, head->words());
  refusals_.diagnose(status);
}

}  // namespace sightline_ros
