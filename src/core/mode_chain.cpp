#include "sightline/core/mode_chain.h"

#include <stdexcept>
#include <string>

namespace sightline::core {
namespace {

constexpr double kFloor = 1e-12;  // a mode of less could not come back

}  // namespace

ModeChain::ModeChain(int modes, double dwell) : dwell_(dwell) {
  if (modes < 1 || modes > kMaxModes || !(dwell > 0.0)) {
    throw std::invalid_argument("ModeChain: 1 to " + std::to_string(kMaxModes) +
                                " modes and a dwell above 0 s are required, got " + std::to_string(modes) +
                                " and " + std::to_string(dwell));
  }
  probabilities_.setConstant(modes, 1.0 / modes);
}

ModeChain::Transition ModeChain::transition(double h) const {
  const auto others = static_cast<double>(probabilities_.size() - 1);
  if (others == 0.0) return {1.0, 0.0};
  const double stay = std::exp(-std::abs(h) / dwell_);
  return {stay, (1.0 - stay) / others};
}

ModeArray ModeChain::predicted(double h) const {
  const Transition t = transition(h);
  return t.stay * probabilities_ + t.leave * (1.0 - probabilities_);
}

ModeMatrix ModeChain::mixing(double h) const {
  const Transition t = transition(h);
  ModeMatrix weights = (t.leave * probabilities_).replicate(1, probabilities_.size());
  weights.matrix().diagonal() = t.stay * probabilities_.matrix();
  for (auto column : weights.colwise()) column /= column.sum();
  return weights;
}

void ModeChain::update(double h, const ModeArray& log_likelihoods) {
  probabilities_ = predicted(h) * (log_likelihoods - log_likelihoods.maxCoeff()).exp();
  probabilities_ = (probabilities_ / probabilities_.sum()).max(kFloor);
  probabilities_ /= probabilities_.sum();
}

}  // namespace sightline::core
