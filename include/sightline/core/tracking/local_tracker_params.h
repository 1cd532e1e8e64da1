#pragma once

#include <optional>

#include "sightline/core/association/association.h"
#include "sightline/core/association/gate.h"
#include "sightline/core/estimators/estimators.h"
#include "sightline/core/model/refusal.h"
#include "sightline/core/sensors/detection_calibration.h"
#include "sightline/core/sensors/noise_calibration.h"
#include "sightline/core/sensors/sensor_guard.h"
#include "sightline/core/tracking/track_lifecycle.h"

namespace sightline::core {

struct LocalTrackerParams {
  EstimatorParams estimator;
  GateParams gate;
  AssociationMethod association = AssociationMethod::nearest;
  bool adapt_gate = true;  ///< enlarge S by the innovations seen, where they are larger than S explains
  LifecycleParams lifecycle;
  DetectionParams detection;
  NoiseCalibrationParams noise_calibration;
  GuardParams guard;
  double max_lag = 0.5;   ///< scans up to this much older than the newest are put in their place [s], >= 0
  int max_tracks = 1000;  ///< no track is started beyond, >= 1
  int max_sightings = 10000;  ///< of one scan; the rest is rejected, >= 1
};

/// Why a tracker with the parameters `now` cannot go on with `wanted`: the field that holds from the start of
/// the tracker on, or is out of range. nullopt when it can: the two differ only in
///
/// - `gate.probability`, `gate.shape`, `gate.min_half_width`, `gate.max_half_width`, `association`,
///   `adapt_gate`,
/// - `lifecycle`, all of it,
/// - `guard.health`: `noise_threshold`, `bias_threshold`, `noise_release`, `bias_release`, `least_exclusion`,
/// - `noise_calibration.enabled` with `noise.enabled` of the estimators, which must all be the same.
///
/// The rest is what tracks, sensors and the memory of late scans were made with: estimators, what is learnt
/// of sensors, the sums of the guard, `guard.roll_back`, `max_lag` and the limits.
std::optional<Refusal> whyNotInFlight(const LocalTrackerParams& now, const LocalTrackerParams& wanted);

}  // namespace sightline::core
