#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "sightline/core/evaluation/appearances.h"
#include "sightline/core/evaluation/continuity.h"
#include "sightline/core/evaluation/gospa.h"
#include "sightline/core/evaluation/metrics.h"
#include "sightline/core/evaluation/score_listener.h"
#include "sightline/core/evaluation/track_lives.h"
#include "sightline/core/evaluation/track_report.h"
#include "sightline/core/evaluation/truth.h"

namespace sightline::core {

/// The score of one target's tracks, over all its appearances.
struct TargetScore {
  explicit TargetScore(Channels channels) : errors(channels) {}

  ErrorStatistics errors;
  std::uint64_t reports = 0;  ///< while the target was there
  std::uint64_t covered = 0;  ///< reports among them in which it had a track
  std::uint32_t breaks = 0, id_switches = 0;

  double coverage() const { return static_cast<double>(covered) / static_cast<double>(reports); }
};

/// Scores the established (confirmed or coasting) tracks of one topic against the truth.
class TrackScore {
 public:
  TrackScore(std::string topic, Channels channels, const GospaParams& gospa)
      : topic_(std::move(topic)), channels_(channels), errors_(channels), gospa_(gospa) {}

  /// Notes what is reported now. Needs no truth.
  void note(const TrackReport& report);

  /// Tracks within `gate` [rad] are assigned to targets with the smallest sum of squared distances. A target
  /// that has a track keeps it unless another assignment is better by more than the square of a third of the
  /// gate for each target that changes. So targets that cross keep their tracks, and tracks that really
  /// change targets are counted. `targets` are those at the time of the report.
  void add(const TrackReport& report, const std::vector<TrueTarget>& targets, double gate,
           const ScoreListener& listener);

  /// The truth starts anew: forgets which track each target had and keeps what was counted.
  void restart() {
    continuity_.forgetAll();
    appearances_.endAll();
    lives_.restart();
    last_scored_ = std::nullopt;
  }

  const std::string& topic() const { return topic_; }
  const std::string& tracker() const { return tracker_; }  ///< empty before the first report
  bool fused() const { return fused_; }
  const ErrorStatistics& errors() const { return errors_; }
  const Continuity& continuity() const { return continuity_; }
  const GospaMeans& gospaMeans() const { return gospa_; }
  const RunningMean& ospaMean() const { return ospa_; }            ///< of the distance [rad]
  const Appearances& appearances() const { return appearances_; }  ///< of targets, scored or not
  const TrackLives& lives() const { return lives_; }
  const std::map<std::uint32_t, TargetScore>& targets() const { return targets_; }  ///< by id
  double scoredTime() const { return scored_time_; }  ///< between reports no further apart than 2 s [s]
  std::uint64_t unmatched() const { return unmatched_; }
  double lastError() const {
    return last_error_;
  }  ///< rms over channels and targets, last report with any [rad]
  int tracksNow() const { return tracks_now_; }              ///< established tracks in the last report
  Eigen::Vector2d anglesNow() const { return angles_now_; }  ///< of the first of them [rad]; NaN without

 private:
  /// Forgets the tracks of targets that left, or left and came back, since the last report.
  void forgetDepartedTargets(Time time, const std::vector<TrueTarget>& targets);

  void advanceTo(Time time);

  /// Notes on which target each track is. `track_of`: for each target its track, or nullptr.
  void noteLives(const std::vector<const Track*>& tracks, const std::vector<TrueTarget>& targets,
                 const std::vector<const Track*>& track_of);

  void noteContinuity(const TrueTarget& target, const Track* track);

  /// Adds the error and returns its mean square over the channels [rad^2].
  double scorePair(const TrackReport& report, const TrueTarget& target, const Track& track,
                   const ScoreListener& listener);

  std::string topic_, tracker_;
  bool fused_ = false;
  Channels channels_;
  ErrorStatistics errors_;
  Continuity continuity_;
  std::optional<Time> last_scored_;
  GospaMeans gospa_;
  RunningMean ospa_;
  Appearances appearances_;
  TrackLives lives_;
  std::map<std::uint32_t, TargetScore> targets_;
  double scored_time_ = 0.0;  // [s]
  std::uint64_t unmatched_ = 0;
  double last_error_ = std::numeric_limits<double>::quiet_NaN();
  int tracks_now_ = 0;
  Eigen::Vector2d angles_now_ = Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
};

}  // namespace sightline::core
