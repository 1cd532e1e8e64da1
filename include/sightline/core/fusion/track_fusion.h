#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "sightline/core/fusion/contributors.h"
#include "sightline/core/fusion/fusion_report.h"
#include "sightline/core/fusion/global_track.h"
#include "sightline/core/fusion/local_reports.h"
#include "sightline/core/fusion/rules/fusion_rules.h"
#include "sightline/core/fusion/supporter_assignment.h"
#include "sightline/core/fusion/tracker_misalignment.h"
#include "sightline/core/fusion/tracklets/tracklet_fusion.h"
#include "sightline/core/fusion/tracklets/tracklet_memory.h"
#include "sightline/core/model/time.h"

namespace sightline::core {

struct TrackFusionParams {
  FusionRule rule = FusionRule::best;
  IntersectionWeights intersection_weights =
      IntersectionWeights::determinant;  ///< for covariance_intersection

  /// Probability that two tracks of one target are recognised as such, if their covariances are right, in (0,
  /// 1).
  double gate_probability = 0.999;
  double leave_factor = 2.0;        ///< a supporter contradicts at this many times the gate's threshold, >= 1
  double leave_after = 0.5;         ///< a supporter that contradicts for so long goes [s], >= 0
  double registration_sigma = 0.0;  ///< misalignment between trackers to allow for in the gate [rad], >= 0;
                                    ///< what many targets show of it is allowed for beyond

  /// Density of white angular acceleration for predictions to the common time and for cross_covariance
  /// [rad^2/s^3], >= 0; 0 = what each local track's covariance implies.
  double process_noise = 0.0;

  double coasting_age = 0.5;  ///< a coasting local track counts so long after its last sighting [s], >= 0
  /// A global track that no tracker reports any more is not shown. A new local track may go on with it for so
  /// long [s], >= 0 ...
  double delete_after = 1.0;
  double remember =
      5.0;  ///< ... and a local track that it had and that returns under its id, for so long [s]
  bool allow_shared_sensors = false;  ///< fuse local tracks that list a sensor in common as if they did not
  int max_tracks = 256;               ///< no global track is started beyond, >= 1
  LocalReportsParams reports;
  TrackletFusionParams tracklets;
};

/// Fuses the tracks of several local trackers into global ones. All trackers must report in the same frame,
/// as seen from the same point.
///
/// A global track is the fusion of its supporters - at most one local track of each tracker - at the newest
/// stamp reported, and never fed back. Who supports whom is remembered. With the rule `tracklets` its state
/// is that of an estimator of its own, run over all that its supporters' sensors have sighted; with the
/// others it is made of their states, and not filtered over time. With tracklets the sensors are watched:
/// what one of them said since its noise grew or it was off to one side counts less or not at all, and it
/// stays a supporter. `best` takes tracklets where they are complete, or else cross_covariance, or
/// covariance_intersection where sensors are not named. A supporter that contradicts the others taken
/// together (not itself included) by more than `leave_factor` gates is left out, the worst first, and goes if
/// that lasts for `leave_after`; everybody else is assigned to the nearest within the gate. Confirmed tracks
/// that belong nowhere start a global track; two global tracks that turn out to be one become the older.
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

  /// Takes a report and fuses. Never throws for what is in it; at most one report of a tracker is remembered.
  FusionReport onReport(const LocalReport& report);

  /// Takes tracklets of a local tracker, for the fusions that follow; best before its tracks of the same
  /// stamp. Returns why they were refused ("kind: details"), or nothing.
  std::string onTracklets(const TrackletReport& report);

  /// Tracklets that came too late to be used.
  std::size_t lateTracklets() const { return late_tracklets_; }

  /// Forgets all reports and tracks; ids go on.
  void reset();

 private:
  /// A global track and what was last said of it.
  struct Entry {
    GlobalTrack track;
    TrackletFusion tracklets;
    FusedTrack report;
    std::vector<std::pair<LocalKey, std::uint32_t>> former;  // local tracks that it had, with their hits then
  };

  /// A global track's new state, in its chart, and who made it.
  struct Outcome {
    FusionRule rule;
    Contributors choice;
    AngularState state;
    std::vector<double> shares;  // of choice.used
  };

  /// A local track without a global one, or (without key) a global track: something to be assigned.
  struct Row {
    std::optional<LocalKey> key;
    std::size_t entry = 0;
    AngularState state_tracking;
    Time time;
  };

  void follow(const std::string& reporting);
  void learnMisalignment(const std::string& reporting);
  void separate(const std::string& reporting);
  void rearrange(const std::string& tracker);
  std::vector<SupporterMove> misplacedOf(const std::string& tracker);
  void move(const std::vector<SupporterMove>& movers);
  void associate(const std::string& tracker, bool merge);
  Eigen::MatrixXd costs(const std::vector<Row>& rows, const std::vector<std::size_t>& columns,
                        double& cost_alone) const;
  double sigmaOf(const Row& row) const;
  bool areNear(const GlobalTrack& a, const GlobalTrack& b) const;
  bool isFarAway(const Row& row, const Eigen::Vector2d& place, const Estimate<4>& opinion) const;
  void unite(const std::vector<std::pair<std::size_t, std::size_t>>& pairs);
  void erase(const std::vector<std::uint32_t>& ids);
  void start(const LocalKey& key);
  void fuse(Entry& entry, const std::string& reporting);
  void feedTracklets(Entry& entry);
  void leaveOutBiased(Entry& entry) const;
  bool usesTracklets() const;
  std::optional<Outcome> fromTracklets(Entry& entry);
  Outcome fromTracks(const Entry& entry) const;
  std::optional<FusedEstimate<4>> combine(FusionRule rule, const GlobalTrack& track,
                                          const std::vector<std::size_t>& used) const;
  void leave(Entry& entry, std::size_t supporter) const;
  void dropSilent();
  FusionReport describe() const;
  FusionReport refused(const LocalReport& report, const std::string& why) const;

  std::string whyUnusable(const std::string& tracker, const LocalTrack& local) const;
  std::vector<std::uint32_t> supportersOf(const std::string& tracker) const;
  std::vector<Row> freeTracksOf(const std::string& tracker) const;

  TrackFusionParams params_;
  double join_threshold_;  // of distances squared
  LocalReports reports_;
  TrackerMisalignment misalignment_;
  TrackletMemory tracklets_;
  std::size_t late_tracklets_ = 0;
  Time time_{};
  std::uint32_t next_id_ = 1;
  std::vector<Entry> entries_;                 // ascending id
  std::map<LocalKey, std::uint32_t> waiting_;  // free tracks for a place that another still has: whose
  FusionReport latest_;
};

}  // namespace sightline::core
