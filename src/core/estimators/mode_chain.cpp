#include "sightline/core/estimators/mode_chain.h"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>

namespace sightline::core {
namespace {

constexpr double kFloor = 1e-12;  // a mode of less could not come back

}  // namespace

ModeChain::ModeChain(const ModeArray& attraction, double dwell, double least_drawn)
    : dwell_(dwell), least_drawn_(least_drawn), attraction_(attraction) {
  if (!(least_drawn >= 0.0 && least_drawn < 1.0))
    throw std::invalid_argument("ModeChain: least_drawn in [0, 1) is required");
  if (attraction.size() < 1 || !(attraction.minCoeff() > 0.0) || !attraction.isFinite().all() ||
      !(dwell > 0.0)) {
    throw std::invalid_argument(
        "ModeChain: modes of finite attraction above 0 and a dwell above 0 s are required, got " +
        std::to_string(attraction.size()) + " modes and " + std::to_string(dwell) + " s");
  }
  attraction_ /= attraction_.sum();
  probabilities_ = attraction_;
}

/// That a mode is drawn anew; it may be the same again.
double ModeChain::drawnProbability(double h) const {  // (S-25)
  const auto modes = static_cast<double>(attraction_.size());
  if (modes == 1.0) return 0.0;
  return std::min(-std::expm1(-std::abs(h) / dwell_) * modes / (modes - 1.0), 1.0);
}

ModeArray ModeChain::predicted(double h) const {  // (S-25)
  const double drawn = drawnProbability(h);
  return (1.0 - drawn) * probabilities_ + drawn * attraction_;
}

ModeChain ModeChain::after(double h) const {
  ModeChain later = *this;
  later.probabilities_ = predicted(h);
  return later;
}

ModeArray ModeChain::ownShares(double h) const {  // (S-26)
  const ModeArray own = (1.0 - drawnProbability(h)) * probabilities_ / predicted(h);
  if (least_drawn_ == 0.0) return own;
  return (1.0 - own < least_drawn_).select(1.0, own);
}

void ModeChain::update(double h, const ModeArray& log_likelihoods) {  // (S-27)
  probabilities_ = predicted(h) * (log_likelihoods - log_likelihoods.maxCoeff()).exp();
  probabilities_ = (probabilities_ / probabilities_.sum()).max(kFloor);
  probabilities_ /= probabilities_.sum();
}

ModeArray likelyShares(const ModeArray& probabilities, double left_out) {  // (S-6)
  ModeArray likely = probabilities;
  if (left_out == 0.0) return likely;
  std::array<double, kMaxModes> ascending{};
  const auto end = std::copy_n(likely.data(), likely.size(), ascending.begin());
  std::sort(ascending.begin(), end);
  auto least = ascending.begin();  // that is not left out
  for (double rest = left_out - *least; rest >= 0.0; rest -= *least) ++least;
  for (Eigen::Index mode = 0; mode < likely.size(); ++mode)
    if (likely(mode) < *least) likely(mode) = 0.0;
  likely /= likely.sum();
  return likely;
}

}  // namespace sightline::core
