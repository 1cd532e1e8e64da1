#include "sightline/core/evaluation/truth.h"

#include <algorithm>
#include <iterator>

#include "sightline/core/model/chart.h"

namespace sightline::core {
namespace {

Eigen::Vector4d inChart(const Chart& chart, const Eigen::Vector4d& motion) {
  AngularState state;
  state.mean = motion;
  return chart.fromTracking(state).mean;
}

Eigen::Vector4d fromChart(const Chart& chart, const Eigen::Vector4d& motion) {
  AngularState state;
  state.mean = motion;
  return chart.toTracking(state).mean;
}

/// Between two directions; the first when they are opposite and nothing is between them.
Eigen::Vector3d between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const Eigen::Vector3d sum = a + b;
  return sum.norm() > 1e-6 ? sum.normalized() : a;
}

/// Slope [1/s] from `from` to `to` in the chart of `from`.
Eigen::Vector2d slope(const TruthDirection& from, const TruthDirection& to, const Chart& chart) {
  const Eigen::Vector2d step =
      chart.coordinatesOf(directionOf(to.angles)) - chart.coordinatesOf(directionOf(from.angles));
  return step / seconds(to.time - from.time);
}

}  // namespace

std::optional<Eigen::Vector4d> interpolate(const TruthSample& before, const TruthSample& after, Time time) {
  const double length = seconds(after.time - before.time);
  const double s = seconds(time - before.time) / length;
  if (!(length > 0.0) || !(s >= 0.0) || !(s <= 1.0)) return std::nullopt;

  const Chart chart =
      Chart::around(between(directionOf(before.motion.head<2>()), directionOf(after.motion.head<2>())));
  const Eigen::Vector4d a = inChart(chart, before.motion), b = inChart(chart, after.motion);
  const Eigen::Vector2d step = b.head<2>() - a.head<2>();
  const Eigen::Vector2d a_slope = length * a.tail<2>(), b_slope = length * b.tail<2>();

  // The cubic p(s) = a + a_slope s + c2 s^2 + c3 s^3 with p(1) = b, p'(1) = b_slope.
  const Eigen::Vector2d c2 = 3.0 * step - 2.0 * a_slope - b_slope;
  const Eigen::Vector2d c3 = a_slope + b_slope - 2.0 * step;
  Eigen::Vector4d motion;
  motion.head<2>() = a.head<2>() + s * (a_slope + s * (c2 + s * c3));
  motion.tail<2>() = (a_slope + s * (2.0 * c2 + 3.0 * s * c3)) / length;
  return fromChart(chart, motion);
}

std::vector<TruthSample> withRates(const std::vector<TruthDirection>& directions, Duration largest_gap) {
  std::vector<TruthDirection> distinct;
  std::unique_copy(directions.begin(), directions.end(), std::back_inserter(distinct),
                   [](const TruthDirection& a, const TruthDirection& b) { return a.time == b.time; });

  std::vector<TruthSample> samples;
  samples.reserve(distinct.size());
  for (std::size_t i = 0; i < distinct.size(); ++i) {
    const TruthDirection& here = distinct[i];
    const Chart chart = Chart::around(directionOf(here.angles));
    const bool has_past = i > 0 && here.time - distinct[i - 1].time <= largest_gap;
    const bool has_future = i + 1 < distinct.size() && distinct[i + 1].time - here.time <= largest_gap;
    Eigen::Vector2d past = Eigen::Vector2d::Zero(), future = Eigen::Vector2d::Zero();
    if (has_past) past = slope(here, distinct[i - 1], chart);
    if (has_future) future = slope(here, distinct[i + 1], chart);

    Eigen::Vector4d motion;
    motion << chart.coordinatesOf(directionOf(here.angles)), past + future;  // one of them alone, or none
    if (has_past && has_future) {
      const double h_past = seconds(here.time - distinct[i - 1].time);
      const double h_future = seconds(distinct[i + 1].time - here.time);
      motion.tail<2>() = (h_future * past + h_past * future) / (h_past + h_future);
    }
    samples.push_back({here.time, fromChart(chart, motion)});
  }
  return samples;
}

void TruthPath::add(const TruthSample& sample) {
  auto place = std::upper_bound(samples_.begin(), samples_.end(), sample.time,
                                [](Time time, const Sample& other) { return time < other.truth.time; });
  if (place != samples_.begin() && std::prev(place)->truth.time == sample.time) {
    std::prev(place)->truth = sample;
    return;
  }
  Time piece_start = sample.time;
  if (place != samples_.begin() && sample.time - std::prev(place)->truth.time <= largest_gap_) {
    piece_start = std::prev(place)->piece_start;
  }
  place = samples_.insert(place, {sample, piece_start});

  // A late sample may close the gap before those that follow it.
  for (auto later = std::next(place); later != samples_.end(); ++later) {
    if (later->truth.time - std::prev(later)->truth.time > largest_gap_) break;
    later->piece_start = piece_start;
  }
}

void TruthPath::forgetBefore(Time time) {
  while (samples_.size() > 1 && samples_[1].truth.time <= time) samples_.pop_front();
  if (samples_.size() == 1 && samples_.front().truth.time < time) samples_.pop_front();
}

std::optional<TruthPath::Point> TruthPath::at(Time time) const {
  const auto after = std::lower_bound(samples_.begin(), samples_.end(), time,
                                      [](const Sample& sample, Time t) { return sample.truth.time < t; });
  if (after == samples_.end()) return std::nullopt;

  Point point;
  point.age = seconds(time - after->piece_start);
  if (after->truth.time == time) {
    point.state.mean = after->truth.motion;
    return point;
  }
  if (after == samples_.begin()) return std::nullopt;
  const TruthSample& before = std::prev(after)->truth;
  if (after->truth.time - before.time > largest_gap_) return std::nullopt;
  const auto motion = interpolate(before, after->truth, time);
  if (!motion) return std::nullopt;
  point.state.mean = *motion;
  return point;
}

}  // namespace sightline::core
