#pragma once

#include <cstddef>
#include <optional>

#include "sightline/core/fusion/association/track_association.h"
#include "sightline/core/fusion/fusion_report.h"
#include "sightline/core/fusion/global_tracks.h"
#include "sightline/core/fusion/reports/local_reports.h"
#include "sightline/core/fusion/reports/report_rounds.h"
#include "sightline/core/fusion/track_combination.h"
#include "sightline/core/fusion/track_fusion_params.h"
#include "sightline/core/fusion/tracklets/tracklet_memory.h"
#include "sightline/core/model/refusal.h"
#include "sightline/core/model/tracklet.h"

namespace sightline::core {

/// Fuses the tracks of several local trackers into global ones. All trackers must report in the same frame,
/// as seen from the same point.
///
/// A global track is the fusion of its supporters - at most one local track of each tracker - at the newest
/// stamp reported, and never fed back. Reports are taken as they come and fused once a round of the trackers
/// (ReportRounds), so that the time it takes grows with the trackers and not with their square. Who supports
/// whom is remembered. With the rule `tracklets` its state is that of an estimator of its own, run over all
/// that its supporters' sensors have sighted; with the others it is made of their states, and not filtered
/// over time. With tracklets the sensors are watched: what one of them said since its noise grew or it was
/// off to one side counts less or not at all, and it stays a supporter. `best` takes tracklets where they are
/// complete, or else cross_covariance, or covariance_intersection where sensors are not named. A supporter
/// that contradicts the others taken together (not itself included) by more than `leave_factor` gates is left
/// out, the worst first, and goes if that lasts for `leave_after`; everybody else is assigned to the nearest
/// within the gate. Confirmed tracks that belong nowhere start a global track; two global tracks that turn
/// out to be one become the older.
///
/// Left out, with the reason: contradictions; tentative tracks; invalid states; reports older than `max_age`;
/// coasting tracks not seen for longer than `coasting_age`, unless nothing better is there (so that a global
/// track lives as long as a local one); tracks that share a sensor with a surer one, as the same sightings
/// would count twice, unless the rule is covariance_intersection, which holds for any correlation, or
/// tracklets, which tell sightings apart, or `allow_shared_sensors`. A tracker's own name counts as a sensor
/// of its, so that a fusion and what it was made of are not fused again.
class TrackFusion {
 public:
  /// Throws std::invalid_argument for parameters out of their range.
  explicit TrackFusion(const TrackFusionParams& params);

  /// Takes a report; `arrival`: when it came, by any clock that goes on by itself. Never throws for what is
  /// in it; at most one report of a tracker is remembered. Returns why it was refused, or nothing.
  std::optional<Refusal> take(const LocalReport& report, std::optional<Time> arrival = std::nullopt);

  /// Takes tracklets of a local tracker, for the fusions that follow; best before its tracks of the same
  /// stamp. Returns why they were refused, or nothing.
  std::optional<Refusal> onTracklets(const TrackletReport& report);

  /// Whether reports have been taken since the last fusion.
  bool hasNewReports() const { return !rounds_.isEmpty(); }

  /// Whether they should be fused now; else others are expected in a moment (`max_wait`).
  bool isDue() const { return rounds_.isDue(reports_); }

  /// Fuses all that has been taken.
  FusionReport fuse();

  /// Takes a report and fuses at once. What was refused is left out in what comes back, which is else as it
  /// was.
  FusionReport onReport(const LocalReport& report, std::optional<Time> arrival = std::nullopt);

  /// Goes on with other parameters from the next report on. Global tracks, their ids and their supporters
  /// stay; thresholds of the guard hold for tracklets later than the common time, late ones are judged by
  /// those that held at their time. A rule that uses tracklets after one that does not begins with those that
  /// come from then on. Returns why not (`whyNotInFlight` says what may change); then nothing has changed.
  std::optional<Refusal> reconfigure(const TrackFusionParams& wanted);

  const TrackFusionParams& params() const { return params_; }

  /// Tracklets that came too late to be used.
  std::size_t lateTracklets() const { return losses_.late; }

  /// Tracklets that an estimator could not take.
  const TrackletFailures& failedTracklets() const { return losses_.failed; }

  /// Forgets all reports and tracks; ids go on.
  void reset();

 private:
  TrackFusionParams params_;
  DistanceThresholds thresholds_;
  LocalReports reports_;
  ReportRounds rounds_;
  TrackletMemory tracklets_;
  GlobalTracks tracks_;
  TrackAssociation association_;
  TrackletLosses losses_;
};

}  // namespace sightline::core
