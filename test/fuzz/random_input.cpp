#include "fuzz/random_input.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sightline_fuzz {

RandomInput::RandomInput(const std::uint8_t* bytes, std::size_t size)
    : state_(size), bytes_(bytes), left_(size) {
  for (std::size_t i = 0; i < size; ++i) state_ = state_ * 0x100000001b3u + bytes[i];
}

/// SplitMix64 (Steele, Lea and Flood 2014), once the bytes are used up. Four bytes make a number: small
/// changes of a few bytes change a few decisions.
std::uint64_t RandomInput::bits() {
  if (left_ >= 4) {
    std::uint64_t taken = 0;
    for (int i = 0; i < 4; ++i) taken = taken << 8 | bytes_[i];
    bytes_ += 4;
    left_ -= 4;
    return taken << 32 | taken;
  }
  std::uint64_t z = state_ += 0x9e3779b97f4a7c15u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

double RandomInput::unit() {
  return static_cast<double>(bits() >> 11) * 0x1.0p-53;
}

int RandomInput::between(int first, int last) {
  const auto count = static_cast<double>(static_cast<std::int64_t>(last) - first + 1);
  return static_cast<int>(first + static_cast<std::int64_t>(unit() * count));
}

double RandomInput::between(double first, double last) {
  return first + unit() * (last - first);
}

double RandomInput::logBetween(double first, double last) {
  return std::clamp(std::exp(between(std::log(first), std::log(last))), first, last);
}

double RandomInput::normal() {
  double sum = -6.0;
  for (int i = 0; i < 12; ++i) sum += unit();
  return sum;
}

double RandomInput::absurd() {
  using Limits = std::numeric_limits<double>;
  return oneOf({Limits::quiet_NaN(),
                Limits::infinity(),
                -Limits::infinity(),
                Limits::denorm_min(),
                Limits::min(),
                Limits::max(),
                Limits::lowest(),
                Limits::epsilon(),
                -0.0,
                0.0,
                1.0,
                -1.0,
                1e-300,
                1e-160,
                1e-30,
                1e-18,
                1e-9,
                1e8,
                1e20,
                1e50,
                1e155,
                1e300,
                -1e-20,
                -1e9,
                -1e300,
                3.141592653589793,
                1.5707963267948966,
                9.223372036854775807e18,
                4294967296.0,
                -2147483649.0});
}

}  // namespace sightline_fuzz
