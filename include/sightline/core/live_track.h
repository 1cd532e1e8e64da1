#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "sightline/core/association.h"
#include "sightline/core/chart.h"
#include "sightline/core/estimator.h"
#include "sightline/core/gate.h"
#include "sightline/core/sensor_guard.h"
#include "sightline/core/sighting.h"
#include "sightline/core/track.h"

namespace sightline::core {

/// When a track is born, believed, and given up.
///
/// A scan without a sighting of the target is a miss only if its sensor has seen the target before; silence
/// is never a miss. A limit on silence counts as at least four of the track's usual intervals between
/// sightings, so that one setting serves sensors of 1 Hz and of 100 Hz.
struct LifecycleParams {
  int confirm_hits = 4;         ///< M: sightings that make a track believed ...
  int confirm_scans = 6;        ///< N: ... within so many scans; 1 <= M <= N
  int coast_misses = 3;         ///< misses in a row after which a track counts as coasting, >= 1
  double coast_silence = 0.3;   ///< silence after which it does [s], > 0
  int delete_misses = 30;       ///< misses in a row after which it is given up, >= 1
  double delete_silence = 2.0;  ///< silence after which it is given up [s], > 0
  /// A believed track whose gate is so many times as wide as the sightings' own sigma would make it knows
  /// nothing and lives on false sightings: it is given up. > 1
  double max_spread = 30.0;
};

constexpr std::uint32_t kSettledHits = 30;  // sightings of a track whose innovations tell of its sensors: a
                                            // false one does not live so long

/// One target under way: its estimator, the chart it works in, and the record on which it is judged. Copies
/// are deep.
class LiveTrack {
 public:
  /// A track started from one sighting (tracking frame) of a scan.
  LiveTrack(std::uint32_t id, const Scan& scan, const Sighting& sighting,
            std::unique_ptr<Estimator> estimator);

  LiveTrack(const LiveTrack& other);
  LiveTrack(LiveTrack&&) = default;
  LiveTrack& operator=(LiveTrack&&) = default;
  LiveTrack& operator=(const LiveTrack&) = delete;
  ~LiveTrack() = default;

  std::uint32_t id() const { return id_; }
  bool isSettled() const { return status_ == TrackStatus::confirmed && hits_ >= kSettledHits; }

  /// What the track expects to see at `time`. Moves to a new chart when the target leaves the present one.
  Expectation expect(Time time, bool adapt_gate);

  /// Takes a sighting; `expectation` is that for the scan's time.
  void take(const Scan& scan, const Sighting& sighting, const Expectation& expectation,
            const LifecycleParams& lifecycle);

  /// Counts a scan in which the target was not seen, if its sensor is one that sees the target.
  void miss(const Scan& scan, const LifecycleParams& lifecycle);

  /// How far the track can be a yardstick for a sensor at `time`.
  Vouching vouchingFor(const std::string& sensor, Time time, const SensorGuard& guard) const;

  /// Whether the track is to be given up at `time`; otherwise its status is brought up to date.
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

  Measurement measurementOf(const Scan& scan, const Sighting& sighting) const;
  void noteSource(const Scan& scan, const Eigen::Vector2d& innovation, const Eigen::Matrix2d& R);
  Eigen::Vector2d biasVariance(Time time) const;
  double limit(double silence) const;
  double gateScale(bool adapt_gate) const;

  std::uint32_t id_;
  TrackStatus status_ = TrackStatus::tentative;
  Chart chart_;
  std::unique_ptr<Estimator> estimator_;
  Eigen::Matrix2d last_covariance_;  // of the last sighting, in the chart [rad^2]
  Time last_sighting_;
  double interval_ = 0.0;          // usual time between sightings [s]; 0 = not known yet
  double innovation_scale_ = 1.0;  // running mean of d^2 / 2 with S as stated, 1 if S is right
  std::uint32_t hits_ = 1, misses_ = 0;
  int scans_ = 1;  // that could have shown the target, since the start
  std::vector<Source> sources_;
};

}  // namespace sightline::core
