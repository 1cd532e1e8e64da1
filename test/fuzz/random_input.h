#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <utility>
#include <vector>

namespace sightline_fuzz {

/// Where a fuzz case takes its decisions from: a seed, or the bytes of a fuzzer, which come first and are
/// followed by numbers drawn from their sum. The same input makes the same case on every machine.
class RandomInput {
 public:
  explicit RandomInput(std::uint64_t seed) : state_(seed) {}
  RandomInput(const std::uint8_t* bytes, std::size_t size);

  std::uint64_t bits();
  double unit();  ///< in [0, 1)
  bool chance(double probability) { return unit() < probability; }
  int between(int first, int last);              ///< both may come
  double between(double first, double last);     ///< evenly
  double logBetween(double first, double last);  ///< evenly in the logarithm; both > 0
  double normal();                               ///< of variance 1, roughly, within 6
  double absurd();                               ///< NaN, infinite, denormal, huge, negative zero, ...

  template <typename Value>
  Value oneOf(std::initializer_list<Value> values) {
    return *(values.begin() + between(0, static_cast<int>(values.size()) - 1));
  }

  /// Fisher and Yates.
  template <typename Value>
  void shuffle(std::vector<Value>& values) {
    for (std::size_t i = values.size(); i > 1; --i)
      std::swap(values[i - 1], values[static_cast<std::size_t>(between(0, static_cast<int>(i) - 1))]);
  }

 private:
  std::uint64_t state_;
  const std::uint8_t* bytes_ = nullptr;
  std::size_t left_ = 0;  // of `bytes_`
};

}  // namespace sightline_fuzz
