#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "sightline/core/fusion/association/tracker_misalignment.h"
#include "sightline/core/fusion/reports/local_reports.h"
#include "sightline/core/fusion/reports/reported_states.h"
#include "sightline/core/fusion/rules/cross_covariance.h"
#include "sightline/core/fusion/rules/fusion_rules.h"
#include "sightline/core/model/chart.h"
#include "sightline/core/model/refusal.h"
#include "sightline/core/model/time.h"
#include "sightline/core/model/track.h"

namespace sightline::core {

/// A local track as a supporter of a global one.
struct Supporter {
  LocalKey key;
  LocalTrack local;       ///< as last reported in a usable form, in the tracking frame
  ReportedStates former;  ///< reported before that
  AngularState state;     ///< the same in the global track's chart, predicted to its time
  Eigen::Vector2d density = Eigen::Vector2d::Zero();  ///< of white acceleration, for predictions [rad^2/s^3]
  std::optional<Refusal> unusable;        ///< why it does not count at the moment; nullopt when it does
  bool contributed = false;               ///< to the last fusion
  std::optional<Time> contradicts_since;  ///< when it began to contradict the others
  std::optional<Time> misplaced_since;    ///< when another place began to be better for it, or it for another
  /// From the other usable supporters taken together, at the last look [1]; NaN = there are none.
  double distance_squared = std::numeric_limits<double>::quiet_NaN();
};

/// One target, as the local tracks that support it: brought to a common time in a common chart, with the
/// cross-covariances of their errors. It has no state of its own that is filtered over time; the last fused
/// estimate is predicted only to bridge times without any support.
class GlobalTrack {
 public:
  /// `process_noise`: density for all predictions [rad^2/s^3]; 0 = what each track's covariance implies.
  GlobalTrack(std::uint32_t id, Time time, const LocalKey& key, const LocalTrack& local,
              double process_noise);

  std::uint32_t id() const { return id_; }
  const Chart& chart() const { return chart_; }
  const std::vector<Supporter>& supporters() const { return supporters_; }
  bool hasTracker(const std::string& tracker) const;
  std::size_t numberOf(const std::string& tracker) const;  ///< of its supporter, one past the last if none
  bool hasAnyTrackerOf(const GlobalTrack& other) const;

  /// Predicts everything to `time`, not before the last.
  void advance(Time time);

  /// A further supporter; it takes part from now on.
  void join(const LocalKey& key, const LocalTrack& local);

  /// The supporter's tracker has sent a new report, with this in it. Gives the normalised distance squared
  /// between what was expected of the track and what came.
  double renew(std::size_t supporter, const LocalTrack& local);

  void leave(std::size_t supporter);

  /// Whether the supporter is in the right place; if not, since when is remembered, and returned.
  std::optional<Time> setMisplaced(std::size_t supporter, bool is_misplaced);

  /// Says that the supporter does not count at the moment, or (nullopt) that it does.
  void setUnusable(std::size_t supporter, std::optional<Refusal> why);

  /// Takes over all supporters of another track at the same time; no tracker may be in both.
  void absorb(const GlobalTrack& other);

  /// What a supporter says at this track's time, in this chart: its state, and how far it may be off by the
  /// acceleration that it has shown until it was reported.
  Estimate<4> estimateOf(std::size_t supporter) const;

  /// Computes every usable supporter's distance from the others taken together. `registration`: errors
  /// in the alignment between trackers to allow for.
  void compareSupporters(const TrackerMisalignment& registration);

  /// The same; and those farther from the others than `threshold` [1] do not count, the worst first (of two,
  /// the one whose report is older, else the one that came later), until the rest agree; if that would be
  /// less than half of them, nobody is right and all count. Returns their numbers, ascending. Since when a
  /// supporter contradicts is remembered until it agrees in a new report of its own, as a prediction agrees
  /// the easier the older it is. One that agrees with what the others said at the time of its report does not
  /// count either as long as its prediction is wrong (late), but does not contradict.
  std::vector<std::size_t> leaveOutContradictions(const TrackerMisalignment& registration, double threshold,
                                                  const NewReports& new_reports);

  /// What all usable supporters say together (as if independent), or without any the predicted last estimate;
  /// in this chart.
  Estimate<4> opinion() const;

  /// What all usable supporters have said together of `past`, as near to that as each was reported, in this
  /// chart; nullopt when there are none.
  std::optional<Estimate<4>> opinionAt(Time past) const;

  /// The newest report of a usable supporter; nullopt when there are none.
  std::optional<Time> newestReport() const;

  /// What the usable supporters of other trackers say together; nullopt when there are none.
  std::optional<Estimate<4>> opinionWithout(const std::string& tracker) const;

  /// What a local track that need not be a supporter says of `time`, likewise.
  Estimate<4> estimateOf(const LocalTrack& local, Time time) const;

  /// The numbers of those supporters that count, in order.
  std::vector<std::size_t> usable() const;

  const CrossCovariance& crossCovariance() const { return cross_; }

  /// The outcome of a fusion: who contributed, and what came out, in this chart.
  void setFused(const std::vector<std::size_t>& contributors, const AngularState& fused);

  /// The last fused estimate predicted to the track's time, in this chart.
  const AngularState& state() const { return state_; }

  Time time() const { return time_; }
  Time lastFusion() const { return last_fusion_; }  ///< with at least one contributor

 private:
  Eigen::Vector2d densityOf(const Eigen::Matrix4d& covariance) const;
  AngularState aligned(const AngularState& state_tracking, Time from, Time to) const;
  Estimate<4> estimateAt(const ReportedState& reported, const Eigen::Vector3d& acceleration, Time time) const;
  Estimate<4> estimateAt(std::size_t supporter, Time past) const;
  std::optional<Time> newestReport(const std::vector<std::size_t>& supporters) const;
  std::optional<Estimate<4>> opinionAt(const std::vector<std::size_t>& supporters, Time past) const;
  bool agreesInThePast(std::size_t supporter, double registration_sigma, double threshold) const;
  Supporter supporterOf(const LocalKey& key, const LocalTrack& local) const;
  std::size_t doubtfulOf(std::size_t first, std::size_t second) const;
  void moveToChart(const Chart& chart);

  std::uint32_t id_;
  double process_noise_;
  Chart chart_;
  Time time_;
  Time last_fusion_;
  AngularState state_;
  Eigen::Vector2d density_;
  Eigen::Vector3d acceleration_ = Eigen::Vector3d::Zero();  // mean of the last contributors'
  std::vector<Supporter> supporters_;                       // in the order in which they joined
  CrossCovariance cross_;
};

/// Normalised distance squared between two estimates in one chart whose errors are taken as independent, with
/// `registration_sigma` [rad] of misalignment in each angle [1]; infinite where it is not determined.
double distanceSquared(const Estimate<4>& a, const Estimate<4>& b, double registration_sigma);

}  // namespace sightline::core
