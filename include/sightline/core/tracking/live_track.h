#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "sightline/core/association/association.h"
#include "sightline/core/association/gate.h"
#include "sightline/core/estimators/charted_estimator.h"
#include "sightline/core/estimators/estimator.h"
#include "sightline/core/estimators/revisit_time.h"
#include "sightline/core/model/sighting.h"
#include "sightline/core/model/track.h"
#include "sightline/core/sensors/noise_calibration.h"
#include "sightline/core/sensors/sensor_guard.h"
#include "sightline/core/tracking/track_ids.h"
#include "sightline/core/tracking/track_lifecycle.h"
#include "sightline/core/tracking/track_sensors.h"

namespace sightline::core {

/// What is known of the sensor of a scan.
struct ScanSensor {
  double detection_probability = 0.9;  ///< that it shows a target that it can see
  RevisitTime interval;                ///< between its scans
  bool is_clear = true;                ///< few of the scan's sightings can be false: see isClear
};

/// One target's track: its estimator, its status, and what is known of the sensors that see it. Copies are
/// deep.
class LiveTrack {
 public:
  /// A track started from one sighting (tracking frame) of a scan, `origin`. `odds`: of a new target against
  /// a false sighting; `interval`: between scans of this sensor.
  LiveTrack(std::uint32_t id, const TrackOrigin& origin, const Scan& scan, const Sighting& sighting,
            std::unique_ptr<Estimator> estimator, double odds, const RevisitTime& interval);

  std::uint32_t id() const { return id_; }
  const TrackOrigin& origin() const { return origin_; }
  const TrackLifecycle& lifecycle() const { return lifecycle_; }

  /// What the track expects to see in a scan. Moves to a new chart when the target leaves the present one.
  TrackPrediction predict(const Scan& scan, const ScanSensor& sensor, const LifecycleParams& params,
                          bool adapt_gate);

  /// Updates with a sighting; `prediction` is that for the scan's time, `likelihood_ratio` that of its
  /// association. `possible`: all sightings that may be the target's, with their probabilities; empty = this
  /// one alone.
  void update(const Scan& scan, const Sighting& sighting, const TrackPrediction& prediction,
              const std::vector<PossibleSighting>& possible, double likelihood_ratio,
              const LifecycleParams& params);

  /// The scan has not shown the target: counts it, if its sensor is one that could have.
  void miss(const Scan& scan, const TrackPrediction& prediction, double likelihood_ratio,
            const LifecycleParams& params);

  /// ln of the density with which a target of this track, if it returns, has the motion of `fresh`
  /// [1/(rad^2 (rad/s)^2)]. Targets sometimes jump, where sightings stand still or a filter is too sure: one
  /// in twenty is allowed 25 times the distance. `noise_scale`: factor on the sensor's stated variances that
  /// is believed now, or suspected. Where this track had believed in less, it was lost in no time: its
  /// covariance counts as many times.
  double logDensityOfReturn(const LiveTrack& fresh, Time time, double noise_scale) const;

  /// The same of a new target, where `births` new ones are expected in a solid angle of 1 sr.
  double logDensityOfBirth(Time time, double births) const;

  /// A second track of the same sightings, for another hypothesis of which the next one is.
  LiveTrack branch(std::uint32_t id, const TrackOrigin& origin) const;

  /// Goes on as the track that a target had before it was lost.
  void resume(const LiveTrack& lost);

  /// Whether its estimator learns the sightings' noise from now on: see Estimator::learnNoise.
  void learnNoise(bool enabled) { estimator_.learnNoise(enabled); }

  /// How far the track corroborates a sensor's sightings at `time`.
  Corroboration corroborationOf(const std::string& sensor, Time time, const SensorGuard& guard) const;

  /// Brings the status up to date: confirmed, coasting, lost.
  void updateStatus(Time time, const LifecycleParams& params) { lifecycle_.updateStatus(time, params); }

  /// Whether the track is to be deleted at `time`, for which its status is up to date. Its gate may be as
  /// much wider as the noise of its sensor is suspected to be by `calibration`.
  bool isOver(Time time, const LifecycleParams& params, bool adapt_gate,
              const NoiseCalibration& calibration) const;

  /// The track in the tracking frame's angles at `time`, with the gate for the sighting that comes next.
  Track report(Time time, const GateParams& gate, bool adapt_gate, const LifecycleParams& params) const;

 private:
  void expectSecondLook(Time time, bool is_clear, TrackPrediction& prediction) const;
  void updateUnit(Time time, const LifecycleParams& params);
  void noteSource(const Scan& scan, const Eigen::Vector2d& innovation);
  Eigen::Matrix2d lastNoise() const;
  double spread(const AngularState& state, bool adapt_gate) const;
  double growth(double noise_scale) const { return std::max(noise_scale / last_noise_scale_, 1.0); }
  double gateScale(bool adapt_gate) const;

  std::uint32_t id_;
  TrackOrigin origin_;
  ChartedEstimator estimator_;
  TrackLifecycle lifecycle_;
  TrackSensors sensors_;
  Eigen::Matrix2d last_covariance_;  // of the last sighting, in the chart [rad^2] ...
  double last_noise_scale_;          // ... and the factor on the stated one that it has in it
  double innovation_scale_ = 1.0;    // running mean of d^2 / 2 with S as stated, 1 if S is right
};

}  // namespace sightline::core
