#include "sightline/ros/params/tracker_params.h"

#include <limits>
#include <utility>
#include <vector>

namespace sightline_ros {

namespace core = sightline::core;

namespace {

constexpr int kMostNogaRows = 62;

/// The names of an enumeration in the order of its values, from 0.
using Names = std::vector<std::string>;

const Names kAssociations = {"nearest", "jpda"};
const Names kGateShapes = {"ellipse", "rectangle"};
const Names kTimeWeights = {"none", "linear", "exponential"};
const Names kSensorWeights = {"variance", "ifov"};
const Names kAnchors = {"fit", "raw"};
const Names kTwblsCovariances = {"residual", "sandwich", "fit_error"};
const Names kForms = {"paper", "consistent"};
const Names kResponses = {"straight", "harmonic", "fixed_harmonic", "fading"};
const Names kHealthForms = {"specified", "refined"};
const Names kNogaCovariances = {"residual", "printed"};

template <typename Enum>
Enum chosen(const ParamReader& reader, const std::string& key, Enum fallback, const Names& names) {
  const std::string name = reader.choice(key, names[static_cast<std::size_t>(fallback)], names);
  std::size_t value = 0;
  while (names[value] != name) ++value;
  return static_cast<Enum>(value);
}

double initialRateSigma(const ParamReader& reader, double fallback) {
  return reader.number("initial_rate_sigma", fallback, atLeast(0.0), "rad/s");
}

core::ProcessNoise loadProcessNoise(const ParamReader& reader, const core::ProcessNoise& fallback,
                                    int power) {
  core::ProcessNoise noise;
  const std::string unit = "s^" + std::to_string(power);
  noise.density = reader.number("process_noise", fallback.density, atLeast(0.0), "rad^2/" + unit);
  noise.ratio = reader.number("process_noise_ratio", fallback.ratio, atLeast(0.0), "1/" + unit);
  if (noise.density == 0.0 && noise.ratio == 0.0) {
    throw reader.error("process_noise_ratio",
                       "expected a number > 0 here or in process_noise, got 0 in both");
  }
  return noise;
}

core::ImmModel loadImmModel(const ParamReader& reader, const core::ImmModel& fallback) {
  core::ImmModel model;
  model.order = reader.integer("order", fallback.order, 1, 2);
  model.noise = loadProcessNoise(reader, fallback.noise, model.order == 1 ? 3 : 5);
  return model;
}

core::ProcessNoise loadAcceleration(const ParamReader& reader, const core::ProcessNoise& fallback) {
  return loadProcessNoise(reader, fallback, 3);
}

core::ResponseModel loadResponseModel(const ParamReader& reader, const core::ResponseModel& fallback) {
  core::ResponseModel model;
  model.kind = chosen(reader, "response", fallback.kind, kResponses);
  model.q = reader.number("q", fallback.q, atLeast(0.0));
  model.q_kappa = reader.number("q_kappa", fallback.q_kappa, atLeast(0.0), "1/s^5");
  model.kappa = reader.number("kappa", fallback.kappa, anyNumber(), "1/s^2");
  model.fade = reader.number("fade", fallback.fade, above(0.0), "s");
  model.attraction = reader.number("attraction", fallback.attraction, above(0.0));
  return model;
}

core::NoiseLearningParams loadNoiseLearningParams(const ParamReader& reader,
                                                  core::NoiseLearningParams params) {
  params.enabled = reader.flag("enabled", params.enabled);
  params.memory = reader.number("memory", params.memory, above(0.0), "s");
  params.trust = reader.number("trust", params.trust, above(0.0), "sightings");
  params.min_scale = reader.number("min_scale", params.min_scale, Range{0.0, 1.0, true, false});
  params.max_scale = reader.number("max_scale", params.max_scale, atLeast(1.0));
  return params;
}

/// A list of maps, each read by `load` with the fallback of its place.
template <typename Model, typename Load>
std::vector<Model> loadBank(const ParamReader& reader, const std::string& key,
                            const std::vector<Model>& fallback, Load load) {
  const std::vector<ParamReader> readers = reader.list(key);
  if (!reader.has(key)) return fallback;
  if (readers.empty() || readers.size() > static_cast<std::size_t>(core::kMaxModes)) {
    throw reader.error(key, "expected a list of 1 to " + std::to_string(core::kMaxModes) + " maps, got " +
                                std::to_string(readers.size()));
  }
  std::vector<Model> models;
  for (std::size_t i = 0; i < readers.size(); ++i) {
    models.push_back(load(readers[i], i < fallback.size() ? fallback[i] : Model{}));
  }
  return models;
}

}  // namespace

std::string nameOf(core::EstimatorKind kind) {
  return core::estimatorName(kind);
}

core::GateParams loadGateParams(const ParamReader& reader, core::GateParams params) {
  params.probability = reader.number("probability", params.probability, inside(0.0, 1.0));
  params.shape = chosen(reader, "shape", params.shape, kGateShapes);
  params.min_half_width = reader.number("min_half_width", params.min_half_width, atLeast(0.0), "rad");
  params.max_half_width = reader.number("max_half_width", params.max_half_width, above(0.0), "rad");
  if (params.min_half_width > params.max_half_width) {
    throw reader.error("min_half_width", "expected at most max_half_width, " +
                                             std::to_string(params.max_half_width) + " rad, got " +
                                             std::to_string(params.min_half_width) + " rad");
  }
  return params;
}

core::LifecycleParams loadLifecycleParams(const ParamReader& reader, core::LifecycleParams params) {
  params.by_existence = reader.flag("by_existence", params.by_existence);
  params.confirm_scans = reader.integer("confirm_scans", params.confirm_scans, 1, kMany);
  params.confirm_hits = reader.integer("confirm_hits", params.confirm_hits, 1, params.confirm_scans);
  params.coast_misses = reader.integer("coast_misses", params.coast_misses, 1, kMany);
  params.coast_silence = reader.number("coast_silence", params.coast_silence, above(0.0), "s");
  params.delete_misses = reader.integer("delete_misses", params.delete_misses, 1, kMany);
  params.delete_silence = reader.number("delete_silence", params.delete_silence, above(0.0), "s");
  params.confirm_existence = reader.number("confirm_existence", params.confirm_existence, inside(0.0, 1.0));
  params.show_existence =
      reader.number("show_existence", params.show_existence, Range{0.0, 1.0, false, true});
  core::PresenceParams& presence = params.presence;
  presence.mean_life = reader.number("mean_life", presence.mean_life, above(0.0), "s");
  presence.mean_shown = reader.number("mean_shown", presence.mean_shown, above(0.0), "s");
  presence.mean_hidden = reader.number("mean_hidden", presence.mean_hidden, above(0.0), "s");
  presence.mean_patience = reader.number("mean_patience", presence.mean_patience, above(0.0), "s");
  params.remember = reader.number("remember", params.remember, atLeast(0.0), "s");
  params.max_spread = reader.number("max_spread", params.max_spread, above(1.0));
  params.merge_scans = reader.integer("merge_scans", params.merge_scans, 1, kMany);
  return params;
}

core::DetectionParams loadDetectionParams(const ParamReader& reader, core::DetectionParams params) {
  params.probability = reader.number("probability", params.probability, Range{0.0, 1.0, false, false});
  params.clutter_density = reader.number("clutter_density", params.clutter_density, anyNumber(), "1/sr");
  params.memory = reader.number("memory", params.memory, atLeast(10.0), "scans");
  params.births = reader.number("births", params.births, above(0.0), "1/s");
  params.first_targets = reader.number("first_targets", params.first_targets, above(0.0));
  return params;
}

core::SensorHealthParams loadSensorHealthParams(const ParamReader& reader, core::SensorHealthParams params) {
  params.form = chosen(reader, "form", params.form, kHealthForms);
  params.noise_threshold = reader.number("noise_threshold", params.noise_threshold, above(0.0));
  params.noise_ratio = reader.number("noise_ratio", params.noise_ratio, above(1.0));
  params.largest_evidence = reader.number("largest_evidence", params.largest_evidence, above(0.0));
  params.bias_threshold = reader.number("bias_threshold", params.bias_threshold, above(0.0), "sigma");
  params.bias_slack = reader.number("bias_slack", params.bias_slack, above(0.0), "sigma");
  params.largest_innovation =
      reader.number("largest_innovation", params.largest_innovation, above(0.0), "sigma");
  params.memory = reader.number("memory", params.memory, above(0.0), "s");
  params.largest_scale = reader.number("largest_scale", params.largest_scale, above(1.0));
  params.least_scale = reader.number("least_scale", params.least_scale, atLeast(1.0));
  params.noise_release = reader.number("noise_release", params.noise_release, above(1.0));
  params.bias_release = reader.number("bias_release", params.bias_release, above(0.0), "sigma");
  params.least_exclusion = reader.number("least_exclusion", params.least_exclusion, atLeast(0.0), "s");
  return params;
}

core::GuardParams loadGuardParams(const ParamReader& reader, core::GuardParams params) {
  params.enabled = reader.flag("enabled", params.enabled);
  params.roll_back = reader.number("roll_back", params.roll_back, atLeast(0.0), "s");
  params.support = reader.number("support", params.support, above(0.0), "s");
  params.reach = reader.number("reach", params.reach, above(0.0), "sigma");
  params.health = loadSensorHealthParams(reader, params.health);
  const ParamReader clock = reader.sub("clock");
  params.clock.memory = clock.number("memory", params.clock.memory, above(0.0), "s");
  params.clock.significance =
      clock.number("significance", params.clock.significance, above(0.0), "standard errors");
  params.clock.least = clock.number("least", params.clock.least, atLeast(0.0), "s");
  return params;
}

core::TwblsParams loadTwblsParams(const ParamReader& reader, core::TwblsParams params) {
  params.window = reader.number("window", params.window, above(0.0), "s");
  params.max_sightings = reader.integer("max_sightings", params.max_sightings, 3, 100000);
  params.min_sightings = reader.integer("min_sightings", params.min_sightings, 2, params.max_sightings);
  params.time_weight = chosen(reader, "time_weight", params.time_weight, kTimeWeights);
  params.decay = reader.number("decay", params.decay, above(0.0), "s");
  params.sensor_weight = chosen(reader, "sensor_weight", params.sensor_weight, kSensorWeights);
  params.anchor = chosen(reader, "anchor", params.anchor, kAnchors);
  params.covariance = chosen(reader, "covariance", params.covariance, kTwblsCovariances);
  params.initial_rate_sigma = initialRateSigma(reader, params.initial_rate_sigma);
  return params;
}

core::NogaParams loadNogaParams(const ParamReader& reader, core::NogaParams params) {
  params.rows = reader.integer("rows", params.rows, 3, kMostNogaRows);
  params.weighted = reader.flag("weighted", params.weighted);
  params.feedback = reader.flag("feedback", params.feedback);
  params.covariance = chosen(reader, "covariance", params.covariance, kNogaCovariances);
  params.initial_rate_sigma = initialRateSigma(reader, params.initial_rate_sigma);
  return params;
}

core::TwblsConsistentParams loadTwblsConsistentParams(const ParamReader& reader,
                                                      core::TwblsConsistentParams params) {
  params.process_noises = loadBank(reader, "process_noises", params.process_noises, loadAcceleration);
  params.sightings = reader.integer("sightings", params.sightings, 3, 2000);
  params.min_span = reader.number("min_span", params.min_span, atLeast(0.0), "s");
  params.exact_window = reader.flag("exact_window", params.exact_window);
  params.memory = reader.number("memory", params.memory, above(0.0), "s");
  params.initial_rate_sigma = initialRateSigma(reader, params.initial_rate_sigma);
  return params;
}

core::NogaConsistentParams loadNogaConsistentParams(const ParamReader& reader,
                                                    core::NogaConsistentParams params) {
  params.models = loadBank(reader, "models", params.models, loadResponseModel);
  params.amplitude = reader.number("amplitude", params.amplitude, atLeast(0.0), "rad");
  params.initial_rate_sigma = initialRateSigma(reader, params.initial_rate_sigma);
  params.dwell = reader.number("dwell", params.dwell, above(0.0), "s");
  params.outlier_share = reader.number("outlier_share", params.outlier_share, Range{0.0, 1.0, false, true});
  params.outlier_width = reader.number("outlier_width", params.outlier_width, above(0.0), "amplitudes");
  params.least_drawn = reader.number("least_drawn", params.least_drawn, Range{0.0, 1.0, false, true});
  params.left_out = reader.number("left_out", params.left_out, Range{0.0, 1.0, false, true});
  return params;
}

core::KalmanParams loadKalmanParams(const ParamReader& reader, core::KalmanParams params) {
  params.process_noise = reader.number("process_noise", params.process_noise, atLeast(0.0), "rad^2/s^3");
  params.process_noise_ratio =
      reader.number("process_noise_ratio", params.process_noise_ratio, above(0.0), "1/s^3");
  params.initial_rate_sigma = initialRateSigma(reader, params.initial_rate_sigma);
  return params;
}

core::ImmParams loadImmParams(const ParamReader& reader, core::ImmParams params) {
  params.models = loadBank(reader, "models", params.models, loadImmModel);
  params.dwell = reader.number("dwell", params.dwell, above(0.0), "s");
  params.initial_rate_sigma = initialRateSigma(reader, params.initial_rate_sigma);
  params.initial_acceleration_sigma =
      reader.number("initial_acceleration_sigma", params.initial_acceleration_sigma, above(0.0), "rad/s^2");
  return params;
}

core::EstimatorParams loadEstimatorParams(const ParamReader& reader, core::EstimatorParams params) {
  params.kind = chosen(reader, "estimator", params.kind, core::estimatorNames());
  const ParamReader twbls = reader.sub("twbls"), noga = reader.sub("noga");
  params.twbls_form = chosen(twbls, "form", params.twbls_form, kForms);
  params.twbls = loadTwblsParams(twbls.sub("paper"), params.twbls);
  params.twbls_consistent = loadTwblsConsistentParams(twbls.sub("consistent"), params.twbls_consistent);
  params.noga_form = chosen(noga, "form", params.noga_form, kForms);
  params.noga = loadNogaParams(noga.sub("paper"), params.noga);
  params.noga_consistent = loadNogaConsistentParams(noga.sub("consistent"), params.noga_consistent);
  params.kalman = loadKalmanParams(reader.sub("kalman"), params.kalman);
  params.imm = loadImmParams(reader.sub("imm"), params.imm);
  params.noga_consistent.noise = params.twbls_consistent.noise =
      loadNoiseLearningParams(reader.sub("noise_calibration"), params.twbls_consistent.noise);
  return params;
}

core::LocalTrackerParams loadLocalTrackerParams(const ParamReader& reader, core::LocalTrackerParams params) {
  params.estimator = loadEstimatorParams(reader, params.estimator);
  params.gate = loadGateParams(reader.sub("gate"), params.gate);
  params.lifecycle = loadLifecycleParams(reader.sub("lifecycle"), params.lifecycle);
  params.detection = loadDetectionParams(reader.sub("detection"), params.detection);
  params.guard = loadGuardParams(reader.sub("guard"), params.guard);
  params.association = chosen(reader, "association", params.association, kAssociations);
  params.adapt_gate = reader.flag("adapt_gate", params.adapt_gate);
  params.noise_calibration.enabled = params.estimator.twbls_consistent.noise.enabled;
  params.noise_calibration.min_scale = params.estimator.twbls_consistent.noise.min_scale;
  params.noise_calibration.max_scale = params.estimator.twbls_consistent.noise.max_scale;
  params.max_lag = reader.number("max_lag", params.max_lag, atLeast(0.0), "s");
  params.max_tracks = reader.integer("max_tracks", params.max_tracks, 1, kMany);
  params.max_sightings = reader.integer("max_sightings", params.max_sightings, 1, kMany);
  return params;
}

core::TrackletParams loadTrackletParams(const ParamReader& reader, core::TrackletParams params) {
  params.enabled = reader.flag("enabled", params.enabled);
  params.interval = reader.number("interval", params.interval, atLeast(0.0), "s");
  params.compression.span = reader.number("span", params.compression.span, atLeast(0.0), "s");
  params.compression.nodes = reader.integer("nodes", params.compression.nodes, 1, core::kMostNodes);
  return params;
}

}  // namespace sightline_ros
