#include "sightline/core/fusion/reports/reported_states.h"

#include <algorithm>
#include <cmath>

namespace sightline::core {
namespace {

constexpr std::size_t kMostReports = 32;
constexpr double kLeastInterval = 1.0 / 30.0 - 1e-3;  // [s]; stamps of thirty a second are not even

}  // namespace

void ReportedStates::add(const ReportedState& reported) {
  if (ring_.empty()) ring_.reserve(kMostReports);
  if (!ring_.empty()) {
    const ReportedState& last = ring_[(next_ + ring_.size() - 1) % ring_.size()];
    if (seconds(reported.time - last.time) < kLeastInterval) return;
  }
  if (ring_.size() < kMostReports) {
    ring_.push_back(reported);
    return;
  }
  ring_[next_] = reported;
  next_ = (next_ + 1) % kMostReports;
}

const ReportedState* ReportedStates::nearest(Time time) const {
  const auto found =
      std::min_element(ring_.begin(), ring_.end(), [time](const ReportedState& a, const ReportedState& b) {
        return std::abs(seconds(a.time - time)) < std::abs(seconds(b.time - time));
      });
  return found == ring_.end() ? nullptr : &*found;
}

}  // namespace sightline::core
