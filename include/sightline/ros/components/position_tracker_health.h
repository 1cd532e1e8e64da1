#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include <diagnostic_updater/DiagnosticStatusWrapper.h>

#include "sightline/core/model/time.h"
#include "sightline/ros/components/position_tracker_component.h"
#include "sightline/ros/diagnosis/refusals.h"
#include "sightline/ros/params/param_reader.h"

namespace sightline_ros {

/// What an operator is told about a position tracker: rate and age of every source, positions by status,
/// crossings and local tracks without a position by reason, what is known of each station, and what was
/// refused. Times are the clock's, handed in.
class PositionTrackerHealth {
 public:
  /// `topics` of tracks that are expected to speak; without a message for `silence` [s] one is reported.
  PositionTrackerHealth(const std::vector<std::string>& topics, double silence);

  /// Returns lines to warn with: at most one in five seconds of `now` for each kind of refusal.
  std::vector<std::string> note(const PositionResult& result, sightline::core::Time now);

  /// Fills a diagnostic status; rates and the level are over the time since the last call. `stations`: where
  /// they are [m]; `waiting`: messages that wait for transforms.
  void diagnose(sightline::core::Time now, const std::map<std::string, Eigen::Vector3d>& stations,
                std::size_t waiting, diagnostic_updater::DiagnosticStatusWrapper& status);

 private:
  struct Source {
    std::string tracker;  // empty before the first message
    std::uint64_t messages = 0;
    std::uint64_t messages_before = 0;  // at the last diagnosis
    std::size_t tracks = 0;             // in the last message
    sightline::core::Time newest{};
  };

  void warnOfSilence(sightline::core::Time now, diagnostic_updater::DiagnosticStatusWrapper& status) const;

  double silence_;
  std::map<std::string, Source> sources_;           // by topic
  std::map<std::string, std::uint64_t> tracklets_;  // that were used, by topic
  sightline::PositionTrackArray::Ptr tracks_;       // the last; null before
  sightline::PositionReport::Ptr report_;           // likewise
  Refusals refusals_;
  std::optional<sightline::core::Time> last_diagnosis_;
};

}  // namespace sightline_ros
