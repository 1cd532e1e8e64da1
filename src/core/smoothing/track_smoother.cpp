#include "sightline/core/smoothing/track_smoother.h"

#include <cstddef>

#include "sightline/core/smoothing/smoothing_bank.h"
#include "sightline/core/smoothing/track_charts.h"

namespace sightline::core {

TrackSmoother::TrackSmoother(const EstimatorParams& params) : smoother_(smoothingBankOf(params)) {}

std::vector<std::optional<AngularState>> TrackSmoother::smooth(const std::vector<TakenSighting>& sightings,
                                                               const std::vector<Time>& times,
                                                               std::optional<double> lag) const {
  ChartedSightings charted;
  for (const TakenSighting& sighting : sightings) charted.add(sighting);
  std::vector<std::optional<AngularState>> states;
  states.reserve(times.size());
  SlowErrors slow_errors;
  std::size_t next = 0, query = 0;
  for (const auto& motion : smoother_.smooth(charted.measurements(), times, lag)) {
    const Time time = times[query++];
    for (; next < sightings.size() && sightings[next].tracklet.time <= time; ++next)
      slow_errors.note(sightings[next]);
    states.emplace_back();
    if (motion) states.back() = stateIn(charted.chartOf(motion->chart_of), *motion, slow_errors, time);
  }
  return states;
}

}  // namespace sightline::core
