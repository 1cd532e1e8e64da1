#include "sightline/core/association/existence.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace sightline::core {
namespace {

constexpr double kMostOfAScan = 1e4;  // one scan, however sharp, is one: its sigma may be wrong
constexpr double kLeast = 1e-12;      // of a probability: nothing is for ever

/// That something of rate 1 / mean_time happens within `duration`.
double chance(double duration, double mean_time) {
  return -std::expm1(-std::max(duration, 0.0) / mean_time);
}

}  // namespace

Existence::Existence(double odds)
    : odds_at_start_(odds), seen_(odds / (1.0 + odds)), none_(1.0 / (1.0 + odds)) {
  if (!(odds > 0.0) || !std::isfinite(odds))
    throw std::invalid_argument("Existence: odds > 0 are required, got " + std::to_string(odds));
}

void Existence::pass(double duration, const PresenceParams& presence) {  // (S-38)
  const double leaves = seen_ * chance(duration, presence.mean_life);
  const double hides = (seen_ - leaves) * chance(duration, presence.mean_shown);
  const double gives_up = hidden_ * chance(duration, presence.mean_patience);
  const double returns = (hidden_ - gives_up) * chance(duration, presence.mean_hidden);
  seen_ += returns - leaves - hides;
  hidden_ += hides - gives_up - returns;
  none_ += leaves + gives_up;
}

void Existence::weigh(double ratio) {  // (S-39)
  seen_ = std::max(seen_ * std::clamp(ratio, 1.0 / kMostOfAScan, kMostOfAScan), kLeast);
  const double sum = seen_ + hidden_ + std::max(none_, kLeast);
  none_ = std::max(none_, kLeast) / sum;
  seen_ /= sum;
  hidden_ /= sum;
}

double Existence::gain() const {  // (S-39)
  return (seen_ + hidden_) / (none_ * odds_at_start_);
}

}  // namespace sightline::core
