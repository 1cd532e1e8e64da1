#include "sightline/core/simulation/sighting_sequence.h"

#include <cmath>
#include <sstream>

namespace sightline::core {
namespace {

constexpr double kShortestInterval = 1e-6;  // [s]
constexpr double kNanosecond = 1e9;         // [1/s]

/// The count-th exposure at a constant rate, without accumulating its rounding.
Duration fixedTime(std::int64_t count, double rate) {
  const auto whole_seconds = static_cast<std::int64_t>(std::floor(static_cast<double>(count) / rate));
  const double rest = static_cast<double>(count) - static_cast<double>(whole_seconds) * rate;
  return std::chrono::seconds(whole_seconds) + Duration(std::llround(rest / rate * kNanosecond));
}

}  // namespace

bool SightingTiming::operator==(const SightingTiming& other) const {
  return kind == other.kind && shortest == other.shortest && spread == other.spread && rate == other.rate &&
         first == other.first;
}

std::int64_t ticksOf(double rho, Duration shortest, Duration spread) {
  return 1 + static_cast<std::int64_t>(std::floor(rho * static_cast<double>(spread.count()) /
                                                  static_cast<double>(shortest.count())));  // (S-1)
}

double expectedRate(const SightingTiming& timing) {
  if (timing.kind == SightingTiming::Kind::fixed) return timing.rate;
  const double M = timing.spread / timing.shortest, m = std::floor(M);
  return 1.0 / (timing.shortest * (1.0 + m - m * (m + 1.0) / (2.0 * M)));  // 1 / E[dt] of (S-1)
}

SightingSequence::SightingSequence(const SightingTiming& timing, std::uint64_t seed)
    : timing_(timing), stream_(seed) {}

Duration SightingSequence::next() {
  const Duration first = durationOf(timing_.first);
  if (timing_.kind == SightingTiming::Kind::fixed) return first + fixedTime(count_++, timing_.rate);
  const Duration shortest = durationOf(timing_.shortest);
  const Duration time = first + ticks_ * shortest;
  ticks_ += ticksOf(stream_.uniform(), shortest, durationOf(timing_.spread));
  return time;
}

std::optional<Refusal> refusalOf(const SightingTiming& timing) {
  std::ostringstream why;
  if (!(timing.first >= 0.0) || !std::isfinite(timing.first)) {
    why << "the first exposure must be at or after 0 s, got " << timing.first;
  } else if (timing.kind == SightingTiming::Kind::fixed &&
             !(timing.rate > 0.0 && timing.rate <= 1.0 / kShortestInterval)) {
    why << "the rate must be in (0, 1e6] Hz, got " << timing.rate;
  } else if (timing.kind == SightingTiming::Kind::random &&
             !(timing.shortest >= kShortestInterval && timing.spread >= timing.shortest &&
               std::isfinite(timing.spread))) {
    why << "the random sequence needs 1e-6 s <= shortest <= spread, got " << timing.shortest << " s and "
        << timing.spread << " s";
  } else {
    return std::nullopt;
  }
  return Refusal{"timing", why.str()};
}

}  // namespace sightline::core
