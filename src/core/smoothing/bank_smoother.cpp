#include "sightline/core/smoothing/bank_smoother.h"

#include <algorithm>
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

Arrival advance(BankFilter& filter, const Sightings& sightings) {
  const ChartedMeasurement& sighting = sightings[filter.next];
  NogaConsistentEstimator& estimator = filter.estimator;
  if (filter.next > 0 && sighting.R_new_old) estimator.rotate(*sighting.R_new_old);
  Arrival arrival;
  if (filter.next > 0 && estimator.startsAnewAt(sighting.measurement.time))
    arrival.ended = std::make_unique<NogaConsistentEstimator>(estimator);
  arrival.step = estimator.updateWithStep(sighting.measurement);
  ++filter.next;
  return arrival;
}

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

/// All times of a window by all sightings of it.
class Window {
 public:
  Window(const std::vector<ResponseModel>& models, const Sightings& sightings, const std::vector<Time>& times,
         Motions& motions)
      : models_(models), sightings_(sightings), times_(times), motions_(motions) {}

  /// From a filter up to the sighting `end`; of the times those from `first` up to `last`.
  void run(BankFilter forward, std::size_t end, std::size_t first, std::size_t last) {
    first_ = first;
    query_ = last;
    const std::size_t begin = forward.next;
    std::vector<BankFilter> starts;
    std::vector<Arrival> arrivals;
    arrivals.reserve(std::min(kBlock, end - begin));
    while (forward.next < end) {
      if ((forward.next - begin) % kBlock == 0) {
        starts.push_back(forward);
        arrivals.clear();
      }
      arrivals.push_back(advance(forward, sightings_));
    }
    const std::size_t newest = end - 1;
    for (; isOpen() && time() > sightings_[newest].measurement.time; --query_)
      motions_[query_ - 1] = predictedAt(forward.estimator, time(), newest);
    BackwardPass back(models_, sightings_, forward.estimator, newest);
    for (std::size_t block = starts.size(); block-- > 0;) {
      if (block + 1 < starts.size()) {
        arrivals.clear();
        for (BankFilter& again = starts[block]; again.next < begin + (block + 1) * kBlock;)
          arrivals.push_back(advance(again, sightings_));
      }
      goBack(back, arrivals, begin + block * kBlock);
    }
    answerAt(back);
  }

 private:
  bool isOpen() const { return query_ > first_; }
  Time time() const { return times_[query_ - 1]; }

  void answerAt(const BackwardPass& back) {
    const Time here = sightings_[back.at()].measurement.time;
    for (; isOpen() && time() == here; --query_) motions_[query_ - 1] = back.motion();
  }

  /// Over the sightings from `first` on, of which the arrivals are given, to the one before.
  void goBack(BackwardPass& back, const std::vector<Arrival>& arrivals, std::size_t first) {
    while (true) {
      answerAt(back);
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

  const std::vector<ResponseModel>& models_;
  const Sightings& sightings_;
  const std::vector<Time>& times_;
  Motions& motions_;
  std::size_t first_ = 0, query_ = 0;  // times from first_ up to query_ are still open
};

/// Each time by the sightings up to `lag` later, or somewhat more: one way back for a batch of times.
void smoothWithLag(const NogaConsistentParams& params, const Sightings& sightings,
                   const std::vector<Time>& times, double lag, Motions& motions) {
  Window window(params.models, sightings, times, motions);
  BankFilter filter{NogaConsistentEstimator(params)};
  std::size_t first = 0;
  while (first < times.size() && times[first] < sightings.front().measurement.time) ++first;
  for (std::size_t last = first; first < times.size(); first = last) {
    while (last < times.size() && seconds(times[last] - times[first]) <= kLagBatch * lag) ++last;
    const std::size_t before = lastUpTo(sightings, times[first]);
    while (filter.next <= before) advance(filter, sightings);
    window.run(filter, lastUpTo(sightings, times[last - 1] + durationOf(lag)) + 1, first, last);
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
    Window(params_.models, sightings, times, motions)
        .run({NogaConsistentEstimator(params_)}, sightings.size(), 0, times.size());
  return motions;
}

void advanceBy(BankFilter& filter, const Sightings& sightings, std::size_t count) {
  for (const std::size_t end = filter.next + count; filter.next < end;) advance(filter, sightings);
}

Motions smoothedFrom(const BankFilter& filter, const std::vector<ResponseModel>& models,
                     const Sightings& sightings, const std::vector<Time>& times) {
  Motions motions(times.size());
  Window(models, sightings, times, motions).run(filter, sightings.size(), 0, times.size());
  return motions;
}

}  // namespace sightline::core
