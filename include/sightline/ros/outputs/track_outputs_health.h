#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <diagnostic_updater/DiagnosticStatusWrapper.h>

#include "sightline/core/model/time.h"
#include "sightline/ros/diagnosis/refusals.h"
#include "sightline/ros/outputs/track_outputs_component.h"

namespace sightline_ros {

/// What an operator is told about outputs: tracks and their age, what was left out, what the head does. Times
/// are the clock's, handed in.
class TrackOutputsHealth {
 public:
  /// Without tracks on `topic` for `silence` [s] that is reported.
  TrackOutputsHealth(std::string topic, double silence) : topic_(std::move(topic)), silence_(silence) {}

  /// Returns lines to warn with: at most one in five seconds of `now` for each kind of refusal.
  std::vector<std::string> note(const OutputResult& result, sightline::core::Time now);
  std::vector<std::string> note(const sightline::core::Refusal& refusal, sightline::core::Time now);

  /// Fills a diagnostic status; levels are over the time since the last call. `head`: null while nobody
  /// listens to it.
  void diagnose(sightline::core::Time now, const HeadPointer* head,
                diagnostic_updater::DiagnosticStatusWrapper& status);

 private:
  std::string topic_;
  double silence_;
  std::uint64_t messages_ = 0;
  std::size_t tracks_ = 0;  // of the last message
  std::optional<sightline::core::Time> newest_;
  Refusals refusals_;
};

}  // namespace sightline_ros
