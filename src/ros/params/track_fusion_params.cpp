#include "sightline/ros/params/track_fusion_params.h"

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include "sightline/ros/params/tracker_params.h"

namespace sightline_ros {

namespace core = sightline::core;

namespace {

core::FusionRule loadRule(const ParamReader& reader, core::FusionRule fallback) {
  std::vector<std::string> names;
  for (const core::FusionRuleEntry& entry : core::fusionRuleTable()) names.emplace_back(entry.name);
  const std::string name = reader.choice("rule", nameOf(fallback), names);
  const auto chosen = std::find(names.begin(), names.end(), name) - names.begin();
  return core::fusionRuleTable()[static_cast<std::size_t>(chosen)].rule;
}

core::IntersectionWeights loadIntersectionWeights(const ParamReader& reader,
                                                  core::IntersectionWeights fallback) {
  const bool is_trace = fallback == core::IntersectionWeights::trace;
  const std::string name =
      reader.choice("intersection_weights", is_trace ? "trace" : "determinant", {"determinant", "trace"});
  return name == "trace" ? core::IntersectionWeights::trace : core::IntersectionWeights::determinant;
}

core::TrackletFusionParams loadTrackletFusionParams(const ParamReader& reader,
                                                    core::TrackletFusionParams params) {
  params.estimator = loadEstimatorParams(reader, params.estimator);
  const ParamReader tracklets = reader.sub("tracklets");
  params.max_lag = tracklets.number("max_lag", params.max_lag, above(0.0), "s");
  params.memory = tracklets.number("memory", params.memory, above(0.0), "s");
  params.max_missing = tracklets.number("max_missing", params.max_missing, between(0.0, 1.0));
  params.guard = loadGuardParams(reader.sub("guard"), params.guard);
  return params;
}

core::LocalReportsParams loadLocalReportsParams(const ParamReader& reader, core::LocalReportsParams params) {
  params.max_age = reader.number("max_age", params.max_age, above(0.0), "s");
  params.forget_after = reader.number("forget_after", params.forget_after, atLeast(params.max_age), "s");
  params.max_trackers = reader.integer("max_trackers", params.max_trackers, 1, kMany);
  params.max_tracks = reader.integer("max_local_tracks", params.max_tracks, 1, kMany);
  return params;
}

}  // namespace

core::TrackFusionParams loadTrackFusionParams(const ParamReader& reader, core::TrackFusionParams params) {
  params.rule = loadRule(reader, params.rule);
  params.intersection_weights = loadIntersectionWeights(reader, params.intersection_weights);

  const ParamReader gate = reader.sub("gate");
  params.gate_probability = gate.number("probability", params.gate_probability, inside(0.0, 1.0));
  params.leave_factor = gate.number("leave_factor", params.leave_factor, atLeast(1.0));
  params.leave_after = gate.number("leave_after", params.leave_after, atLeast(0.0), "s");
  params.registration_sigma =
      gate.number("registration_sigma", params.registration_sigma, atLeast(0.0), "rad");

  params.process_noise = reader.number("process_noise", params.process_noise, atLeast(0.0), "rad^2/s^3");
  params.max_wait = reader.number("max_wait", params.max_wait, atLeast(0.0), "s");
  params.coasting_age = reader.number("coasting_age", params.coasting_age, atLeast(0.0), "s");
  params.delete_after = reader.number("delete_after", params.delete_after, atLeast(0.0), "s");
  params.remember = reader.number("remember", params.remember, atLeast(0.0), "s");
  params.allow_shared_sensors = reader.flag("allow_shared_sensors", params.allow_shared_sensors);
  params.max_tracks = reader.integer("max_tracks", params.max_tracks, 1, kMany);
  params.reports = loadLocalReportsParams(reader, params.reports);
  params.tracklets = loadTrackletFusionParams(reader, params.tracklets);
  return params;
}

}  // namespace sightline_ros
