#pragma once

#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "sightline/core/evaluation/scores.h"
#include "sightline/core/evaluation/truth.h"

namespace sightline::core {

struct EvaluationParams {
  double settle_time = 0.0;    ///< first seconds of each target, in which nothing counts [s]; >= 0
  double truth_gap = 2.0;      ///< between samples further apart, a target is not there [s]; > 0
  double truth_memory = 10.0;  ///< how far back the truth is kept, for late scans [s]; > truth_gap
  double match_gate = 0.0;     ///< largest distance of a target's track [rad]; 0 = ten stated sigmas of the
                               ///< coarsest sensor, 0.1 rad before any sighting
  double sighting_gate = 6.0;  ///< largest distance of a target's sighting, in stated sigmas; > 0
  double sighting_gate_floor = 0.0;  ///< distance [rad] within which a sighting is a target's anyway; >= 0
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
  std::uint64_t unmatched = 0;  ///< sightings, or believed tracks in reports, of no target
  std::uint64_t unjudged = 0;   ///< scans or reports for whose time no truth is known
  double stated_sigma = 0.0;    ///< of sightings, root mean variance of a channel [rad]
  GospaMeans gospa;             ///< of tracks
  int tracks_now = 0;           ///< believed tracks in the last report
  Eigen::Vector2d angles_now = Eigen::Vector2d::Zero();  ///< of the first of them [rad]
  double error_now = 0.0;  ///< of the last scan or report that was judged, over channels and targets [rad]

  // Of tracks:
  double ospa = std::numeric_limits<double>::quiet_NaN();  ///< mean [rad]
  std::uint64_t tracks = 0;                                ///< believed ones, by id
  std::uint64_t false_tracks = 0;  ///< of them, those on any target in less than half of their reports
  double judged_time = 0.0;        ///< between reports [s]; without silences over 2 s
  double false_tracks_per_hour = std::numeric_limits<double>::quiet_NaN();  ///< of judged_time [1/h]
  double purity =
      std::numeric_limits<double>::quiet_NaN();  ///< share of a track's reports on its most usual target
  double completeness =
      std::numeric_limits<double>::quiet_NaN();  ///< share of a target's reports with its most usual track
  std::uint64_t appearances = 0;                 ///< times a target came, or came back
  std::uint64_t never_confirmed = 0;             ///< of them, those that never had a believed track
  double confirm_median =
      std::numeric_limits<double>::quiet_NaN();  ///< appearance to first believed track [s]
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

/// Compares sightings and tracks with the truth as they come, in any order between topics. What is not yet
/// bracketed by the truth waits. Only believed tracks (confirmed or coasting) count. NaN stands for what
/// there is no sample of.
///
/// Instants: a tracker is asked for its targets whenever it reports, not in between.
class Evaluation {
 public:
  explicit Evaluation(const EvaluationParams& params = {}) : params_(params) {}

  /// All targets that there are at `time`, by id. A time further back than the memory means that time has
  /// jumped: what was kept of the truth and of identities is forgotten, what counted stays.
  void addTruth(Time time, const std::map<std::uint32_t, Eigen::Vector4d>& motions);

  /// A topic of which a line shall appear even if nothing comes.
  void expectSightings(const std::string& topic);
  void expectTracks(const std::string& topic);

  /// A scan, in the tracking frame; a line for each sensor of a topic.
  void addScan(const std::string& topic, Scan scan_tracking);

  void addTracks(const std::string& topic, TrackReport report);

  /// Sightings first, then local tracks, then fused ones; each in the order of appearance.
  std::vector<EvaluationRow> rows() const;

  /// A line for each topic of tracks and each target that was there, in the order of rows() and by id.
  std::vector<TargetRow> targetRows() const;

  /// Stated sigma of the best sensor [rad]; NaN without sightings.
  double bestSigma() const;

  /// Time of the newest message that was compared; nullopt without one.
  std::optional<Time> lastJudged() const { return last_judged_; }

  void listen(ScoreListener listener) { listener_ = std::move(listener); }

 private:
  template <typename Score, typename Message>
  struct Topic {
    Score score;
    std::deque<Message> waiting;
    std::uint64_t unjudged = 0;
  };
  using SightingTopic = Topic<SightingScore, Scan>;
  using TrackTopic = Topic<TrackScore, TrackReport>;

  SightingTopic& sightingTopic(const std::string& topic, const std::string& sensor);
  TrackTopic& trackTopic(const std::string& topic);

  template <typename Score, typename Message>
  void await(Topic<Score, Message>& topic, Message message);
  template <typename Score, typename Message>
  void judgeReady(Topic<Score, Message>& topic);
  void judge(SightingTopic& topic, const Scan& scan);
  void judge(TrackTopic& topic, const TrackReport& report);

  void forgetTruth();
  std::vector<TrueTarget> targetsAt(Time time) const;
  double matchGate() const;
  std::vector<const TrackScore*> trackScores() const;  // local ones first

  EvaluationParams params_;
  ScoreListener listener_;
  std::map<std::uint32_t, TruthPath> truth_;
  std::optional<Time> oldest_truth_, newest_truth_;
  std::optional<Time> last_judged_;
  std::deque<SightingTopic> sighting_topics_;  // in order of appearance; references stay valid
  std::deque<TrackTopic> track_topics_;
};

}  // namespace sightline::core
