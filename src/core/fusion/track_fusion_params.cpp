#include "sightline/core/fusion/track_fusion_params.h"

#include <stdexcept>
#include <string>

#include "sightline/core/model/chi_square.h"
#include "sightline/core/sensors/guard_settings.h"

namespace sightline::core {
namespace {

void check(bool holds, const std::string& rule) {
  if (!holds) throw std::invalid_argument("TrackFusionParams: " + rule);
}

Refusal fixed(const std::string& field) {
  return {"fixed", field + " holds from the start of the fusion: set the parameter and start it again"};
}

}  // namespace

void requireValid(const TrackFusionParams& params) {
  check(params.gate_probability > 0.0 && params.gate_probability < 1.0,
        "gate_probability in (0, 1) is required");
  check(params.leave_factor >= 1.0, "leave_factor >= 1 is required");
  check(params.leave_after >= 0.0, "leave_after >= 0 s is required");
  check(params.registration_sigma >= 0.0, "registration_sigma >= 0 rad is required");
  check(params.process_noise >= 0.0,
        "process_noise >= 0 rad^2/s^3 is required (0 = implied by the covariances)");
  check(params.max_wait >= 0.0, "max_wait >= 0 s is required (0 = every report is fused at once)");
  check(params.coasting_age >= 0.0 && params.delete_after >= 0.0 && params.remember >= 0.0,
        "coasting_age, delete_after and remember >= 0 s are required");
  check(params.reports.max_age > 0.0 && params.reports.forget_after >= params.reports.max_age,
        "max_age > 0 s and forget_after >= max_age are required");
  check(params.max_tracks >= 1 && params.reports.max_tracks >= 1 && params.reports.max_trackers >= 1,
        "limits >= 1 are required");
  const TrackletFusionParams& tracklets = params.tracklets;
  check(tracklets.max_lag > 0.0 && tracklets.memory > 0.0 && tracklets.max_missing >= 0.0 &&
            tracklets.max_missing <= 1.0,
        "tracklets: max_lag and memory > 0 s, max_missing in [0, 1] are required");
  // Refuse what cannot work before the first tracklet comes.
  [[maybe_unused]] const SensorGuard guard(tracklets.guard);
  makeEstimator(tracklets.estimator);
}

bool usesTracklets(FusionRule rule) {
  return rule == FusionRule::best || rule == FusionRule::tracklets;
}

std::optional<Refusal> whyNotInFlight(const TrackFusionParams& now, const TrackFusionParams& wanted) {
  const LocalReportsParams &reports = wanted.reports, &reports_now = now.reports;
  const TrackletFusionParams &tracklets = wanted.tracklets, &tracklets_now = now.tracklets;
  if (wanted.registration_sigma != now.registration_sigma) return fixed("registration_sigma");
  if (wanted.process_noise != now.process_noise) return fixed("process_noise");
  if (wanted.max_wait != now.max_wait) return fixed("max_wait");
  if (wanted.max_tracks != now.max_tracks) return fixed("max_tracks");
  if (reports.max_age != reports_now.max_age) return fixed("reports.max_age");
  if (reports.forget_after != reports_now.forget_after) return fixed("reports.forget_after");
  if (reports.max_trackers != reports_now.max_trackers) return fixed("reports.max_trackers");
  if (reports.max_tracks != reports_now.max_tracks) return fixed("reports.max_tracks");
  if (!(tracklets.estimator == tracklets_now.estimator))
    return fixed("tracklets.estimator (with its settings)");
  if (tracklets.max_lag != tracklets_now.max_lag) return fixed("tracklets.max_lag");
  if (tracklets.memory != tracklets_now.memory) return fixed("tracklets.memory");
  if (const auto field = fixedGuardField(tracklets_now.guard, tracklets.guard))
    return fixed("tracklets.guard." + *field);
  try {
    requireValid(wanted);
  } catch (const std::invalid_argument& problem) {
    return invalid(problem.what());
  }
  return std::nullopt;
}

TrackletMemoryParams memoryParamsOf(const TrackFusionParams& params) {
  return {params.tracklets.max_lag + params.tracklets.memory, params.reports.max_trackers};
}

DistanceThresholds thresholdsOf(const TrackFusionParams& params) {
  const double join = chiSquareQuantile4(params.gate_probability);
  return {join, params.leave_factor * join};
}

}  // namespace sightline::core
