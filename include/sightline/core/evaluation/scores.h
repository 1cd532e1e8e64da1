#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "sightline/core/evaluation/appearances.h"
#include "sightline/core/evaluation/continuity.h"
#include "sightline/core/evaluation/gospa.h"
#include "sightline/core/evaluation/metrics.h"
#include "sightline/core/evaluation/ospa.h"
#include "sightline/core/evaluation/track_lives.h"
#include "sightline/core/model/sighting.h"
#include "sightline/core/model/track.h"

/// Scans and track reports of one topic against the truth of the same instant.
namespace sightline::core {

/// A target at the instant that is judged.
struct TrueTarget {
  std::uint32_t id = 0;
  AngularState state;                                    ///< the truth, tracking frame, covariance zero
  bool settled = true;                                   ///< false: its errors do not count yet
  double age = std::numeric_limits<double>::infinity();  ///< how long it has been there without a gap [s]
};

/// What a tracker said at one instant.
struct TrackReport {
  Time time{};
  std::string tracker;  ///< its name
  bool fused = false;   ///< tracks of tracks
  std::vector<Track> tracks;
};

/// A sighting or track that was found to be of a target; for whoever wants to draw the errors.
struct ScoredPair {
  std::string topic;
  std::string name;  ///< sensor or tracker
  Time time{};
  std::uint32_t target = 0;
  std::uint32_t track = 0;  ///< id; 0 for a sighting
  Eigen::Vector2d angles;   ///< of the sighting or track [rad]
  Eigen::Vector2d truth;    ///< [rad]
  DirectionError error;
};

/// The metric of a report.
struct ScoredReport {
  std::string topic;
  Time time{};
  Gospa gospa;
  Ospa ospa;  ///< by the same order and cutoff
};

/// Told of everything that counts; either may be empty.
struct ScoreListener {
  std::function<void(const ScoredPair&)> pair;
  std::function<void(const ScoredReport&)> report;
};

/// Which sighting belongs to a target: one within `sigmas` of its stated covariance (Mahalanobis distance),
/// or within `floor` [rad] of the truth whatever it states.
struct SightingGate {
  double sigmas = 6.0;
  double floor = 0.0;
};

/// The sightings of one sensor on one topic. The others than those matched are false ones, or of no known
/// target.
class SightingScore {
 public:
  SightingScore(std::string topic, std::string sensor, Channels channels)
      : topic_(std::move(topic)), sensor_(std::move(sensor)), channels_(channels), errors_(channels) {}

  /// Notes what the sightings state of themselves; before the truth is known.
  void note(const Scan& scan_tracking);

  /// Each target takes at most one sighting: as many as there are within the gate, the nearest together.
  void judge(const Scan& scan_tracking, const std::vector<TrueTarget>& targets, const SightingGate& gate,
             const ScoreListener& listener);

  const std::string& topic() const { return topic_; }
  const std::string& sensor() const { return sensor_; }
  const ErrorStatistics& errors() const { return errors_; }
  double statedSigma()
      const;  ///< root mean stated variance of a channel [rad]; NaN before the first sighting
  double lastError() const {
    return last_error_;
  }  ///< rms over channels and targets, last scan with any [rad]
  std::uint64_t unmatched() const { return unmatched_; }

 private:
  std::string topic_, sensor_;
  Channels channels_;
  ErrorStatistics errors_;
  RunningMean stated_variance_;
  double last_error_ = std::numeric_limits<double>::quiet_NaN();
  std::uint64_t unmatched_ = 0;
};

/// The tracks of one target, over all its appearances.
struct TargetScore {
  explicit TargetScore(Channels channels) : errors(channels) {}

  ErrorStatistics errors;
  std::uint64_t reports = 0, covered = 0;  ///< while it was there, and those of them in which it had a track
  std::uint32_t breaks = 0, id_switches = 0;

  double coverage() const { return static_cast<double>(covered) / static_cast<double>(reports); }
};

/// The believed (confirmed or coasting) tracks of one topic.
class TrackScore {
 public:
  TrackScore(std::string topic, Channels channels, const GospaParams& gospa)
      : topic_(std::move(topic)), channels_(channels), errors_(channels), gospa_(gospa) {}

  /// Notes what is reported; before the truth is known.
  void note(const TrackReport& report);

  /// Tracks within `gate` [rad] are assigned to targets with the smallest sum of squared distances. A target
  /// that has a track keeps it unless another assignment is better by more than the square of a third of the
  /// gate for each target that changes: so that targets which cross do not seem to exchange their tracks, and
  /// tracks that do are seen to.
  void judge(const TrackReport& report, const std::vector<TrueTarget>& targets, double gate,
             const ScoreListener& listener);

  /// The truth begins anew: which track each target had is forgotten, what counted stays.
  void restart() {
    continuity_.forgetAll();
    appearances_.endAll();
    lives_.restart();
    last_judged_ = std::nullopt;
  }

  const std::string& topic() const { return topic_; }
  const std::string& tracker() const { return tracker_; }  ///< empty before the first report
  bool fused() const { return fused_; }
  const ErrorStatistics& errors() const { return errors_; }
  const Continuity& continuity() const { return continuity_; }
  const GospaMeans& gospaMeans() const { return gospa_; }
  const RunningMean& ospaMean() const { return ospa_; }            ///< of the distance [rad]
  const Appearances& appearances() const { return appearances_; }  ///< settled or not
  const TrackLives& lives() const { return lives_; }
  const std::map<std::uint32_t, TargetScore>& targets() const { return targets_; }  ///< by id
  double judgedTime() const { return judged_time_; }  ///< between reports no further apart than 2 s [s]
  std::uint64_t unmatched() const { return unmatched_; }
  double lastError() const {
    return last_error_;
  }  ///< rms over channels and targets, last report with any [rad]
  int tracksNow() const { return tracks_now_; }              ///< believed tracks in the last report
  Eigen::Vector2d anglesNow() const { return angles_now_; }  ///< of the first of them [rad]; NaN without

 private:
  /// Forgets which track the targets had that left, or left and came back, since the last report.
  void forgetTheDeparted(Time time, const std::vector<TrueTarget>& targets);

  /// Notes on which target each track is; `track_of`: for each target its track, or nullptr.
  void noteLives(const std::vector<const Track*>& tracks, const std::vector<TrueTarget>& targets,
                 const std::vector<const Track*>& track_of);

  void noteContinuity(const TrueTarget& target, const Track* track);

  /// Adds the error; returns its mean square over the channels [rad^2].
  double judgePair(const TrackReport& report, const TrueTarget& target, const Track& track,
                   const ScoreListener& listener);

  std::string topic_, tracker_;
  bool fused_ = false;
  Channels channels_;
  ErrorStatistics errors_;
  Continuity continuity_;
  std::optional<Time> last_judged_;
  GospaMeans gospa_;
  RunningMean ospa_;
  Appearances appearances_;
  TrackLives lives_;
  std::map<std::uint32_t, TargetScore> targets_;
  double judged_time_ = 0.0;  // [s]
  std::uint64_t unmatched_ = 0;
  double last_error_ = std::numeric_limits<double>::quiet_NaN();
  int tracks_now_ = 0;
  Eigen::Vector2d angles_now_ = Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
};

}  // namespace sightline::core
