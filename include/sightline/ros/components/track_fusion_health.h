#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <diagnostic_updater/DiagnosticStatusWrapper.h>
#include <sightline/TrackArray.h>
#include <sightline/TrackletArray.h>

#include "sightline/core/model/refusal.h"
#include "sightline/core/model/time.h"
#include "sightline/ros/components/track_fusion_component.h"
#include "sightline/ros/params/param_reader.h"

namespace sightline_ros {

/// What an operator is told about a track fusion: rate and age of every source, global tracks by status, what
/// was refused or left out and why. Times are the clock's, handed in.
class TrackFusionHealth {
 public:
  /// `topics` are those that are expected to speak; without a message for `silence` [s] one is reported as
  /// silent.
  TrackFusionHealth(const std::vector<std::string>& topics, double silence);

  void note(const sightline::TrackArray& local, const std::string& topic, const FusionResult& result);

  /// A fusion of messages that waited, noted before.
  void noteFusion(const FusionResult& result);

  /// What became of a message of tracklets; of all, `late` were too late so far.
  void noteTracklets(const sightline::TrackletArray& local,
                     const std::optional<sightline::core::Refusal>& refusal, std::size_t late);

  /// Tracklets that estimators could not take, of all so far.
  void noteFailures(const sightline::core::TrackletFailures& failures);

  /// Lines for the log about sensors whose verdict changed with this result, at most one in five seconds of
  /// `now` for each sensor; recoveries are always said.
  std::vector<std::string> sensorLines(const FusionResult& result, sightline::core::Time now);

  /// Lines to warn with, for what needs the operator's hand and was not complained of lately: at most one in
  /// five seconds of `now` for each kind.
  std::vector<std::string> warnings(sightline::core::Time now);

  /// Fills a diagnostic status; rates and the level are over the time since the last call.
  void diagnose(sightline::core::Time now, diagnostic_updater::DiagnosticStatusWrapper& status);

 private:
  struct Source {
    std::string tracker;  // empty before the first message
    std::uint64_t messages = 0;
    std::uint64_t messages_before = 0;  // at the last diagnosis
    std::size_t tracks = 0;             // in the last message
    sightline::core::Time newest{};
  };
  struct Complaint {
    std::uint64_t count = 0;
    std::uint64_t count_before = 0;  // at the last diagnosis
    std::uint64_t count_warned = 0;  // at the last warning
    std::string latest;              // its details
    std::optional<sightline::core::Time> last_warning;
  };

  struct Changes {
    std::uint64_t held_back = 0;  // since the last line
    std::optional<sightline::core::Time> last_line;
  };

  void complain(const sightline::core::Refusal& reason);
  void noteSensors(const sightline::FusedTrack& track);
  void noteLeftOut(const std::vector<sightline::core::SourceTrack>& rows);
  void summarize(sightline::core::Time now, diagnostic_updater::DiagnosticStatusWrapper& status) const;

  double silence_;
  std::map<std::string, Source> sources_;           // by topic
  std::map<std::string, Complaint> complaints_;     // by kind
  std::map<std::string, std::size_t> left_out_;     // local tracks by kind of reason, in the last report
  std::array<std::uint64_t, 3> tracks_{};           // global, by status, in the last report
  std::map<std::string, std::size_t> rules_;        // global tracks by the rule that made them, likewise
  std::map<std::string, std::uint64_t> tracklets_;  // tracklets received, by tracker
  std::map<std::string, std::string> sensors_;      // words on each, in the last report
  std::map<std::string, std::string> harmful_;      // of those, the ones that are not healthy
  std::map<std::string, Changes> changes_;          // by sensor
  std::size_t late_tracklets_ = 0, failed_tracklets_ = 0;
  std::string why_not_tracklets_;  // of a track of the last report; empty when there is none
  std::optional<sightline::core::Time> last_diagnosis_;
};

}  // namespace sightline_ros
