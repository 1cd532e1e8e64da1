#include "sightline/core/tracking/local_tracker_params.h"

#include <string>

#include "sightline/core/sensors/guard_settings.h"

namespace sightline::core {
namespace {

Refusal fixed(const std::string& field) {
  return {"fixed", field + " holds from the start of the tracker: set the parameter and start it again"};
}

bool isProbability(double value) {
  return value > 0.0 && value < 1.0;
}

/// What is out of range in the fields that may change; nullopt when nothing is.
std::optional<Refusal> outOfRange(const LocalTrackerParams& params) {
  const GateParams& gate = params.gate;
  const LifecycleParams& life = params.lifecycle;
  const PresenceParams& presence = life.presence;
  if (!isProbability(gate.probability)) return invalid("gate.probability in (0, 1) is required");
  if (!(gate.min_half_width >= 0.0) || !(gate.max_half_width > 0.0) ||
      !(gate.min_half_width <= gate.max_half_width))
    return invalid(
        "gate.min_half_width >= 0 rad, and gate.max_half_width > 0 rad and not less, are required");
  if (life.confirm_hits < 1 || life.confirm_scans < life.confirm_hits)
    return invalid("lifecycle.confirm_hits in [1, confirm_scans] is required");
  if (!isProbability(life.confirm_existence) || !(life.show_existence >= 0.0 && life.show_existence < 1.0))
    return invalid("lifecycle.confirm_existence in (0, 1) and show_existence in [0, 1) are required");
  if (life.coast_misses < 1 || life.delete_misses < 1 || life.merge_scans < 1)
    return invalid("lifecycle.coast_misses, delete_misses and merge_scans >= 1 are required");
  if (!(life.coast_silence > 0.0) || !(life.delete_silence > 0.0) || !(life.remember >= 0.0) ||
      !(life.max_spread > 1.0))
    return invalid(
        "lifecycle.coast_silence and delete_silence > 0 s, remember >= 0 s and max_spread > 1 are required");
  if (!(presence.mean_life > 0.0) || !(presence.mean_shown > 0.0) || !(presence.mean_hidden > 0.0) ||
      !(presence.mean_patience > 0.0))
    return invalid("lifecycle.presence: all means > 0 s are required");
  return whyUnusable(params.guard);
}

}  // namespace

std::optional<Refusal> whyNotInFlight(const LocalTrackerParams& now, const LocalTrackerParams& wanted) {
  const bool learns = wanted.noise_calibration.enabled;
  EstimatorParams estimator = wanted.estimator;  // with what may change as it is now
  if (estimator.twbls_consistent.noise.enabled != learns || estimator.noga_consistent.noise.enabled != learns)
    return invalid("noise_calibration.enabled: must be the same for the tracker and its estimators");
  estimator.twbls_consistent.noise.enabled = now.estimator.twbls_consistent.noise.enabled;
  estimator.noga_consistent.noise.enabled = now.estimator.noga_consistent.noise.enabled;
  if (!(estimator == now.estimator)) return fixed("estimator (with its settings)");
  if (!(wanted.detection == now.detection)) return fixed("detection");
  NoiseCalibrationParams calibration = wanted.noise_calibration;
  calibration.enabled = now.noise_calibration.enabled;
  if (!(calibration == now.noise_calibration)) return fixed("noise_calibration (but whether it is enabled)");
  if (const auto field = fixedGuardField(now.guard, wanted.guard)) return fixed("guard." + *field);
  if (wanted.max_lag != now.max_lag) return fixed("max_lag");
  if (wanted.max_tracks != now.max_tracks) return fixed("max_tracks");
  if (wanted.max_sightings != now.max_sightings) return fixed("max_sightings");
  return outOfRange(wanted);
}

}  // namespace sightline::core
