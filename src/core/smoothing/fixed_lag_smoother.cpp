#include "sightline/core/smoothing/fixed_lag_smoother.h"

#include <algorithm>
#include <cstddef>

namespace sightline::core {

FixedLagSmoother::FixedLagSmoother(const NogaConsistentParams& bank)
    : models_(bank.models), filter_{NogaConsistentEstimator(bank)} {}

bool FixedLagSmoother::take(const TakenSighting& sighting) {
  if (answered_ && sighting.tracklet.time <= *answered_) return false;
  const auto place =
      std::upper_bound(sightings_.begin(), sightings_.end(), sighting.tracklet.time,
                       [](Time time, const TakenSighting& known) { return time < known.tracklet.time; });
  sightings_.insert(place, sighting);
  return true;
}

std::vector<std::optional<AngularState>> FixedLagSmoother::answer(const std::vector<Time>& times, Time end) {
  ChartedSightings window = charted_;
  for (const TakenSighting& sighting : sightings_) window.add(sighting);
  std::vector<std::optional<SmoothedMotion>> motions(times.size());
  if (!window.measurements().empty() && !times.empty())
    motions = smoothedFrom(filter_, models_, window.measurements(), times);
  std::vector<std::optional<AngularState>> states(times.size());
  std::size_t passed = 0;  // sightings
  const auto passTo = [&](Time time) {
    for (; passed < sightings_.size() && sightings_[passed].tracklet.time <= time; ++passed)
      slow_errors_.note(sightings_[passed]);
  };
  for (std::size_t i = 0; i < times.size(); ++i) {
    passTo(times[i]);
    if (motions[i])
      states[i] = stateIn(window.chartOf(motions[i]->chart_of), *motions[i], slow_errors_, times[i]);
  }
  passTo(end);
  answered_ = end;
  if (passed == 0) return states;
  advanceBy(filter_, window.measurements(), passed);  // to the last sighting up to the end
  charted_ = window.only(filter_.next - 1);
  filter_.next = 1;
  sightings_.erase(sightings_.begin(), sightings_.begin() + static_cast<std::ptrdiff_t>(passed));
  return states;
}

}  // namespace sightline::core
