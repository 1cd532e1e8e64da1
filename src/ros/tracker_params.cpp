#include "sightline/ros/tracker_params.h"

#include <limits>
#include <utility>
#include <vector>

namespace sightline_ros {

namespace core = sightline::core;

namespace {

constexpr int kMany = std::numeric_limits<int>::max();

/// The names of an enumeration in the order of its values, from 0.
using Names = std::vector<std::string>;

const Names kEstimators = {"twbls", "noga", "kalman", "imm"};
const Names kGateShapes = {"ellipse", "rectangle"};
const Names kTimeWeights = {"none", "linear", "exponential"};
const Names kSensorWeights = {"variance", "ifov"};
const Names kAnchors = {"fit", "raw"};
const Names kTwblsCovariances = {"residual", "sandwich", "fit_error"};

template <typename Enum>
Enum chosen(const ParamReader& reader, const std::string& key, Enum fallback, const Names& names) {
  const std::string name = reader.choice(key, names[static_cast<std::size_t>(fallback)], names);
  std::size_t value = 0;
  while (names[value] != name) ++value;
  return static_cast<Enum>(value);
}

}  // namespace

std::string nameOf(core::EstimatorKind kind) {
  return kEstimators[static_cast<std::size_t>(kind)];
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
  params.confirm_scans = reader.integer("confirm_scans", params.confirm_scans, 1, kMany);
  params.confirm_hits = reader.integer("confirm_hits", params.confirm_hits, 1, params.confirm_scans);
  params.coast_misses = reader.integer("coast_misses", params.coast_misses, 1, kMany);
  params.coast_silence = reader.number("coast_silence", params.coast_silence, above(0.0), "s");
  params.delete_misses = reader.integer("delete_misses", params.delete_misses, 1, kMany);
  params.delete_silence = reader.number("delete_silence", params.delete_silence, above(0.0), "s");
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
  params.initial_rate_sigma =
      reader.number("initial_rate_sigma", params.initial_rate_sigma, above(0.0), "rad/s");
  return params;
}

core::EstimatorParams loadEstimatorParams(const ParamReader& reader, core::EstimatorParams params) {
  params.kind = chosen(reader, "estimator", params.kind, kEstimators);
  params.twbls = loadTwblsParams(reader.sub("twbls"), params.twbls);
  params.noga = loadNogaParams(reader.sub("noga"), params.noga);
  params.kalman = loadKalmanParams(reader.sub("kalman"), params.kalman);
  params.imm = loadImmParams(reader.sub("imm"), params.imm);
  return params;
}

core::LocalTrackerParams loadLocalTrackerParams(const ParamReader& reader, core::LocalTrackerParams params) {
  params.estimator = loadEstimatorParams(reader, params.estimator);
  params.gate = loadGateParams(reader.sub("gate"), params.gate);
  params.lifecycle = loadLifecycleParams(reader.sub("lifecycle"), params.lifecycle);
  params.adapt_gate = reader.flag("adapt_gate", params.adapt_gate);
  params.max_lag = reader.number("max_lag", params.max_lag, atLeast(0.0), "s");
  params.max_tracks = reader.integer("max_tracks", params.max_tracks, 1, kMany);
  params.max_sightings = reader.integer("max_sightings", params.max_sightings, 1, kMany);
  return params;
}

}  // namespace sightline_ros
