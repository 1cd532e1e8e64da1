#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace sightline::bench {

/// The value that a share in [0, 1] of the values lies below: of n values in ascending order the one with
/// index floor(share n), the last one at most. NaN without values.
inline double quantile(std::vector<double> values, double share) {
  if (values.empty()) return std::nan("");
  const auto index =
      std::min(values.size() - 1, static_cast<std::size_t>(share * static_cast<double>(values.size())));
  const auto place = values.begin() + static_cast<std::ptrdiff_t>(index);
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

/// Of an even number of values the upper one of the two in the middle. NaN without values.
inline double median(const std::vector<double>& values) {
  return quantile(values, 0.5);
}

}  // namespace sightline::bench
