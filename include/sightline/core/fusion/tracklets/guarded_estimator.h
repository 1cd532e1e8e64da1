#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sightline/core/estimators/charted_estimator.h"
#include "sightline/core/estimators/estimators.h"
#include "sightline/core/model/sphere.h"
#include "sightline/core/model/time.h"
#include "sightline/core/model/tracklet.h"
#include "sightline/core/ordering/timeline.h"
#include "sightline/core/sensors/sensor_changes.h"
#include "sightline/core/sensors/sensor_guard.h"

namespace sightline::core {

/// An estimator that is given tracklets of several sensors in order of time, and watches those sensors: on an
/// alarm (section 5.1) it rolls back to when the change began and takes what came since with that knowledge.
/// As a sensor that is off pulls the estimate with it and makes the others look wrong, the one is blamed
/// without which all that was seen since is the likeliest. Plain state: what it is depends on what it was
/// given and on nothing else. Copies are independent.
class GuardedEstimator {
 public:
  /// Gives a tracklet that was taken before, so many takes ago; 1 = the last one.
  using Past = std::function<const Tracklet&(std::size_t back)>;

  /// `keep`: for how long it is to remember how much each tracklet counted, beyond what going back needs [s].
  /// Throws std::invalid_argument for parameters out of range.
  GuardedEstimator(const EstimatorParams& estimator, const GuardParams& guard, double keep);

  GuardedEstimator(const GuardedEstimator&) = default;
  GuardedEstimator(GuardedEstimator&&) = default;
  GuardedEstimator& operator=(GuardedEstimator&&) = default;
  GuardedEstimator& operator=(const GuardedEstimator&) = delete;
  ~GuardedEstimator() = default;

  /// Judges by these thresholds from the next tracklet on; never null.
  void setThresholds(const std::shared_ptr<const SensorHealthParams>& health);

  /// Takes the next tracklet, not older than the last. `past` must reach back over `reach()` tracklets.
  void take(const Tracklet& next, const Past& past);

  /// Motion expected at `time`, in the tracking frame's angles; nullopt before the first tracklet.
  std::optional<AngularState> stateAt(Time time) const;

  /// How the tracklet taken so many takes ago was used.
  SensorUse useOf(std::size_t back) const;

  /// How many of the tracklets taken may be needed again.
  std::size_t reach() const { return taken_.next(); }

  /// Verdicts on the sensors of the last tracklets that were compared with others.
  std::vector<WatchedSensor> sensors() const;

  /// Whether any sensor is not used as it states.
  bool holdsAnything() const { return state_.guard.holdsAnything(); }

  /// Whether enough sensors are in use to tell which of them is to blame.
  bool decides() const;

  /// The last changes of a sensor's verdict, oldest first.
  const std::vector<SensorChange>& changes() const { return changes_; }

 private:
  struct Settings {
    EstimatorParams estimator;
    GuardParams guard;
  };
  struct Seen {
    std::string sensor;
    Time last_sighting;
    Eigen::Vector2d innovation = Eigen::Vector2d::Zero();  // mean of the last ones, in the chart [rad]
  };
  /// What a tracklet changes.
  struct State {
    std::optional<ChartedEstimator> estimator;
    SensorGuard guard;
    std::vector<Seen> seen;
    std::size_t taken = 0;  // tracklets
    Time last{};            // of them
  };
  /// When a tracklet was taken; the tracklet itself is the owner's (Past).
  struct Instant {
    Time time;

    friend Time timeOf(const Instant& instant) { return instant.time; }
    friend bool precedes(const Instant& a, const Instant& b) { return a.time < b.time; }
  };

  void keepState();
  void watch(const Tracklet& tracklet);
  Time rollBackTo(const SensorChange& change) const;
  bool isToBlame(const SensorChange& change, const Past& past) const;
  double evidenceAgainst(const std::string& sensor, Time began, const Past& past) const;
  void rollBack(const SensorChange& change, const Past& past);
  void see(const Tracklet& tracklet);
  void update(const Tracklet& tracklet, const SensorUse& use);
  Corroboration corroborationOf(const Tracklet& tracklet) const;

  std::shared_ptr<const Settings> settings_;
  std::shared_ptr<const SensorHealthParams> thresholds_;  // null: those of the settings
  State state_;
  std::vector<SensorChange> changes_;
  Timeline<Instant, SensorUse, State> taken_;  // empty while the guard is off
};

}  // namespace sightline::core
