#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "sightline/core/estimators/estimators.h"
#include "sightline/core/fusion/global_track.h"
#include "sightline/core/fusion/reports/local_reports.h"
#include "sightline/core/fusion/tracklets/tracklet_memory.h"
#include "sightline/core/fusion/tracklets/tracklet_track.h"
#include "sightline/core/model/refusal.h"
#include "sightline/core/model/time.h"
#include "sightline/core/sensors/sensor_guard.h"

namespace sightline::core {

struct TrackletFusionParams {
  EstimatorParams estimator;  ///< of the global tracks
  double max_lag = 1.0;  ///< tracklets up to so much older than the newest are put in their place [s], > 0
  double memory = 1.0;   ///< time that counts for `max_missing` [s], > 0
  /// Share of what the sources have sighted within `memory` that may be lost before other rules have more
  /// information, in [0, 1].
  double max_missing = 0.25;
  GuardParams guard;  ///< of each global track's sensors
};

/// A global track's state from its supporters' tracklets. Each sensor's come from one supporter at a time, so
/// that a sensor that is in two local tracks counts once.
class TrackletFusion {
 public:
  explicit TrackletFusion(const TrackletFusionParams& params);

  /// Takes what is new in the tracklets of the supporter, up to its last report of tracks, with which it was
  /// found to support the target.
  void feed(const Supporter& supporter, const TrackletMemory& memory);

  /// The supporter's tracklets before then were of another target: they are never used.
  void passOver(const LocalKey& supporter, Time before, const TrackletMemory& memory);

  /// Takes the supporter's tracklets since then out again; a later `feed` may bring them back.
  void takeBack(const LocalKey& supporter, Time since);

  /// The supporter is gone: others may report for its sensors. Its tracklets stay.
  void leave(const LocalKey& supporter);

  /// Sensors are judged by these thresholds from their tracklets later than `after` on.
  void setThresholds(const SensorHealthParams& health, Time after) { track_.setThresholds(health, after); }

  /// Runs the estimator over all tracklets up to `time`. Times do not go back.
  void advanceTo(Time time) { track_.advanceTo(time); }

  /// Estimate from all tracklets up to `time`, to which it has been advanced, in the tracking frame; nullopt
  /// without any.
  std::optional<AngularState> stateAt(Time time) const { return track_.stateAt(time); }

  /// Each supporter's share in the information of the last moments, summing to one; of those that gave any.
  std::map<LocalKey, double> shares() const;

  /// Verdicts on the sensors of the last tracklets, by name.
  std::vector<WatchedSensor> sensors() const { return track_.sensors(); }

  /// Changes of verdicts that have not been reported yet.
  std::vector<SensorChange> newChanges() { return track_.newChanges(); }

  /// Whether a source that contradicts the others can be left to the guard.
  bool canTellWhoIsWrong() const { return track_.canTellWhoIsWrong(); }

  /// Why none of the supporter's tracklets is used (biased): all its sensors are off, by not so much that
  /// it must be another target. nullopt when they are used.
  std::optional<Refusal> exclusionOf(const LocalKey& supporter) const;

  /// By how much the variances of the supporter's track are to be taken larger, as its sensors are noisier
  /// than they state; >= 1.
  double noiseScale(const LocalKey& supporter) const;

  std::size_t late() const { return late_; }  ///< tracklets that came too late to be used

  /// Tracklets that the estimator could not take, and why.
  const TrackletFailures& failures() const { return track_.failures(); }

 private:
  struct Owner {
    LocalKey supporter;
    Time newest{};  ///< of its tracklets of the sensor
  };

  std::vector<WatchedSensor> sensorsOf(const LocalKey& supporter) const;
  bool reportsFor(const LocalKey& supporter, const Tracklet& tracklet);
  bool forgetOldestOwner(Time now);

  TrackletTrack track_;
  std::map<LocalKey, std::uint64_t> fed_;  // by supporter: number of the last tracklet taken
  std::map<std::string, Owner> owners_;    // by sensor, at most 256
  std::size_t late_ = 0;
};

/// Why the tracklets of these supporters are not good enough to rely on; nullopt when they are: everyone
/// sends them, up to date, and little was lost.
std::optional<Refusal> whyIncomplete(const std::vector<const Supporter*>& supporters,
                                     const TrackletMemory& memory, const TrackletFusionParams& params);

}  // namespace sightline::core
