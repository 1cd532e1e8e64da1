#include "sightline/core/smoothing/smoothing_bank.h"

#include <stdexcept>
#include <string>
#include <vector>

namespace sightline::core {
namespace {

using Kind = ResponseModel::Kind;

/// A bank without what only NOGA has.
NogaConsistentParams bankWithout(double initial_rate_sigma) {
  NogaConsistentParams bank;
  bank.models.clear();
  bank.initial_rate_sigma = initial_rate_sigma;
  bank.outlier_share = bank.least_drawn = bank.left_out = 0.0;
  bank.noise.enabled = false;
  return bank;
}

/// White acceleration is that of straight flight; a steady acceleration with white jerk is a harmonic motion
/// whose frequency is known to be zero.
void add(const ProcessNoise& noise, Kind kind, NogaConsistentParams& bank) {
  const double amplitude = noise.density > 0.0 ? 1.0 : 0.0;
  if (!bank.models.empty() && amplitude != bank.amplitude) {
    throw std::invalid_argument(
        "smoothing: some process noises are absolute and some in proportion to the sightings' noise; give "
        "all as densities or all as ratios");
  }
  bank.amplitude = amplitude;
  ResponseModel model;
  model.kind = kind;
  model.q = noise.density > 0.0 ? noise.density : noise.ratio / (kSigmasOfAmplitude * kSigmasOfAmplitude);
  bank.models.push_back(model);
}

[[noreturn]] void refusePaper(const char* estimator) {
  throw std::invalid_argument(std::string("smoothing: ") + estimator +
                              " of form paper has no model of the motion by which to smooth; set form: "
                              "consistent, or another estimator");
}

NogaConsistentParams bankOf(const KalmanParams& params) {
  NogaConsistentParams bank = bankWithout(params.initial_rate_sigma);
  add({params.process_noise, params.process_noise_ratio}, Kind::straight, bank);
  return bank;
}

NogaConsistentParams bankOf(const ImmParams& params) {
  NogaConsistentParams bank = bankWithout(params.initial_rate_sigma);
  bank.dwell = params.dwell;
  for (const ImmModel& model : params.models)
    add(model.noise, model.order == 1 ? Kind::straight : Kind::fixed_harmonic, bank);
  return bank;
}

NogaConsistentParams bankOf(const TwblsConsistentParams& params) {
  NogaConsistentParams bank = bankWithout(params.initial_rate_sigma);
  bank.dwell = params.memory;
  bank.noise = params.noise;
  for (const ProcessNoise& noise : params.process_noises) add(noise, Kind::straight, bank);
  return bank;
}

}  // namespace

NogaConsistentParams smoothingBankOf(const EstimatorParams& params) {
  switch (params.kind) {
    case EstimatorKind::noga:
      if (params.noga_form == EstimatorForm::paper) refusePaper("noga");
      return params.noga_consistent;
    case EstimatorKind::twbls:
      if (params.twbls_form == EstimatorForm::paper) refusePaper("twbls");
      return bankOf(params.twbls_consistent);
    case EstimatorKind::kalman:
      return bankOf(params.kalman);
    case EstimatorKind::imm:
      return bankOf(params.imm);
  }
  throw std::invalid_argument("smoothing: unknown estimator");
}

}  // namespace sightline::core
