#pragma once

#include <cstdint>
#include <string_view>

#include <Eigen/Core>

namespace sightline::core {

/// A seed made from another seed and a name, the same on every machine. Different names give unrelated seeds.
std::uint64_t seedOf(std::uint64_t seed, std::string_view name);

/// A sequence of random numbers that depends on its seed alone, the same with every standard library (the
/// distributions of <random> are not). One stream for each purpose keeps the purposes independent: what one
/// draws does not move the others.
class RandomStream {
 public:
  explicit RandomStream(std::uint64_t seed) : state_(seed) {}

  /// The next 64 random bits.
  std::uint64_t bits();

  /// Uniform in [0, 1), a multiple of 2^-53.
  double uniform();

  /// Two independent standard normal numbers.
  Eigen::Vector2d normalPair();

  /// Poisson number of the given mean >= 0 [1]; the time it takes grows with the mean.
  unsigned poisson(double mean);

 private:
  std::uint64_t state_;
};

}  // namespace sightline::core
