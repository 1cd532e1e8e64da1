#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "sightline/core/estimators/estimators.h"
#include "sightline/core/fusion/reports/local_reports.h"
#include "sightline/core/fusion/tracklets/guarded_estimator.h"
#include "sightline/core/model/sphere.h"
#include "sightline/core/model/time.h"
#include "sightline/core/model/tracklet.h"
#include "sightline/core/ordering/scan_order.h"
#include "sightline/core/ordering/settings_history.h"
#include "sightline/core/ordering/timeline.h"
#include "sightline/core/sensors/sensor_changes.h"
#include "sightline/core/sensors/sensor_guard.h"

namespace sightline::core {

/// Tracklets that an estimator could not take.
struct TrackletFailures {
  std::size_t count = 0;
  std::string latest;  ///< of which sensor, and why
};

/// One target as an estimator sees it that is given the tracklets of all its sources, each in its place in
/// time: for a late one it rolls back and runs again from there, so that the order of arrival changes
/// nothing, to the last bit. Its sensors are watched: the tracklets of one of them since it is noisy or
/// biased count less or not at all (section 5.1).
class TrackletTrack {
 public:
  /// `max_lag`: tracklets up to so much older than the newest are put in their place [s], >= 0.
  TrackletTrack(const EstimatorParams& estimator, double max_lag, const GuardParams& guard = {});

  /// Takes a tracklet of a local track, the `number`-th that its tracker reported. One that is here already
  /// is not taken again. False when it is too late.
  bool add(const LocalKey& source, std::uint64_t number, const Tracklet& tracklet);

  /// Takes out the tracklets of a source since then, as far back as `max_lag` allows. Returns the least
  /// number of those taken out.
  std::optional<std::uint64_t> remove(const LocalKey& source, Time since);

  /// Sensors are judged by these thresholds from their tracklets later than `after` on; one that comes late
  /// is judged, and those after it are again, by the thresholds that held at its time.
  void setThresholds(const SensorHealthParams& health, Time after);

  /// Runs the estimator over the tracklets up to `time`. Times do not go back. A tracklet that the estimator
  /// cannot take (it throws) is dropped, and the estimator goes on from the state before it.
  void advanceTo(Time time);

  /// Estimate from the tracklets up to `time`, to which it has been advanced, in the tracking frame; nullopt
  /// before the first.
  std::optional<AngularState> stateAt(Time time) const;

  /// Tracklets that the estimator could not take.
  const TrackletFailures& failures() const { return failures_; }

  /// How much information each source has given since `max_lag` ago, as it was used [1/rad^2].
  std::map<LocalKey, double> informationBySource() const;

  /// Verdicts on the sensors of the last tracklets.
  std::vector<WatchedSensor> sensors() const { return estimator_.sensors(); }

  /// Whether any sensor is not used as it states.
  bool holdsAnything() const { return estimator_.holdsAnything(); }

  /// Whether enough sensors are in use to tell which of them is to blame for a disagreement.
  bool canTellWhoIsWrong() const { return estimator_.decides(); }

  /// Changes of verdicts that have not been reported yet.
  std::vector<SensorChange> newChanges() { return reporter_.unreported(estimator_.changes()); }

 private:
  /// What a source reported. How it is used is the estimator's knowledge.
  struct Report {
    LocalKey source;
    std::uint64_t number = 0;
    Tracklet tracklet;

    friend Time timeOf(const Report& report) { return report.tracklet.time; }
    friend bool precedes(const Report& a, const Report& b) { return precedes(a.tracklet, b.tracklet); }
  };
  struct NoUse {};

  void processNext();
  void dropNext(const std::string& why);
  void forgetOld();

  SettingsHistory<SensorHealthParams> thresholds_;
  Timeline<Report, NoUse, GuardedEstimator> reports_;
  GuardedEstimator estimator_;  // has taken the reports before the timeline's next
  std::optional<Time> closed_;  // before this nothing can be put any more
  SensorChangeReporter reporter_;
  TrackletFailures failures_;
};

}  // namespace sightline::core
