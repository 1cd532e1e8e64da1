#include "sightline/core/simulation/random_stream.h"

#include <cmath>

namespace sightline::core {
namespace {

constexpr double kTwoPi = 6.283185307179586477;

/// The output function of SplitMix64 (Steele, Lea, Flood 2014): a bijection that spreads every bit over all.
std::uint64_t mix(std::uint64_t z) {
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31);
}

}  // namespace

std::uint64_t seedOf(std::uint64_t seed, std::string_view name) {
  std::uint64_t hash = 0xcbf29ce484222325ULL;  // FNV-1a
  for (const char c : name) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
  return mix(mix(seed + 0x9e3779b97f4a7c15ULL) ^ hash);
}

std::uint64_t RandomStream::bits() {
  state_ += 0x9e3779b97f4a7c15ULL;
  return mix(state_);
}

double RandomStream::uniform() {
  return static_cast<double>(bits() >> 11) * 0x1p-53;
}

Eigen::Vector2d RandomStream::normalPair() {
  const double radius = std::sqrt(-2.0 * std::log1p(-uniform()));  // (S-84), Box and Muller 1958
  const double angle = kTwoPi * uniform();
  return {radius * std::cos(angle), radius * std::sin(angle)};
}

unsigned RandomStream::poisson(double mean) {
  // (S-84): arrivals of a process of rate one within `mean`; no product that could underflow.
  unsigned arrivals = 0;
  double elapsed = -std::log1p(-uniform());
  while (elapsed < mean) {
    ++arrivals;
    elapsed -= std::log1p(-uniform());
  }
  return arrivals;
}

}  // namespace sightline::core
