#include "sightline/core/sensors/recent_values.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace sightline::core {

RecentValues::RecentValues(std::size_t window) : window_(window) {
  if (window == 0) throw std::invalid_argument("RecentValues: a window of at least 1 is required");
}

void RecentValues::add(double value) {
  if (!std::isfinite(value)) return;
  if (values_.size() < window_) {
    values_.push_back(value);
    return;
  }
  values_[next_] = value;
  next_ = (next_ + 1) % window_;
}

std::optional<double> RecentValues::quantile(double p) const {
  if (values_.empty()) return std::nullopt;
  std::vector<double> sorted = values_;
  const double rank = std::ceil(std::clamp(p, 0.0, 1.0) * static_cast<double>(sorted.size())) - 1.0;
  const auto place = static_cast<std::ptrdiff_t>(std::max(rank, 0.0));
  std::nth_element(sorted.begin(), sorted.begin() + place, sorted.end());
  return sorted[static_cast<std::size_t>(place)];
}

}  // namespace sightline::core
