#pragma once

#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "sightline/core/evaluation/sighting_score.h"
#include "sightline/core/evaluation/track_score.h"
#include "sightline/core/evaluation/truth.h"

namespace sightline::core {

struct EvaluationParams {
  double settle_time = 0.0;    ///< first seconds of each target, which are not scored [s]; >= 0
  double truth_gap = 2.0;      ///< between samples further apart, a target is not there [s]; > 0
  double truth_memory = 10.0;  ///< how far back the truth is kept, for late scans [s]; > truth_gap
  double match_gate = 0.0;     ///< largest distance of a target's track [rad]; 0 = ten stated sigmas of the
                               ///< coarsest sensor, 0.1 rad before any sighting
  double sighting_gate = 6.0;  ///< largest distance of a target's sighting, in stated sigmas; > 0
  double sighting_gate_floor =
      0.0;  ///< distance within which a sighting is a target's, whatever sigma it states [rad]; >= 0
  Channels channels =
      Channels::azimuth_and_elevation;  ///< azimuth_only: elevations of the truth are not used
  GospaParams gospa;                    ///< cutoff and order, of OSPA too
};

/// One line of the table: the fields of sightline/EvaluationRow, and more.
struct EvaluationRow {
  enum class Kind { sightings, tracks, fused_tracks };

  Kind kind = Kind::sightings;
  std::string topic;
  std::string name;           ///< sensor or tracker; empty before its first message
  std::uint64_t samples = 0;  ///< pairs (target, instant) that counted
  int dimensions = 2;         ///< of the position
  double rmse = 0.0;          ///< over both channels [rad]
  double relative_rmse =
      0.0;  ///< over the stated sigma of the best sensor: the smallest root mean stated variance [1]
  double rate_rmse = 0.0;  ///< [rad/s]
  double anees_position = 0.0, anees_state = 0.0;
  double coverage = 0.0;  ///< share of the pairs (target, report) with a track
  std::uint32_t breaks = 0, id_switches = 0;
  std::uint64_t unmatched = 0;  ///< sightings, or established tracks in reports, of no target
  std::uint64_t unscored = 0;   ///< scans or reports for whose time no truth is known
  double stated_sigma = 0.0;    ///< of sightings, root mean variance of a channel [rad]
  GospaMeans gospa;             ///< of tracks
  int tracks_now = 0;           ///< established tracks in the last report
  Eigen::Vector2d angles_now = Eigen::Vector2d::Zero();  ///< of the first of them [rad]
  double error_now = 0.0;  ///< of the last scan or report that was scored, over channels and targets [rad]

  // Of tracks:
  double ospa = std::numeric_limits<double>::quiet_NaN();  ///< mean [rad]
  std::uint64_t tracks = 0;                                ///< established ones, by id
  std::uint64_t false_tracks = 0;  ///< of them, those on any target in less than half of their reports
  double scored_time = 0.0;        ///< time between reports, without silences over 2 s [s]
  double false_tracks_per_hour = std::numeric_limits<double>::quiet_NaN();  ///< of scored_time [1/h]
  double purity =
      std::numeric_limits<double>::quiet_NaN();  ///< share of a track's reports on its most usual target
  double completeness =
      std::numeric_limits<double>::quiet_NaN();  ///< share of a target's reports with its most usual track
  std::uint64_t appearances = 0;                 ///< times a target came, or came back
  std::uint64_t never_confirmed = 0;             ///< of them, those that never had a established track
  double confirm_median =
      std::numeric_limits<double>::quiet_NaN();  ///< appearance to first established track [s]
  double confirm_worst = std::numeric_limits<double>::quiet_NaN();  ///< [s]
};

/// One target's tracks on one topic: the fields of sightline/EvaluationTarget.
struct TargetRow {
  std::string topic;
  std::string name;  ///< tracker
  std::uint32_t target = 0;
  std::uint64_t samples = 0;  ///< reports in which it had a track
  int dimensions = 2;         ///< of the position
  double rmse = 0.0;          ///< over both channels [rad]
  double rate_rmse = 0.0;     ///< [rad/s]
  double anees_position = 0.0, anees_state = 0.0;
  double coverage = 0.0;  ///< share of the reports while it was there
  std::uint32_t breaks = 0, id_switches = 0;
};

/// Scores sightings and tracks against the truth as they arrive, in any order between topics. A message waits
/// until the truth covers its time. Only established tracks (confirmed or coasting) count. A figure without
/// samples is NaN.
///
/// A tracker is scored at the times of its reports, not in between.
class Evaluation {
 public:
  explicit Evaluation(const EvaluationParams& params = {}) : params_(params) {}

  /// All targets that exist at `time`, by id: (azimuth, elevation, azimuth_rate, elevation_rate) [rad,
  /// rad/s]. A time further back than the memory means that time jumped back: the truth and the identities
  /// are forgotten, the figures are kept.
  void addTruth(Time time, const std::map<std::uint32_t, Eigen::Vector4d>& motions);

  /// Adds a row for the topic, even if no message arrives on it.
  void expectSightings(const std::string& topic);
  void expectTracks(const std::string& topic);

  /// Scores a scan in the tracking frame. Each sensor of a topic has a row.
  void addScan(const std::string& topic, Scan scan_tracking);

  void addTracks(const std::string& topic, TrackReport report);

  /// Sightings first, then local tracks, then fused ones; each in the order of appearance.
  std::vector<EvaluationRow> rows() const;

  /// A line for each topic of tracks and each target that was there, in the order of rows() and by id.
  std::vector<TargetRow> targetRows() const;

  /// Stated sigma of the best sensor [rad]; NaN without sightings.
  double bestSigma() const;

  /// Time of the newest message that was scored; nullopt without one.
  std::optional<Time> lastScored() const { return last_scored_; }

  /// The listener is called for everything that is scored from now on.
  void listen(ScoreListener listener) { listener_ = std::move(listener); }

 private:
  template <typename Score, typename Message>
  struct Topic {
    Score score;
    std::deque<Message> waiting;  // for the truth of their time
    std::uint64_t unscored = 0;   // messages for whose time no truth is known
  };
  using SightingTopic = Topic<SightingScore, Scan>;
  using TrackTopic = Topic<TrackScore, TrackReport>;

  SightingTopic& sightingTopic(const std::string& topic, const std::string& sensor);
  TrackTopic& trackTopic(const std::string& topic);

  template <typename Score, typename Message>
  void await(Topic<Score, Message>& topic, Message message);
  template <typename Score, typename Message>
  void scoreReady(Topic<Score, Message>& topic);
  void score(SightingTopic& topic, const Scan& scan);
  void score(TrackTopic& topic, const TrackReport& report);

  void forgetTruth();
  std::vector<TrueTarget> targetsAt(Time time) const;
  double matchGate() const;
  std::vector<const TrackScore*> trackScores() const;  // local ones first

  EvaluationParams params_;
  ScoreListener listener_;
  std::map<std::uint32_t, TruthPath> truth_;
  std::optional<Time> oldest_truth_, newest_truth_;
  std::optional<Time> last_scored_;
  std::deque<SightingTopic> sighting_topics_;  // in order of appearance; references stay valid
  std::deque<TrackTopic> track_topics_;
};

}  // namespace sightline::core
