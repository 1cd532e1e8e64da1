// What a LocalTracker begins with, and how its settings change while it runs.
#include "sightline/core/tracking/local_tracker.h"

namespace sightline::core {

LocalTracker::State LocalTracker::firstState(Time time, const TrackIds& ids) const {
  return {time,
          settings_.newest(),
          ids,
          {},
          NoiseCalibration(params().noise_calibration),
          DetectionCalibration(params().detection),
          {},
          SensorGuard(params().guard),
          {}};
}

void LocalTracker::startAnew(Time time) {
  settings_.startWith(LocalTrackerParams(params()));
  state_.ids.skip(highest_id_);
  state_ = firstState(time, state_.ids);
  scans_.clear();
}

std::optional<Refusal> LocalTracker::reconfigure(const LocalTrackerParams& wanted) {
  if (auto refusal = whyNotInFlight(params(), wanted)) return refusal;
  if (scans_.empty()) {
    settings_.startWith(wanted);
  } else {
    settings_.forgetBefore(scans_[0].item.time - durationOf(wanted.max_lag));
    settings_.change(wanted, state_.time);
  }
  return std::nullopt;
}

/// From a scan of `time` on the settings hold that do then.
void LocalTracker::followSettings(Time time) {
  const auto& wanted = settings_.at(time);
  if (state_.settings == wanted) return;
  const bool learns = wanted->noise_calibration.enabled;
  if (learns != settings().noise_calibration.enabled) {
    state_.calibration.enable(learns);
    for (LiveTrack& track : state_.tracks) track.learnNoise(learns);
  }
  state_.guard.setThresholds(wanted->guard.health);
  state_.settings = wanted;
}

}  // namespace sightline::core
