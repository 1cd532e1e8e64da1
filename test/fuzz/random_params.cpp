#include "fuzz/random_params.h"

#include <algorithm>

#include "sightline/core/estimators/mode_chain.h"

namespace sightline_fuzz {

namespace core = sightline::core;

namespace {

/// Changes some of the numbers that it is shown.
class Dial {
 public:
  Dial(RandomInput& input, double share) : input_(input), share_(share) {}

  /// Evenly in the logarithm; `first` > 0, or 0 for a value that may be 0 too.
  void size(double& value, double first, double last) {
    if (!input_.chance(share_)) return;
    const bool may_be_zero = first == 0.0;
    if (may_be_zero && input_.chance(0.3))
      value = 0.0;
    else
      value = input_.logBetween(may_be_zero ? last * 1e-9 : first, last);
  }

  void share(double& value, double first, double last) {
    if (input_.chance(share_)) value = input_.between(first, last);
  }

  void count(int& value, int first, int last) {
    if (input_.chance(share_)) value = input_.between(first, last);
  }

  void flag(bool& value) {
    if (input_.chance(share_)) value = !value;
  }

  template <typename Enum>
  void choice(Enum& value, int count) {
    if (input_.chance(std::max(share_, 0.2))) value = static_cast<Enum>(input_.between(0, count - 1));
  }

  bool now() { return input_.chance(share_); }

 private:
  RandomInput& input_;
  double share_;
};

Dial dialOf(RandomInput& input) {
  return Dial(input, input.oneOf({0.0, 0.05, 0.3}));
}

void turn(Dial& dial, core::ProcessNoise& noise) {
  dial.size(noise.density, 0.0, 1e6);
  dial.size(noise.ratio, 1e-9, 1e9);
}

void turn(Dial& dial, core::NoiseLearningParams& noise) {
  dial.flag(noise.enabled);
  dial.size(noise.memory, 1e-6, 1e6);
  dial.size(noise.trust, 1e-3, 1e6);
  dial.size(noise.min_scale, 1e-6, 1.0);
  dial.size(noise.max_scale, 1.0, 1e6);
}

void turn(Dial& dial, core::ResponseModel& model) {
  dial.choice(model.kind, 4);
  dial.size(model.q, 0.0, 1e9);
  dial.size(model.q_kappa, 0.0, 1e9);
  dial.share(model.kappa, -1e3, 1e3);
  dial.size(model.fade, 1e-6, 1e6);
  dial.size(model.attraction, 1e-6, 1e6);
}

void turn(Dial& dial, core::EstimatorParams& params) {
  dial.size(params.twbls.window, 1e-6, 1e6);
  dial.count(params.twbls.max_sightings, 3, 400);
  dial.count(params.twbls.min_sightings, 2, params.twbls.max_sightings);
  params.twbls.min_sightings = std::min(params.twbls.min_sightings, params.twbls.max_sightings);
  dial.choice(params.twbls.time_weight, 3);
  dial.size(params.twbls.decay, 1e-6, 1e6);
  dial.choice(params.twbls.sensor_weight, 2);
  dial.choice(params.twbls.anchor, 2);
  dial.choice(params.twbls.covariance, 3);
  dial.size(params.twbls.initial_rate_sigma, 0.0, 1e6);

  for (core::ProcessNoise& noise : params.twbls_consistent.process_noises) turn(dial, noise);
  dial.count(params.twbls_consistent.sightings, 3, 300);
  dial.size(params.twbls_consistent.min_span, 0.0, 1e6);
  dial.flag(params.twbls_consistent.exact_window);
  dial.size(params.twbls_consistent.memory, 1e-6, 1e6);
  dial.size(params.twbls_consistent.initial_rate_sigma, 0.0, 1e6);
  turn(dial, params.twbls_consistent.noise);

  dial.count(params.noga.rows, 3, 62);
  dial.choice(params.noga.weighted, 2);
  dial.flag(params.noga.feedback);
  dial.choice(params.noga.covariance, 2);
  dial.size(params.noga.initial_rate_sigma, 0.0, 1e6);

  for (core::ResponseModel& model : params.noga_consistent.models) turn(dial, model);
  if (dial.now()) params.noga_consistent.models.resize(1);
  dial.size(params.noga_consistent.amplitude, 0.0, 1e6);
  dial.size(params.noga_consistent.initial_rate_sigma, 0.0, 1e6);
  dial.size(params.noga_consistent.dwell, 1e-6, 1e6);
  dial.share(params.noga_consistent.outlier_share, 0.0, 0.999);
  dial.size(params.noga_consistent.outlier_width, 1e-6, 1e6);
  dial.share(params.noga_consistent.least_drawn, 0.0, 0.999);
  dial.share(params.noga_consistent.left_out, 0.0, 0.999);
  params.noga_consistent.noise = params.twbls_consistent.noise;

  dial.size(params.kalman.process_noise, 0.0, 1e6);
  dial.size(params.kalman.process_noise_ratio, 1e-9, 1e9);
  dial.size(params.kalman.initial_rate_sigma, 0.0, 1e6);
  for (core::ImmModel& model : params.imm.models) {
    dial.count(model.order, 1, 2);
    turn(dial, model.noise);
  }
  if (dial.now()) params.imm.models.resize(1);
  dial.size(params.imm.dwell, 1e-6, 1e6);
  dial.size(params.imm.initial_rate_sigma, 0.0, 1e6);
  dial.size(params.imm.initial_acceleration_sigma, 1e-6, 1e6);
}

void turn(Dial& dial, core::GuardParams& guard) {
  dial.flag(guard.enabled);
  dial.size(guard.roll_back, 0.0, 10.0);
  dial.size(guard.support, 1e-3, 1e6);
  dial.size(guard.reach, 1e-3, 1e6);
  dial.choice(guard.health.form, 2);
  dial.size(guard.health.noise_threshold, 1e-3, 1e3);
  dial.size(guard.health.noise_ratio, 1.001, 1e6);
  dial.size(guard.health.largest_evidence, 1e-3, 1e6);
  dial.size(guard.health.bias_threshold, 1e-3, 1e3);
  dial.size(guard.health.bias_slack, 1e-6, 1e3);
  dial.size(guard.health.largest_innovation, 1e-3, 1e6);
  dial.size(guard.health.memory, 1e-6, 1e6);
  dial.size(guard.health.largest_scale, 1.001, 1e6);
  dial.size(guard.health.least_scale, 1.0, 1e6);
  dial.size(guard.health.noise_release, 1.001, 1e3);
  dial.size(guard.health.bias_release, 1e-6, 1e3);
  dial.size(guard.health.least_exclusion, 0.0, 1e6);
  dial.size(guard.clock.memory, 1e-6, 1e6);
  dial.size(guard.clock.significance, 1e-3, 1e3);
  dial.size(guard.clock.least, 0.0, 1e3);
}

void turn(Dial& dial, core::LifecycleParams& life) {
  dial.flag(life.by_existence);
  dial.count(life.confirm_scans, 1, 100);
  life.confirm_hits = std::min(life.confirm_hits, life.confirm_scans);
  dial.count(life.confirm_hits, 1, life.confirm_scans);
  dial.share(life.confirm_existence, 1e-9, 1.0 - 1e-9);
  dial.share(life.show_existence, 0.0, 0.999);
  dial.size(life.presence.mean_life, 1e-6, 1e9);
  dial.size(life.presence.mean_shown, 1e-6, 1e9);
  dial.size(life.presence.mean_hidden, 1e-6, 1e9);
  dial.size(life.presence.mean_patience, 1e-6, 1e9);
  dial.count(life.coast_misses, 1, 1000);
  dial.size(life.coast_silence, 1e-6, 1e6);
  dial.count(life.delete_misses, 1, 1000);
  dial.size(life.delete_silence, 1e-6, 1e6);
  dial.size(life.remember, 0.0, 1e6);
  dial.size(life.max_spread, 1.001, 1e9);
  dial.count(life.merge_scans, 1, 1000);
}

}  // namespace

core::EstimatorParams randomEstimator(RandomInput& input) {
  core::EstimatorParams params;
  params.kind =
      static_cast<core::EstimatorKind>(input.between(0, static_cast<int>(core::estimatorTable().size()) - 1));
  params.twbls_form = input.oneOf({core::EstimatorForm::paper, core::EstimatorForm::consistent});
  params.noga_form = input.oneOf({core::EstimatorForm::paper, core::EstimatorForm::consistent});
  Dial dial = dialOf(input);
  turn(dial, params);
  return params;
}

core::LocalTrackerParams randomTracker(RandomInput& input) {
  core::LocalTrackerParams params;
  params.estimator = randomEstimator(input);
  params.association = input.oneOf({core::AssociationMethod::nearest, core::AssociationMethod::jpda});
  Dial dial = dialOf(input);
  dial.share(params.gate.probability, 1e-6, 1.0 - 1e-9);
  dial.choice(params.gate.shape, 2);
  dial.size(params.gate.max_half_width, 1e-6, 1e3);
  dial.size(params.gate.min_half_width, 0.0, params.gate.max_half_width);
  params.gate.min_half_width = std::min(params.gate.min_half_width, params.gate.max_half_width);
  dial.flag(params.adapt_gate);
  turn(dial, params.lifecycle);
  dial.share(params.detection.probability, 0.0, 1.0);
  dial.size(params.detection.clutter_density, 0.0, 1e9);
  dial.size(params.detection.memory, 10.0, 1e6);
  dial.size(params.detection.births, 1e-9, 1e9);
  dial.size(params.detection.first_targets, 1e-9, 1e9);
  const core::NoiseLearningParams& noise = params.estimator.twbls_consistent.noise;
  params.noise_calibration.enabled = noise.enabled;
  params.noise_calibration.min_scale = noise.min_scale;
  params.noise_calibration.max_scale = noise.max_scale;
  turn(dial, params.guard);
  dial.size(params.max_lag, 0.0, 10.0);
  params.max_tracks = input.oneOf({1, 7, 60, 1000});
  params.max_sightings = input.oneOf({1, 50, 10000});
  return params;
}

core::TrackFusionParams randomFusion(RandomInput& input) {
  core::TrackFusionParams params;
  params.rule =
      static_cast<core::FusionRule>(input.between(0, static_cast<int>(core::fusionRuleTable().size()) - 1));
  params.intersection_weights =
      input.oneOf({core::IntersectionWeights::determinant, core::IntersectionWeights::trace});
  params.tracklets.estimator = randomEstimator(input);
  Dial dial = dialOf(input);
  dial.share(params.gate_probability, 1e-9, 1.0 - 1e-9);
  dial.size(params.leave_factor, 1.0, 1e6);
  dial.size(params.leave_after, 0.0, 1e6);
  dial.size(params.registration_sigma, 0.0, 10.0);
  dial.size(params.process_noise, 0.0, 1e6);
  dial.size(params.coasting_age, 0.0, 1e6);
  dial.size(params.delete_after, 0.0, 1e3);
  dial.size(params.remember, 0.0, 1e3);
  dial.flag(params.allow_shared_sensors);
  params.max_tracks = input.oneOf({1, 20, 1000});
  dial.size(params.reports.max_age, 1e-3, 1e3);
  params.reports.forget_after = std::max(params.reports.forget_after, params.reports.max_age);
  dial.size(params.reports.forget_after, params.reports.max_age, 1e6);
  params.reports.max_trackers = input.oneOf({1, 6, 128});
  params.reports.max_tracks = input.oneOf({1, 20, 1000});
  dial.size(params.tracklets.max_lag, 1e-3, 10.0);
  dial.size(params.tracklets.memory, 1e-3, 1e3);
  dial.share(params.tracklets.max_missing, 0.0, 1.0);
  turn(dial, params.tracklets.guard);
  return params;
}

core::PositionTrackerParams randomPositions(RandomInput& input) {
  core::PositionTrackerParams params;
  core::PositionSceneParams& scene = params.scene;
  Dial dial = dialOf(input);
  dial.size(params.max_lag, 0.0, 10.0);
  dial.share(scene.estimator.max_relative_sigma, 1e-6, 0.999);
  scene.hypotheses.max_relative_sigma = scene.estimator.max_relative_sigma;
  scene.estimator.lost_relative_sigma =
      std::max(scene.estimator.lost_relative_sigma, 1.001 * scene.estimator.max_relative_sigma);
  for (core::PositionModel& model : scene.estimator.models) {
    dial.choice(model.kind, 2);
    dial.size(model.ratio, 0.0, 1e9);
  }
  if (dial.now()) scene.estimator.models.resize(1);
  dial.size(scene.estimator.dwell, 1e-3, 1e6);
  dial.size(scene.estimator.scale_memory, 1e-3, 1e6);
  dial.size(scene.estimator.outlier_distance, 1.0, 1e6);
  dial.size(scene.estimator.alone_after, 1e-3, 1e6);
  dial.size(scene.estimator.alone_intervals, 1e-3, 1e6);
  dial.size(scene.estimator.start_window, 1e-3, 1e3);
  dial.share(scene.estimator.fast_share, 0.0, 2.0);
  dial.size(scene.estimator.fast_time, 1e-6, 1e3);
  dial.size(scene.hypotheses.gate, 1e-3, 1e3);
  dial.share(scene.hypotheses.detection_probability, 1e-6, 1.0 - 1e-6);
  dial.size(scene.hypotheses.memory, 1e-3, 1e6);
  dial.size(scene.hypotheses.correlation_time, 1e-6, 1e6);
  dial.size(scene.hypotheses.least_score, 0.0, 1e3);
  dial.size(scene.hypotheses.least_margin, 0.0, 1e3);
  dial.size(scene.hypotheses.least_fit_margin, 0.0, 1e3);
  dial.count(scene.hypotheses.most_candidates, 1, 20000);
  dial.size(scene.noise.slow_scale, 0.0, 1e6);
  dial.size(scene.noise.time_constant, 1e-3, 1e6);
  dial.size(scene.noise.safety, 1e-3, 1e3);
  dial.size(scene.noise.memory, 1e-3, 1e6);
  dial.size(scene.noise.prior_weight, 0.0, 1e6);
  dial.flag(scene.noise.learn_time);
  dial.size(scene.decision_interval, 1e-2, 1e3);
  dial.size(scene.claim_gate, 1e-3, 1e6);
  dial.count(scene.claim_decisions, 1, 100);
  dial.size(scene.contradiction, 1e-3, 1e6);
  dial.size(scene.contradiction_time, 1e-3, 1e3);
  dial.size(scene.merge_gate, 1e-3, 1e6);
  dial.size(scene.confirm_after, 0.0, 1e3);
  dial.size(scene.confirm_pair_after, 0.0, 1e3);
  dial.size(scene.coast_after, 1e-3, 1e3);
  dial.size(scene.delete_after, 1e-3, 1e3);
  dial.size(scene.remember_for, 0.0, 1e3);
  scene.max_local_tracks = input.oneOf({1, 50, 4000});
  scene.max_targets = input.oneOf({1, 20, 1000});
  return params;
}

}  // namespace sightline_fuzz
