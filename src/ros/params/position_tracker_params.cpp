#include "sightline/ros/params/position_tracker_params.h"

#include <limits>
#include <string>
#include <vector>

#include "sightline/core/estimators/mode_chain.h"

namespace sightline_ros {

namespace core = sightline::core;

namespace {

core::PositionModel loadModel(const ParamReader& reader, core::PositionModel model) {
  using Kind = core::PositionModel::Kind;
  const std::string fallback = model.kind == Kind::white_jerk ? "white_jerk" : "white_acceleration";
  const std::string kind = reader.choice("kind", fallback, {"white_acceleration", "white_jerk"});
  model.kind = kind == "white_jerk" ? Kind::white_jerk : Kind::white_acceleration;
  model.ratio = reader.number("ratio", model.ratio, atLeast(0.0));
  return model;
}

/// A list replaces the default bank.
std::vector<core::PositionModel> loadModels(const ParamReader& reader,
                                            const std::vector<core::PositionModel>& fallback) {
  if (!reader.has("models")) return fallback;
  const std::vector<ParamReader> entries = reader.list("models");
  if (entries.empty() || entries.size() > static_cast<std::size_t>(core::kMaxModes)) {
    throw reader.error("models", "expected a list of 1 to " + std::to_string(core::kMaxModes) +
                                     " maps, got " + std::to_string(entries.size()));
  }
  std::vector<core::PositionModel> models;
  for (std::size_t i = 0; i < entries.size(); ++i)
    models.push_back(loadModel(entries[i], i < fallback.size() ? fallback[i] : core::PositionModel{}));
  return models;
}

core::PositionEstimatorParams loadEstimator(const ParamReader& reader, core::PositionEstimatorParams params) {
  params.dwell = reader.number("dwell", params.dwell, above(0.0), "s");
  params.scale_memory = reader.number("scale_memory", params.scale_memory, above(0.0), "s");
  params.outlier_distance = reader.number("outlier_distance", params.outlier_distance, atLeast(1.0));
  params.alone_after = reader.number("alone_after", params.alone_after, above(0.0), "s");
  params.alone_intervals = reader.number("alone_intervals", params.alone_intervals, above(0.0));
  params.start_window = reader.number("start_window", params.start_window, above(0.0), "s");
  params.lost_relative_sigma =
      reader.number("lost_relative_sigma", params.lost_relative_sigma, above(params.max_relative_sigma));
  params.fast_share = reader.number("fast_share", params.fast_share, atLeast(0.0));
  params.fast_time = reader.number("fast_time", params.fast_time, above(0.0), "s");
  params.models = loadModels(reader, params.models);
  return params;
}

core::HypothesisParams loadHypotheses(const ParamReader& reader, core::HypothesisParams params) {
  params.gate = reader.number("gate", params.gate, above(0.0));
  params.detection_probability =
      reader.number("detection_probability", params.detection_probability, inside(0.0, 1.0));
  params.memory = reader.number("memory", params.memory, above(0.0), "s");
  params.correlation_time = reader.number("correlation_time", params.correlation_time, above(0.0), "s");
  params.least_score = reader.number("least_score", params.least_score, atLeast(0.0));
  params.least_margin = reader.number("least_margin", params.least_margin, atLeast(0.0));
  params.least_fit_margin = reader.number("least_fit_margin", params.least_fit_margin, atLeast(0.0));
  params.most_candidates = reader.integer("most_candidates", params.most_candidates, 1, kMany);
  return params;
}

core::StationNoiseParams loadNoise(const ParamReader& reader, core::StationNoiseParams params) {
  params.slow_scale = reader.number("slow_scale", params.slow_scale, atLeast(0.0));
  params.time_constant = reader.number("time_constant", params.time_constant, above(0.0), "s");
  params.safety = reader.number("safety", params.safety, above(0.0));
  params.memory = reader.number("memory", params.memory, above(0.0), "s");
  params.prior_weight = reader.number("prior_weight", params.prior_weight, atLeast(0.0), "s");
  params.least_scale = reader.number("least_scale", params.least_scale, above(0.0));
  params.most_scale = reader.number("most_scale", params.most_scale, above(params.least_scale));
  params.least_time = reader.number("least_time", params.least_time, above(0.0), "s");
  params.most_time = reader.number("most_time", params.most_time, above(params.least_time), "s");
  params.learn_time = reader.flag("learn_time", params.learn_time);
  return params;
}

core::StationCorrectionParams loadCorrection(const ParamReader& reader, core::StationCorrectionParams params,
                                             const core::StationAlignmentParams& wide) {
  params.enabled = reader.flag("enabled", params.enabled);
  params.normal_clock_sigma =
      reader.number("normal_clock_sigma", params.normal_clock_sigma, inside(0.0, wide.clock_sigma), "s");
  params.normal_orientation_sigma = reader.number("normal_orientation_sigma", params.normal_orientation_sigma,
                                                  inside(0.0, wide.orientation_sigma), "rad");
  params.significance = reader.number("significance", params.significance, above(0.0));
  params.release = reader.number("release", params.release, inside(0.0, params.significance));
  params.least_margin = reader.number("least_margin", params.least_margin, atLeast(0.0));
  return params;
}

}  // namespace

core::PositionTrackerParams loadPositionTrackerParams(const ParamReader& reader,
                                                      core::PositionTrackerParams params) {
  params.max_lag = reader.number("max_lag", params.max_lag, atLeast(0.0), "s");
  core::PositionSceneParams& scene = params.scene;
  scene.estimator.max_relative_sigma =
      reader.number("max_relative_sigma", scene.estimator.max_relative_sigma, inside(0.0, 1.0));
  scene.hypotheses.max_relative_sigma = scene.estimator.max_relative_sigma;  // one limit for both
  scene.estimator = loadEstimator(reader.sub("estimator"), scene.estimator);
  scene.hypotheses = loadHypotheses(reader.sub("hypotheses"), scene.hypotheses);
  scene.noise = loadNoise(reader.sub("station_noise"), scene.noise);

  scene.correction = loadCorrection(reader.sub("station_correction"), scene.correction, scene.alignment);

  scene.decision_interval = reader.number("decision_interval", scene.decision_interval, above(0.0), "s");
  scene.claim_gate = reader.number("claim_gate", scene.claim_gate, above(0.0));
  scene.claim_decisions = reader.integer("claim_decisions", scene.claim_decisions, 1, kMany);
  scene.contradiction = reader.number("contradiction", scene.contradiction, above(0.0));
  scene.contradiction_time = reader.number("contradiction_time", scene.contradiction_time, above(0.0), "s");
  scene.merge_gate = reader.number("merge_gate", scene.merge_gate, above(0.0));
  scene.confirm_after = reader.number("confirm_after", scene.confirm_after, atLeast(0.0), "s");
  scene.confirm_pair_after = reader.number("confirm_pair_after", scene.confirm_pair_after, atLeast(0.0), "s");
  scene.coast_after = reader.number("coast_after", scene.coast_after, above(0.0), "s");
  scene.delete_after = reader.number("delete_after", scene.delete_after, above(0.0), "s");
  scene.remember_for = reader.number("remember_for", scene.remember_for, atLeast(0.0), "s");
  scene.max_local_tracks = reader.integer("max_local_tracks", scene.max_local_tracks, 1, kMany);
  scene.max_targets = reader.integer("max_targets", scene.max_targets, 1, kMany);
  return params;
}

}  // namespace sightline_ros
