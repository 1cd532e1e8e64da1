#include "sightline/core/fusion/association/tracker_misalignment.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace sightline::core {
namespace {

constexpr std::size_t kLeastTargets = 3;
constexpr std::size_t kMostTrackers = 256;
constexpr double kMemory = 0.05;      // share of a report
constexpr double kMedian = 1.386294;  // of chi^2 with two degrees of freedom
constexpr double kLeastShare = 0.1;   // of the covariances' variance, below which there is nothing to tell

double signedMedian(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

void TrackerMisalignment::take(const std::string& tracker, const std::vector<Disagreement>& disagreements) {
  if (disagreements.size() < kLeastTargets) return;
  std::vector<double> distances, variances;
  for (const Disagreement& it : disagreements) {
    distances.push_back(it.distance_squared);
    variances.push_back(it.variance);
  }
  const double seen = signedMedian(distances) / kMedian, explained = signedMedian(variances);
  const double excess = std::max(seen - (1.0 + kLeastShare) * explained, 0.0);
  if (variances_.size() >= kMostTrackers && variances_.count(tracker) == 0) {  // forgets who is off least
    variances_.erase(std::min_element(variances_.begin(), variances_.end(),
                                      [](const auto& a, const auto& b) { return a.second < b.second; }));
  }
  double& variance = variances_[tracker];
  variance += kMemory * (excess - variance);
}

double TrackerMisalignment::sigma(const std::string& tracker) const {
  const auto known = variances_.find(tracker);
  return std::sqrt(least_ * least_ + (known == variances_.end() ? 0.0 : known->second));
}

double TrackerMisalignment::largestSigma() const {
  double largest = 0.0;
  for (const auto& [tracker, variance] : variances_) largest = std::max(largest, variance);
  return std::sqrt(least_ * least_ + largest);
}

}  // namespace sightline::core
