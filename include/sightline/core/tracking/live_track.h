#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sightline/core/association/association.h"
#include "sightline/core/association/existence.h"
#include "sightline/core/association/gate.h"
#include "sightline/core/estimators/estimator.h"
#include "sightline/core/model/chart.h"
#include "sightline/core/model/sighting.h"
#include "sightline/core/model/track.h"
#include "sightline/core/sensors/sensor_guard.h"

namespace sightline::core {

/// When a track is born, believed, and given up.
///
/// A scan without a sighting of the target is a miss only if its sensor has seen the target before and looks
/// where it is; silence is never a miss. A limit on silence counts as at least four of the track's usual
/// intervals between sightings, so that one setting serves sensors of 1 Hz and of 100 Hz.
struct LifecycleParams {
  /// Whether the probability of existence decides; false: M sightings of N scans, and misses and silence.
  bool by_existence = true;
  int confirm_hits = 3;              ///< M: sightings that make a track believed, at least ...
  int confirm_scans = 6;             ///< N: ... and without existence within so many scans; 1 <= M <= N
  double confirm_existence = 0.999;  ///< probability of existence from which a track is believed, in (0, 1)
  double show_existence = 0.5;  ///< below it a believed track is not shown until it is seen again, in [0, 1)
  PresenceParams presence;      ///< how targets come and go
  int coast_misses = 3;         ///< misses in a row after which a track counts as coasting, >= 1
  double coast_silence = 0.3;   ///< silence after which it does [s], > 0
  int delete_misses = 30;       ///< misses in a row after which a track is lost, without existence, >= 1
  double delete_silence = 2.0;  ///< silence after which it is lost in any case [s], > 0
  /// Silence up to which a lost target is remembered, and goes on as the same track when it is seen within
  /// its gate or a new track agrees with its motion [s], >= 0
  double remember = 5.0;
  /// A believed track whose gate is so many times as wide as the sightings' own sigma would make it knows
  /// nothing and lives on false sightings: it is given up. > 1
  double max_spread = 30.0;
  /// Scans in a row in which two tracks at the same place with the same motion share the sightings of one
  /// target, after which the younger is given up, >= 1
  int merge_scans = 10;
};

constexpr std::uint32_t kMatureHits = 30;  // sightings of a track whose innovations tell of its sensors: a
                                           // false one does not live so long

/// One target under way: its estimator, the chart it works in, and the record on which it is judged. Copies
/// are deep.
class LiveTrack {
 public:
  /// A track started from one sighting (tracking frame) of a scan. `odds`: of a new target against a false
  /// sighting.
  LiveTrack(std::uint32_t id, const Scan& scan, const Sighting& sighting,
            std::unique_ptr<Estimator> estimator, double odds);

  LiveTrack(const LiveTrack& other);
  LiveTrack(LiveTrack&&) = default;
  LiveTrack& operator=(LiveTrack&&) = default;
  LiveTrack& operator=(const LiveTrack&) = delete;
  ~LiveTrack() = default;

  std::uint32_t id() const { return id_; }
  Time lastSighting() const { return last_sighting_; }
  bool isEstablished() const { return status_ != TrackStatus::tentative && !lost_; }
  bool isMature() const { return status_ == TrackStatus::confirmed && !lost_ && hits_ >= kMatureHits; }

  /// A target that was believed and is not any more; remembered, to be known again.
  bool isLost() const { return lost_; }

  /// What the track expects to see in a scan. Moves to a new chart when the target leaves the present one.
  /// `detection_probability`: the sensor's.
  TrackPrediction predict(const Scan& scan, double detection_probability, const LifecycleParams& lifecycle,
                          bool adapt_gate);

  /// Takes a sighting; `prediction` is that for the scan's time, `evidence` that of its pairing. `possible`:
  /// all sightings that may be the target's, with their probabilities; empty = this one alone.
  void take(const Scan& scan, const Sighting& sighting, const TrackPrediction& prediction,
            const std::vector<PossibleSighting>& possible, double evidence, const LifecycleParams& lifecycle);

  /// The scan has not shown the target: counts it, if its sensor is one that could have.
  void miss(const Scan& scan, const TrackPrediction& prediction, double evidence,
            const LifecycleParams& lifecycle);

  /// Whether its target may be the one that another track has just found: it is lost, or has been missed
  /// more than once.
  bool isMissing() const { return lost_ || (status_ != TrackStatus::tentative && misses_ >= 2); }

  /// ln of the density with which a target of this track, if it returns, has the motion of `fresh`
  /// [1/(rad^2 (rad/s)^2)]. Targets sometimes jump, where sightings stand still or a filter is too sure: one
  /// in twenty is allowed 25 times the distance.
  double logDensityOfReturn(const LiveTrack& fresh, Time time) const;

  /// Goes on as the track that a target had before it was lost.
  void resume(const LiveTrack& lost);

  /// How far the track can be a yardstick for a sensor at `time`.
  Corroboration corroborationOf(const std::string& sensor, Time time, const SensorGuard& guard) const;

  /// Whether the track is to be forgotten at `time`; otherwise its status is brought up to date.
  bool isDead(Time time, const LifecycleParams& lifecycle, bool adapt_gate);

  /// The track in the tracking frame's angles at `time`, with the gate for the sighting that comes next.
  Track report(Time time, const GateParams& gate, bool adapt_gate, const LifecycleParams& lifecycle) const;

 private:
  struct Source {
    std::string sensor;
    Time last_sighting;
    Eigen::Vector2d innovation = Eigen::Vector2d::Zero();  // mean of the last ones, in the chart [rad]
    double information = 0.0;                              // of its sightings, fading [1/rad^2]
    Eigen::Vector2d bias =
        Eigen::Vector2d::Zero();  // variance of its slowly varying error, in the chart [rad^2]
  };

  /// A sensor that has not seen the target lately.
  struct NonDetectingSensor {
    std::string sensor;
    double visibility = 0.5;  // probability that it could
  };

  Measurement measurementOf(const Scan& scan, const Sighting& sighting) const;
  void noteSource(const Scan& scan, const Eigen::Vector2d& innovation, const Eigen::Matrix2d& R);
  Eigen::Vector2d biasVariance(Time time) const;
  bool hasBeenSeenBy(const Scan& scan, const LifecycleParams& lifecycle) const;
  double visibilityFor(const Scan& scan) const;
  void noteNonDetection(const Scan& scan, double visibility);
  void weigh(Time time, double evidence, const LifecycleParams& lifecycle);
  void noteLook(bool is_seen);
  bool isConfirmedBy(const LifecycleParams& lifecycle) const;
  bool isDeadTentative(const LifecycleParams& lifecycle) const;
  const AngularState& stateAt(Time time) const;
  double limit(double silence) const;
  double gateScale(bool adapt_gate) const;

  std::uint32_t id_;
  TrackStatus status_ = TrackStatus::tentative;
  bool lost_ = false;  // was believed, and is not shown any more
  Existence existence_;
  Chart chart_;
  std::unique_ptr<Estimator> estimator_;
  mutable std::optional<Time> known_at_;  // for which ...
  mutable AngularState known_;            // ... the state has been asked, in the chart
  Eigen::Matrix2d last_covariance_;       // of the last sighting, in the chart [rad^2] ...
  double last_noise_scale_;               // ... and the factor on the stated one that it has in it
  Time last_sighting_;
  Time weighed_;                   // of `existence_`
  double interval_ = 0.0;          // usual time between sightings [s]; 0 = not known yet
  double innovation_scale_ = 1.0;  // running mean of d^2 / 2 with S as stated, 1 if S is right
  std::uint32_t hits_ = 1, misses_ = 0;
  int scans_ = 1;                     // that could have shown the target, since the start
  double looked_ = 0.0, seen_ = 0.0;  // the last ones of these, and how many of them did
  std::vector<Source> sources_;
  std::vector<NonDetectingSensor> non_detecting_;
};

}  // namespace sightline::core
