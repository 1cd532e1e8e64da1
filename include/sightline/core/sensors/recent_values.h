#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace sightline::core {

/// The last values of something (delays, intervals), and what is usual among them. Takes no more memory than
/// its window.
class RecentValues {
 public:
  /// `window`: so many values count, >= 1. Throws std::invalid_argument.
  explicit RecentValues(std::size_t window = 512);

  /// One that is not finite is left out.
  void add(double value);

  /// The value that a share `p` in [0, 1] of the window does not exceed: 0.5 is the median. None while there
  /// is nothing.
  std::optional<double> quantile(double p) const;

  std::size_t size() const { return values_.size(); }  ///< values in the window

 private:
  std::size_t window_;
  std::size_t next_ = 0;  // place of the oldest, once the window is full
  std::vector<double> values_;
};

}  // namespace sightline::core
