#include "sightline/core/smoothing/bank_smoother.h"

#include <algorithm>
#include <deque>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>

#include "sightline/core/smoothing/bank_smoothing.h"

namespace sightline::core {
namespace {

constexpr std::size_t kBlock = 4096;  // sightings whose steps are kept at once

using Motions = std::vector<std::optional<SmoothedMotion>>;
using Sightings = std::vector<ChartedMeasurement>;

/// How the filter came to a sighting.
struct Arrival {
  std::optional<BankStep> step;                    // from the sighting before, in the chart of this one
  std::unique_ptr<NogaConsistentEstimator> ended;  // no step: the filter before it started anew, likewise
};

/// The filter on its way forward.
class ForwardPass {
 public:
  ForwardPass(const NogaConsistentParams& params, const Sightings& sightings)
      : sightings_(&sightings), estimator_(params) {}

  std::size_t next() const { return next_; }  ///< sighting
  const NogaConsistentEstimator& estimator() const { return estimator_; }

  Arrival advance() {
    const ChartedMeasurement& sighting = (*sightings_)[next_];
    if (next_ > 0 && sighting.R_new_old) estimator_.rotate(*sighting.R_new_old);
    Arrival arrival;
    if (next_ > 0 && estimator_.startsAnewAt(sighting.measurement.time))
      arrival.ended = std::make_unique<NogaConsistentEstimator>(estimator_);
    arrival.step = estimator_.updateWithStep(sighting.measurement);
    ++next_;
    return arrival;
  }

 private:
  const Sightings* sightings_;
  NogaConsistentEstimator estimator_;
  std::size_t next_ = 0;
};

SmoothedMotion motionAt(const SmoothedBank& smoothed, std::size_t chart_of) {
  return {motionOf(smoothed), chart_of, noiseOf(smoothed)};
}

SmoothedMotion predictedAt(const NogaConsistentEstimator& estimator, Time time, std::size_t chart_of) {
  return {*estimator.stateAt(time), chart_of, estimator.noiseScale()};
}

/// The smoother on its way back, from a sighting of which the filter has just come.
class BackwardPass {
 public:
  BackwardPass(const std::vector<ResponseModel>& models, const Sightings& sightings,
               const NogaConsistentEstimator& estimator, std::size_t from)
      : models_(models), sightings_(sightings), later_(nothingLater(estimator)), at_(from) {}

  std::size_t at() const { return at_; }  ///< sighting

  /// The motion at a time between the sighting before and this one.
  SmoothedMotion motionBetween(const Arrival& arrival, Time time) const {
    if (!arrival.step) return predictedAt(*arrival.ended, time, at_);
    const double h = seconds(time - sightings_[at_ - 1].measurement.time);
    return motionAt(smoothedBack(remainderOf(*arrival.step, models_, h), models_, later_), at_);
  }

  /// Goes back to the sighting before.
  void goBack(const Arrival& arrival) {
    later_ = arrival.step ? smoothedBack(*arrival.step, models_, later_) : nothingLater(*arrival.ended);
    if (const auto& R_new_old = sightings_[at_].R_new_old) turn(later_, R_new_old->transpose());
    --at_;
  }

  /// The motion at the sighting.
  SmoothedMotion motion() const { return motionAt(later_, at_); }

 private:
  const std::vector<ResponseModel>& models_;
  const Sightings& sightings_;
  SmoothedBank later_;
  std::size_t at_;
};

/// Number of the last sighting not after `time`; there is one.
std::size_t lastUpTo(const Sightings& sightings, Time time) {
  const auto after = std::upper_bound(
      sightings.begin(), sightings.end(), time,
      [](Time t, const ChartedMeasurement& sighting) { return t < sighting.measurement.time; });
  return static_cast<std::size_t>(after - sightings.begin()) - 1;
}

/// All times by all sightings.
class FixedInterval {
 public:
  FixedInterval(const NogaConsistentParams& params, const Sightings& sightings,
                const std::vector<Time>& times, Motions& motions)
      : params_(params), sightings_(sightings), times_(times), motions_(motions), query_(times.size()) {}

  void run() {
    std::vector<ForwardPass> starts;
    ForwardPass forward(params_, sightings_);
    std::vector<Arrival> arrivals;
    arrivals.reserve(std::min(kBlock, sightings_.size()));
    while (forward.next() < sightings_.size()) {
      if (forward.next() % kBlock == 0) {
        starts.push_back(forward);
        arrivals.clear();
      }
      arrivals.push_back(forward.advance());
    }
    const std::size_t last = sightings_.size() - 1;
    for (; isOpen() && time() > sightings_[last].measurement.time; --query_)
      motions_[query_ - 1] = predictedAt(forward.estimator(), time(), last);
    BackwardPass back(params_.models, sightings_, forward.estimator(), last);
    for (std::size_t block = starts.size(); block-- > 0;) {
      if (block + 1 < starts.size()) {
        arrivals.clear();
        for (ForwardPass& again = starts[block]; again.next() < (block + 1) * kBlock;)
          arrivals.push_back(again.advance());
      }
      goBack(back, arrivals, block * kBlock);
    }
  }

 private:
  bool isOpen() const { return query_ > 0; }
  Time time() const { return times_[query_ - 1]; }

  /// Through the sightings from `first` on, of which the arrivals are given.
  void goBack(BackwardPass& back, const std::vector<Arrival>& arrivals, std::size_t first) {
    while (true) {
      const Time here = sightings_[back.at()].measurement.time;
      for (; isOpen() && time() == here; --query_) motions_[query_ - 1] = back.motion();
      if (back.at() == 0) return;
      const Arrival& arrival = arrivals[back.at() - first];
      const Time before = sightings_[back.at() - 1].measurement.time;
      for (; isOpen() && time() > before; --query_)
        motions_[query_ - 1] = back.motionBetween(arrival, time());
      const bool is_last = back.at() == first;
      back.goBack(arrival);
      if (is_last) return;
    }
  }

  const NogaConsistentParams& params_;
  const Sightings& sightings_;
  const std::vector<Time>& times_;
  Motions& motions_;
  std::size_t query_;  // times that are still open, of which the last is next
};

/// Each time by the sightings up to `lag` later.
void smoothWithLag(const NogaConsistentParams& params, const Sightings& sightings,
                   const std::vector<Time>& times, double lag, Motions& motions) {
  ForwardPass forward(params, sightings);
  std::deque<Arrival> arrivals;  // of the sightings from `first` on
  std::size_t first = 0;
  for (std::size_t q = 0; q < times.size(); ++q) {
    if (times[q] < sightings.front().measurement.time) continue;
    const std::size_t last = lastUpTo(sightings, times[q] + durationOf(lag));
    while (forward.next() <= last) arrivals.push_back(forward.advance());
    const std::size_t before = lastUpTo(sightings, times[q]);
    for (; first <= before && arrivals.size() > 1; ++first) arrivals.pop_front();
    if (before == last && times[q] > sightings[last].measurement.time) {
      motions[q] = predictedAt(forward.estimator(), times[q], last);
      continue;
    }
    BackwardPass back(params.models, sightings, forward.estimator(), last);
    while (back.at() > before + 1) back.goBack(arrivals[back.at() - first]);
    const bool is_between = times[q] > sightings[before].measurement.time;
    if (back.at() > before && is_between) {
      motions[q] = back.motionBetween(arrivals[back.at() - first], times[q]);
      continue;
    }
    if (back.at() > before) back.goBack(arrivals[back.at() - first]);
    motions[q] = back.motion();
  }
}

}  // namespace

BankSmoother::BankSmoother(const NogaConsistentParams& params) : params_(params) {
  NogaConsistentEstimator refuses_what_cannot_work(params);
}

std::vector<std::optional<SmoothedMotion>> BankSmoother::smooth(
    const std::vector<ChartedMeasurement>& sightings, const std::vector<Time>& times,
    std::optional<double> lag) const {
  const auto isEarlier = [](const ChartedMeasurement& a, const ChartedMeasurement& b) {
    return a.measurement.time < b.measurement.time;
  };
  if (!std::is_sorted(sightings.begin(), sightings.end(), isEarlier) ||
      !std::is_sorted(times.begin(), times.end()) || (lag && !(*lag >= 0.0))) {
    throw std::invalid_argument(
        "BankSmoother: sightings and times in order of time and a lag >= 0 s are required" +
        (lag ? ", got a lag of " + std::to_string(*lag) + " s" : std::string()));
  }
  Motions motions(times.size());
  if (sightings.empty()) return motions;
  if (lag)
    smoothWithLag(params_, sightings, times, *lag, motions);
  else
    FixedInterval(params_, sightings, times, motions).run();
  return motions;
}

}  // namespace sightline::core
