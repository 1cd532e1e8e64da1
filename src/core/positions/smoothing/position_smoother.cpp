#include "sightline/core/positions/smoothing/position_smoother.h"

#include <algorithm>
#include <cstddef>
#include <stdexcept>
#include <string>

namespace sightline::core {
namespace {

constexpr std::size_t kBlock = 512;  // measurements whose steps are kept at once
constexpr double kBatch = 0.5;       // times within so much of a lag are smoothed at once

using Measurements = std::vector<StationMeasurement>;
using Positions = std::vector<std::optional<SmoothedPosition>>;

/// What the filter made of a measurement.
struct Arrival {
  MeasurementUse use = MeasurementUse::refused;
  std::optional<PositionStep> step;
};

/// The filter on its way forward.
struct ForwardPass {
  PositionEstimator estimator;
  std::size_t next = 0;  ///< measurement

  Arrival advance(const Measurements& measurements) {
    Arrival arrival;
    arrival.use = estimator.updateWithStep(measurements[next++], arrival.step);
    return arrival;
  }
};

/// All times of a window by all measurements of it.
class Window {
 public:
  /// From a state of the filter up to the measurement `end`; of the times those from `first` up to `last`.
  Window(const std::vector<PositionModel>& models, const Measurements& measurements,
         const std::vector<Time>& times, Positions& positions)
      : models_(models), measurements_(measurements), times_(times), positions_(positions) {}

  void run(ForwardPass forward, std::size_t end, std::size_t first, std::size_t last) {
    first_ = first;
    query_ = last;
    const std::size_t begin = forward.next;
    std::vector<ForwardPass> starts;
    std::vector<Arrival> arrivals;
    while (forward.next < end) {
      if ((forward.next - begin) % kBlock == 0) {
        starts.push_back(forward);
        arrivals.clear();
      }
      arrivals.push_back(forward.advance(measurements_));
    }
    if (forward.estimator.hasState()) {
      predictAfter(forward.estimator);
      later_ = nothingLater(forward.estimator.standingStep());
      at_ = *forward.estimator.time();
    }
    for (std::size_t block = starts.size(); block-- > 0;) {
      if (block + 1 < starts.size()) {
        arrivals.clear();
        for (ForwardPass& again = starts[block]; again.next < begin + (block + 1) * kBlock;)
          arrivals.push_back(again.advance(measurements_));
      }
      for (std::size_t k = arrivals.size(); k-- > 0;)
        goBack(arrivals[k], measurements_[begin + block * kBlock + k].time);
    }
    if (later_) answerHere();
  }

 private:
  bool isOpen() const { return query_ > first_; }
  Time time() const { return times_[query_ - 1]; }

  void predictAfter(const PositionEstimator& estimator) {
    for (; isOpen() && time() > *estimator.time(); --query_) {
      const auto state = estimator.stateAt(time());
      if (state) positions_[query_ - 1] = SmoothedPosition{state->mean, state->covariance};
    }
  }

  /// At the time to which the way back has come.
  void answerHere() {
    for (; isOpen() && time() >= at_; --query_)
      if (time() == at_) positions_[query_ - 1] = positionOf(*later_);
  }

  /// Over the measurement at `here`.
  void goBack(const Arrival& arrival, Time here) {
    if (arrival.use == MeasurementUse::started) {
      if (later_) answerHere();
      later_.reset();
    }
    if (!arrival.step) return;
    if (later_) answerHere();
    const PositionStep& step = *arrival.step;
    const Time before = here - durationOf(step.h);
    for (; isOpen() && time() > before; --query_) {
      if (time() >= here) continue;  // given up there, and not yet started anew
      const PositionStep rest = remainderOf(step, models_, seconds(time() - before));
      positions_[query_ - 1] = positionOf(later_ ? smoothedBack(rest, models_, *later_) : nothingLater(rest));
    }
    later_ = later_ ? smoothedBack(step, models_, *later_) : nothingLater(step);
    at_ = before;
  }

  const std::vector<PositionModel>& models_;
  const Measurements& measurements_;
  const std::vector<Time>& times_;
  Positions& positions_;
  std::size_t first_ = 0, query_ = 0;          // times from first_ up to query_ are still open
  std::optional<SmoothedPositionBank> later_;  // what is known ...
  Time at_{};                                  // ... then
};

/// Number of measurements not after `time`.
std::size_t countUpTo(const Measurements& measurements, Time time) {
  const auto after = std::upper_bound(measurements.begin(), measurements.end(), time,
                                      [](Time t, const StationMeasurement& m) { return t < m.time; });
  return static_cast<std::size_t>(after - measurements.begin());
}

}  // namespace

PositionSmoother::PositionSmoother(const PositionEstimatorParams& params) : params_(params) {
  PositionEstimator refuses_what_cannot_work(params);
}

Positions PositionSmoother::smooth(const Measurements& measurements, const std::vector<Time>& times,
                                   std::optional<double> lag) const {
  const auto isEarlier = [](const StationMeasurement& a, const StationMeasurement& b) {
    return a.time < b.time;
  };
  if (!std::is_sorted(measurements.begin(), measurements.end(), isEarlier) ||
      !std::is_sorted(times.begin(), times.end()) || (lag && !(*lag >= 0.0))) {
    throw std::invalid_argument(
        "PositionSmoother: measurements and times in order of time and a lag >= 0 s are required" +
        (lag ? ", got a lag of " + std::to_string(*lag) + " s" : std::string()));
  }
  Positions positions(times.size());
  Window window(params_.models, measurements, times, positions);
  ForwardPass base{PositionEstimator(params_)};
  if (!lag) {
    window.run(base, measurements.size(), 0, times.size());
    return positions;
  }
  for (std::size_t first = 0, last = 0; first < times.size(); first = last) {
    while (last < times.size() && seconds(times[last] - times[first]) <= kBatch * *lag) ++last;
    const std::size_t before = countUpTo(measurements, times[first]);
    while (base.next < before) base.advance(measurements);
    window.run(base, countUpTo(measurements, times[last - 1] + durationOf(*lag)), first, last);
  }
  return positions;
}

}  // namespace sightline::core
