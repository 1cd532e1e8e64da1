#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include <Eigen/Core>

#include "sightline/core/association/association.h"
#include "sightline/core/model/sighting.h"
#include "sightline/core/model/time.h"
#include "sightline/core/sensors/clock_offset.h"
#include "sightline/core/sensors/sensor_health.h"

namespace sightline::core {

/// The guard against faulty sensors (section 5.1), over all sensors of a tracker.
struct GuardParams {
  bool enabled = true;
  SensorHealthParams health;
  ClockOffsetParams clock;
  double roll_back = 1.5;  ///< how far back after an alarm a sensor's scans are processed again [s], >= 0
  double support = 2.5;    ///< silence after which a sensor no longer corroborates a track [s], > 0
  double reach =
      100.0;  ///< distance from a track up to which an unassociated sighting may be its own [sigma], > 0

  friend bool operator==(const GuardParams& a, const GuardParams& b) {
    return std::tie(a.enabled, a.health, a.clock, a.roll_back, a.support, a.reach) ==
           std::tie(b.enabled, b.health, b.clock, b.roll_back, b.support, b.reach);
  }
};

/// The guard's verdict on one sensor.
struct WatchedSensor {
  std::string sensor;
  SensorVerdict verdict = SensorVerdict::healthy;
  bool undecided =
      false;  ///< only one other sensor sees its targets: either may be to blame, nothing is done
  double noise_scale = 1.0;          ///< factor on the stated variances of sightings that are used
  bool is_excluded = false;          ///< its sightings are not used
  std::optional<ClockOffset> clock;  ///< by how much its clock is behind the others', where that is certain
  bool clock_undecided = false;      ///< of two clocks that differ, either may be wrong
  std::optional<HealthChange> last;  ///< the last change of the verdict
};

/// A change of a sensor's verdict.
struct SensorChange {
  std::string sensor;
  HealthChange change;
  bool undecided = false;
};

/// How far a track corroborates a sensor's sightings.
struct Corroboration {
  bool has_sensor = false;  ///< the sensor itself gave it sightings lately
  int others = 0;           ///< further sensors that gave it sightings lately and are in use
  Eigen::Vector2d shared =
      Eigen::Vector2d::Zero();  ///< signed median of their mean innovations, lately [rad]
};

/// The median, and zero where the two in the middle are of different signs: what most agree on. Sorts the
/// values.
double signedMedian(double* values, int count);

/// Watches the sensors of one tracker. Plain state: it is copied with the tracker's state and rolled
/// back with it.
class SensorGuard {
 public:
  /// Throws std::invalid_argument for parameters out of range.
  explicit SensorGuard(const GuardParams& params);

  /// Judges by the thresholds and releases of these from now on: those that may change by `fixedGuardField`.
  void setThresholds(const SensorHealthParams& health);

  /// How the sightings of a sensor are to be used: as stated while it is healthy.
  SensorUse useOf(const std::string& sensor) const;

  /// Whether any sensor is not used as it states.
  bool holdsAnything() const;

  bool isExcluded(const std::string& sensor) const { return useOf(sensor).is_excluded; }

  /// Mean square by which the sensor's stamps are off [s^2]; zero while its clock is not known to be wrong,
  /// and while it may as well be the only other one's.
  double clockVariance(const std::string& sensor) const;

  /// Whether a sensor that has been silent for so long [s] can still corroborate others.
  bool mayCorroborate(const std::string& sensor, double silence) const {
    return sees(silence) && !isExcluded(sensor);
  }

  /// Whether a sensor that has been silent for so long [s] still sees a track.
  bool sees(double silence) const { return silence <= params_.support; }

  /// Whether a sighting of a biased sensor is where a sighting of the track would be, given the bias.
  bool isExplainedByBias(const std::string& sensor, const TrackPrediction& prediction,
                         const Sighting& sighting) const;

  /// Takes a scan against what the tracks expected; `corroboration` for each prediction. Nothing is judged
  /// yet.
  void watch(const Scan& scan, const std::vector<TrackPrediction>& predictions,
             const AssociationResult& result, const std::vector<Corroboration>& corroboration);

  /// The change of the sensor's verdict by its scans up to `time`, if it changes.
  std::optional<SensorChange> judge(Time time, const std::string& sensor);

  /// Takes the verdict on the sensor back, as another one turned out to be to blame, and watches it anew.
  void clearVerdict(Time time, const std::string& sensor);

  /// Takes over from `later` what it knows of the sensors whose verdict changed at or after `since`.
  void adopt(const SensorGuard& later, Time since);

  /// Whether the verdict of the sensor changed at or after `since`.
  bool changedSince(const std::string& sensor, Time since) const;

  std::vector<WatchedSensor> sensors() const;

 private:
  struct Watch {
    Watch(const std::string& name, const GuardParams& params, Time since)
        : sensor(name), health(params.health, since), clock(params.clock, since) {}

    std::string sensor;
    SensorHealth health;
    ClockWatch clock;
    std::optional<ClockOffset> wrong_clock = std::nullopt;
    bool clock_undecided = false;
    bool decides = false;    // whether there were others enough to find who is to blame, at the last scan
    bool undecided = false;  // the present verdict
    Time last_compared{};    // when it could be compared with others, last
    double clutter = 0.0;    // mean number of unassociated sightings in reach of a track that has its own
    int scans = 0;           // of which that is the mean
  };

  static bool isExplainedByBias(const SensorHealth& health, const Innovation& innovation);
  std::size_t placeOf(const std::string& sensor) const;
  const Watch* find(const std::string& sensor) const;
  Watch* findOrStart(const std::string& sensor, Time time);
  void compareClocks(Time time);

  GuardParams params_;
  std::vector<Watch> watches_;  // by name
  Time clocks_compared_{};
};

}  // namespace sightline::core
