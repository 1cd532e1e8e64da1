#include "sightline/core/fusion/tracklets/guarded_estimator.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace sightline::core {
namespace {

constexpr int kMomentsPerRollBack = 8;
constexpr std::size_t kLeastTaken = 4;    // tracklets that make an estimate a yardstick
constexpr std::size_t kMostChanges = 64;  // that are remembered
constexpr std::size_t kMostSeen = 64;     // sensors
constexpr double kSeenMemory = 0.3;       // share of the newest innovation of a sensor in the running mean

/// Which of the equal parts of time it is in; with `length` 0 each instant is one.
std::int64_t partOf(Time time, double length) {
  const auto width = durationOf(length).count();
  return width > 0 ? time.time_since_epoch().count() / width : time.time_since_epoch().count();
}

Eigen::Vector2d innovationOf(const ChartedState& prediction, const Tracklet& tracklet) {
  return angleDifference(prediction.chart.coordinatesOf(tracklet.sighting.direction),
                         prediction.state.angles());
}

/// A tracklet against what was expected of it, in sigmas of that.
struct Residual {
  Eigen::Array2d u;
  double log_sigmas = 0.0;  // their sum
};

Residual residualOf(const ChartedEstimator& estimator, const Tracklet& tracklet) {
  const ChartedState prediction = estimator.predict(tracklet.time);
  const Eigen::Vector2d difference = innovationOf(prediction, tracklet);
  const Eigen::Array2d variance = prediction.state.anglesCovariance().diagonal() +
                                  prediction.chart.covarianceOf(tracklet.sighting).diagonal();
  return {difference.array() / variance.sqrt(), 0.5 * variance.log().sum()};
}

/// Residuals of one sensor.
struct Residuals {
  double count = 0.0;
  Eigen::Array2d sum = Eigen::Array2d::Zero();
  double squares = 0.0;

  void add(const Eigen::Array2d& u) {
    count += 1.0;
    sum += u;
    squares += u.square().sum();
  }

  /// Log likelihood by the bias or the noise that explains them best.
  double bestLikelihood() const {
    if (count == 0.0) return 0.0;
    const double by_bias = -0.5 * (squares - sum.square().sum() / count);
    const double variance = std::max(1.0, squares / (2.0 * count));
    const double by_noise = -0.5 * (2.0 * count * std::log(variance) + squares / variance);
    return std::max(by_bias, by_noise);
  }
};

}  // namespace

GuardedEstimator::GuardedEstimator(const EstimatorParams& estimator, const GuardParams& guard, double keep)
    : settings_(std::make_shared<Settings>(Settings{estimator, guard, std::max(keep, guard.roll_back)})),
      guard_(guard) {}

void GuardedEstimator::take(const Tracklet& next, const Past& past) {
  if (settings_->guard.enabled) {
    keepMoment(next.time);
    watch(next);
    const bool was_used = guard_.noiseScale(next.sensor) == 1.0;
    if (const auto change = guard_.judge(next.time, next.sensor)) {
      const bool is_harmful = change->change.verdict != SensorVerdict::healthy && !change->undecided;
      if (is_harmful && was_used && !isToBlame(*change, past)) {
        guard_.clearVerdict(next.time, next.sensor);
      } else {
        note(*change);
        if (is_harmful) goBack(next, *change, past);
      }
    }
  }
  settle(next, guard_.noiseScale(next.sensor));
}

/// Keeps what it is before the first tracklet of each part of time: which those are depends on the tracklets
/// alone, so that going back gives the same bits in whatever order they came.
void GuardedEstimator::keepMoment(Time next) {
  const double part = settings_->guard.roll_back / kMomentsPerRollBack;
  if (taken_ > 0 && partOf(next, part) == partOf(last_, part)) return;
  moments_.push_back(std::make_shared<Moment>(Moment{next, last_, taken_, estimator_, guard_, seen_}));
  const Time oldest = next - durationOf(settings_->keep);
  while (moments_.size() > 1 && moments_[1]->time <= oldest) moments_.pop_front();
  while (scales_.size() > taken_ - moments_.front()->taken) scales_.pop_front();
}

Corroboration GuardedEstimator::corroborationOf(const Tracklet& tracklet) const {
  Corroboration corroboration;
  std::array<std::array<double, kMostSeen>, 2> innovations;
  for (const Seen& seen : seen_) {
    const double silence = seconds(tracklet.time - seen.last);
    if (seen.sensor == tracklet.sensor) {
      corroboration.has_sensor = guard_.sees(silence);
    } else if (guard_.mayCorroborate(seen.sensor, silence)) {
      for (int channel = 0; channel < 2; ++channel)
        innovations[channel][corroboration.others] = seen.innovation(channel);
      ++corroboration.others;
    }
  }
  for (int channel = 0; channel < 2; ++channel)
    corroboration.shared(channel) = signedMedian(innovations[channel].data(), corroboration.others);
  return corroboration;
}

/// Shows the guard a tracklet beside what is expected of it, before it is taken.
void GuardedEstimator::watch(const Tracklet& tracklet) {
  if (!estimator_ || taken_ < kLeastTaken) return;
  const ChartedState predicted = estimator_->predict(tracklet.time);
  TrackPrediction prediction;
  prediction.chart = predicted.chart;
  prediction.state = predicted.state;
  prediction.believed = prediction.guards = true;
  Scan scan;
  scan.time = tracklet.time;
  scan.sensor = tracklet.sensor;
  scan.ifov = tracklet.ifov;
  scan.sightings = {tracklet.sighting};
  AssociationResult pairing;
  pairing.sighting_of = pairing.prediction_of = {0};
  pairing.may_start = {false};
  guard_.watch(scan, {prediction}, pairing, {corroborationOf(tracklet)});
}

void GuardedEstimator::note(const SensorChange& change) {
  changes_.push_back(change);
  if (changes_.size() > kMostChanges) changes_.erase(changes_.begin());
}

/// The last moment not after `time`, or the first.
std::size_t GuardedEstimator::momentAt(Time time) const {
  std::size_t moment = moments_.size() - 1;
  while (moment > 0 && moments_[moment]->time > time) --moment;
  return moment;
}

Time GuardedEstimator::rollBackTo(const SensorChange& change) const {
  return std::max(change.change.began, change.change.time - durationOf(settings_->guard.roll_back));
}

bool GuardedEstimator::isToBlame(const SensorChange& change, const Past& past) const {
  const Time began = rollBackTo(change);
  const double own = evidenceAgainst(change.sensor, began, past);
  return std::none_of(seen_.begin(), seen_.end(), [&](const Seen& other) {
    const bool is_suspect = other.sensor != change.sensor && guard_.noiseScale(other.sensor) == 1.0;
    return is_suspect && other.last >= began && evidenceAgainst(other.sensor, began, past) > own;
  });
}

/// Log likelihood of all that was seen since `began` if this sensor has been off to one side since, or noisy,
/// by as much as explains it best, and is not used; up to a constant that is the same for every sensor.
double GuardedEstimator::evidenceAgainst(const std::string& sensor, Time began, const Past& past) const {
  const Moment& moment = *moments_[momentAt(began)];
  std::optional<ChartedEstimator> estimator;
  if (moment.estimator) estimator.emplace(*moment.estimator);
  double likelihood = 0.0;
  Residuals own;
  for (std::size_t back = taken_ - moment.taken; back > 0; --back) {
    const Tracklet& tracklet = past(back);
    const bool is_own = tracklet.sensor == sensor && tracklet.time >= began;
    const double scale = noiseScale(back);
    if (!std::isfinite(scale)) continue;
    Tracklet scaled = tracklet;
    scaled.sighting.covariance *= scale;
    if (!estimator) {
      if (!is_own) estimator.emplace(makeEstimator(settings_->estimator), scaled);
      continue;
    }
    if (tracklet.time >= began) {
      const Residual residual = residualOf(*estimator, scaled);
      likelihood -= residual.log_sigmas + (is_own ? 0.0 : 0.5 * residual.u.square().sum());
      if (is_own) own.add(residual.u);
    }
    if (!is_own) estimator->update(scaled, guard_.clockVariance(tracklet.sensor));
  }
  return likelihood + own.bestLikelihood();
}

/// After an alarm by `next`: back to when the change began, and on from there with what is known now of the
/// sensor. The others are watched anew, against an estimate that it no longer harms; they are judged when
/// their next tracklet comes.
void GuardedEstimator::goBack(const Tracklet& next, const SensorChange& change, const Past& past) {
  const SensorGuard known = guard_;
  const Time began = rollBackTo(change);
  const std::size_t from = momentAt(began);
  const std::shared_ptr<const Moment> moment = moments_[from];
  const std::size_t count = taken_ - moment->taken;
  const std::vector<double> scales(scales_.end() - static_cast<std::ptrdiff_t>(count), scales_.end());
  moments_.resize(from + 1);
  restore(*moment);
  guard_.adopt(known, moment->time);
  for (std::size_t i = 0; i < count; ++i) {
    const Tracklet& tracklet = past(count - i);
    if (i > 0) keepMoment(tracklet.time);
    if (!known.changedSince(tracklet.sensor, moment->time)) watch(tracklet);
    const bool is_harmful = tracklet.sensor == change.sensor && tracklet.time >= began;
    settle(tracklet, is_harmful ? known.noiseScale(change.sensor) : scales[i]);
  }
  if (count > 0) keepMoment(next.time);
}

void GuardedEstimator::restore(const Moment& moment) {
  scales_.resize(scales_.size() - (taken_ - moment.taken));
  taken_ = moment.taken;
  last_ = moment.last;
  estimator_ = std::optional<ChartedEstimator>(moment.estimator);
  guard_ = moment.guard;
  seen_ = moment.seen;
}

/// Uses the tracklet with that factor on its covariance. A target that nobody else sees is followed with an
/// excluded sensor all the same.
void GuardedEstimator::settle(const Tracklet& tracklet, double noise_scale) {
  if (settings_->guard.enabled) see(tracklet);
  const bool is_excluded = std::isinf(noise_scale) && corroborationOf(tracklet).others > 0;
  if (!is_excluded) {
    Tracklet scaled = tracklet;
    if (std::isfinite(noise_scale) && noise_scale != 1.0) scaled.sighting.covariance *= noise_scale;
    if (estimator_) {
      const bool has_moved = estimator_->update(scaled, guard_.clockVariance(tracklet.sensor));
      for (Seen& seen : seen_) {
        if (has_moved) seen.innovation.setZero();
      }
    } else {
      estimator_.emplace(makeEstimator(settings_->estimator), scaled);
    }
  }
  ++taken_;
  last_ = tracklet.time;
  if (!settings_->guard.enabled) return;
  scales_.push_back(noise_scale);
}

/// Notes that the sensor has seen the target, and by how much it was not expected there.
void GuardedEstimator::see(const Tracklet& tracklet) {
  Eigen::Vector2d innovation = Eigen::Vector2d::Zero();
  if (estimator_) innovation = innovationOf(estimator_->predict(tracklet.time), tracklet);
  const auto seen =
      std::find_if(seen_.begin(), seen_.end(), [&](const Seen& it) { return it.sensor == tracklet.sensor; });
  if (seen != seen_.end()) {
    seen->last = tracklet.time;
    seen->innovation += kSeenMemory * (innovation - seen->innovation);
  } else if (seen_.size() < kMostSeen) {
    seen_.push_back({tracklet.sensor, tracklet.time, innovation});
  }
}

std::optional<AngularState> GuardedEstimator::stateAt(Time time) const {
  if (!estimator_) return std::nullopt;
  return estimator_->stateAt(time);
}

double GuardedEstimator::noiseScale(std::size_t back) const {
  return back <= scales_.size() ? scales_[scales_.size() - back] : 1.0;
}

std::vector<WatchedSensor> GuardedEstimator::sensors() const {
  std::vector<WatchedSensor> sensors;
  for (WatchedSensor& watched : guard_.sensors()) {
    const auto isIt = [&](const Seen& it) {
      return it.sensor == watched.sensor && guard_.sees(seconds(last_ - it.last));
    };
    if (std::any_of(seen_.begin(), seen_.end(), isIt)) sensors.push_back(std::move(watched));
  }
  return sensors;
}

bool GuardedEstimator::decides() const {
  return settings_->guard.enabled && std::count_if(seen_.begin(), seen_.end(), [this](const Seen& seen) {
                                       return guard_.mayCorroborate(seen.sensor, seconds(last_ - seen.last));
                                     }) >= 3;
}

}  // namespace sightline::core
