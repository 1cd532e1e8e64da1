#include "sightline/core/fusion/tracklets/guarded_estimator.h"

#include <algorithm>
#include <cmath>

#include "sightline/core/sensors/corroboration.h"

namespace sightline::core {
namespace {

constexpr int kStatesPerRollBack = 8;   // that are kept for rolling back
constexpr std::size_t kLeastTaken = 4;  // tracklets from which an estimate corroborates
constexpr double kSeenMemory = 0.3;     // share of the newest innovation of a sensor in the running mean

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

/// By the clock: which states are kept depends on the tracklets alone, so that rolling back gives the same
/// bits in whatever order they came.
TimelineParams timelineParams(const GuardParams& guard, double keep) {
  TimelineParams params;
  params.span = std::max(keep, guard.roll_back);
  params.interval = guard.roll_back / kStatesPerRollBack;
  params.spacing = Spacing::by_clock;
  return params;
}

}  // namespace

GuardedEstimator::GuardedEstimator(const EstimatorParams& estimator, const GuardParams& guard, double keep)
    : settings_(std::make_shared<Settings>(Settings{estimator, guard})),
      state_{std::nullopt, SensorGuard(guard), {}, 0, {}},
      taken_(timelineParams(guard, keep)) {}

void GuardedEstimator::setThresholds(const std::shared_ptr<const SensorHealthParams>& health) {
  if (thresholds_ == health) return;
  thresholds_ = health;
  state_.guard.setThresholds(*health);
}

void GuardedEstimator::take(const Tracklet& next, const Past& past) {
  if (!settings_->guard.enabled) return update(next, {});
  taken_.insert({next.time});
  keepState();
  watch(next);
  const bool was_used = state_.guard.useOf(next.sensor).isAsStated();
  if (const auto change = state_.guard.judge(next.time, next.sensor)) {
    const bool is_harmful = change->change.verdict != SensorVerdict::healthy && !change->undecided;
    if (is_harmful && was_used && !isToBlame(*change, past)) {
      state_.guard.clearVerdict(next.time, next.sensor);
    } else {
      remember(changes_, *change);
      if (is_harmful) rollBack(*change, past);
    }
  }
  update(next, state_.guard.useOf(next.sensor));
  taken_.advance();
}

/// Keeps the state before the next tracklet where one is due, and forgets what is too old to matter.
void GuardedEstimator::keepState() {
  if (!taken_.keepIfDue(state_)) return;
  taken_.close(taken_[taken_.next()].item.time);
  taken_.dropClosed();
}

Corroboration GuardedEstimator::corroborationOf(const Tracklet& tracklet) const {
  return corroborationBy(state_.seen, tracklet.sensor, tracklet.time, state_.guard);
}

/// Shows the guard a tracklet beside what is expected of it, before it is taken.
void GuardedEstimator::watch(const Tracklet& tracklet) {
  if (!state_.estimator || state_.taken < kLeastTaken) return;
  const ChartedState predicted = state_.estimator->predict(tracklet.time);
  TrackPrediction prediction;
  prediction.chart = predicted.chart;
  prediction.state = predicted.state;
  prediction.believed = prediction.guards = true;
  Scan scan;
  scan.time = tracklet.time;
  scan.sensor = tracklet.sensor;
  scan.ifov = tracklet.ifov;
  scan.sightings = {tracklet.sighting};
  AssociationResult association;
  association.sighting_of = association.prediction_of = {0};
  association.may_start = {false};
  state_.guard.watch(scan, {prediction}, association, {corroborationOf(tracklet)});
}

Time GuardedEstimator::rollBackTo(const SensorChange& change) const {
  return std::max(change.change.began, change.change.time - durationOf(settings_->guard.roll_back));
}

bool GuardedEstimator::isToBlame(const SensorChange& change, const Past& past) const {
  const Time began = rollBackTo(change);
  const double own = evidenceAgainst(change.sensor, began, past);
  return std::none_of(state_.seen.begin(), state_.seen.end(), [&](const Seen& other) {
    const bool is_suspect = other.sensor != change.sensor && state_.guard.useOf(other.sensor).isAsStated();
    return is_suspect && other.last_sighting >= began && evidenceAgainst(other.sensor, began, past) > own;
  });
}

/// (S-59): log likelihood of all that was seen since `began` if this sensor has been off to one side since,
/// or noisy, by as much as explains it best, and is not used; up to a constant that is the same for every
/// sensor.
double GuardedEstimator::evidenceAgainst(const std::string& sensor, Time began, const Past& past) const {
  const std::size_t from = taken_.keptAt(taken_.lastNotAfter(began));
  std::optional<ChartedEstimator> estimator = taken_[from].before->estimator;
  double likelihood = 0.0;
  Residuals own;
  for (std::size_t k = from; k < taken_.next(); ++k) {
    const Tracklet& tracklet = past(taken_.next() - k);
    const bool is_own = tracklet.sensor == sensor && tracklet.time >= began;
    const SensorUse& use = taken_[k].use;
    if (use.is_excluded) continue;
    Tracklet scaled = tracklet;
    scaled.sighting.covariance *= use.noise_scale;
    if (!estimator) {
      if (!is_own) estimator.emplace(makeEstimator(settings_->estimator), scaled);
      continue;
    }
    if (tracklet.time >= began) {
      const Residual residual = residualOf(*estimator, scaled);
      likelihood -= residual.log_sigmas + (is_own ? 0.0 : 0.5 * residual.u.square().sum());
      if (is_own) own.add(residual.u);
    }
    if (!is_own) estimator->update(scaled, state_.guard.clockVariance(tracklet.sensor));
  }
  return likelihood + own.bestLikelihood();
}

/// After an alarm by the next tracklet: rolls back to when the change began, and takes what came since then
/// again with what is known now of the sensor. The others are watched anew, against an estimate that it no
/// longer disturbs; they are judged when their next tracklet comes.
void GuardedEstimator::rollBack(const SensorChange& change, const Past& past) {
  const SensorGuard known = state_.guard;
  const Time began = rollBackTo(change);
  const std::size_t alarm = taken_.next();
  const std::size_t from = taken_.restore(taken_.lastNotAfter(began), state_);
  const Time since = taken_[from].item.time;
  state_.guard.adopt(known, since);
  if (thresholds_) state_.guard.setThresholds(*thresholds_);
  for (std::size_t k = from; k < alarm; ++k, taken_.advance()) {
    const Tracklet& tracklet = past(alarm - k);
    taken_.keepIfDue(state_);
    if (!known.changedSince(tracklet.sensor, since)) watch(tracklet);
    const bool is_harmful = tracklet.sensor == change.sensor && tracklet.time >= began;
    update(tracklet, is_harmful ? known.useOf(change.sensor) : taken_[k].use);
  }
  taken_.keepIfDue(state_);
}

/// Updates with the tracklet as it is to be used. A target that nobody else sees is followed with an excluded
/// sensor all the same.
void GuardedEstimator::update(const Tracklet& tracklet, const SensorUse& use) {
  if (settings_->guard.enabled) see(tracklet);
  const bool is_excluded = use.is_excluded && corroborationOf(tracklet).others > 0;
  if (!is_excluded) {
    Tracklet scaled = tracklet;
    scaled.sighting.covariance *= use.noise_scale;
    if (state_.estimator) {
      const bool has_moved = state_.estimator->update(scaled, state_.guard.clockVariance(tracklet.sensor));
      for (Seen& seen : state_.seen) {
        if (has_moved) seen.innovation.setZero();
      }
    } else {
      state_.estimator.emplace(makeEstimator(settings_->estimator), scaled);
    }
  }
  ++state_.taken;
  state_.last = tracklet.time;
  if (settings_->guard.enabled) taken_.use(taken_.next(), use);
}

/// Notes that the sensor has seen the target, and by how much it was not expected there.
void GuardedEstimator::see(const Tracklet& tracklet) {
  Eigen::Vector2d innovation = Eigen::Vector2d::Zero();
  if (state_.estimator) innovation = innovationOf(state_.estimator->predict(tracklet.time), tracklet);
  const auto seen = std::find_if(state_.seen.begin(), state_.seen.end(),
                                 [&](const Seen& it) { return it.sensor == tracklet.sensor; });
  if (seen != state_.seen.end()) {
    seen->last_sighting = tracklet.time;
    seen->innovation += kSeenMemory * (innovation - seen->innovation);
  } else if (state_.seen.size() < kMostSources) {
    state_.seen.push_back({tracklet.sensor, tracklet.time, innovation});
  }
}

std::optional<AngularState> GuardedEstimator::stateAt(Time time) const {
  if (!state_.estimator) return std::nullopt;
  return state_.estimator->stateAt(time);
}

SensorUse GuardedEstimator::useOf(std::size_t back) const {
  return back <= taken_.next() ? taken_[taken_.next() - back].use : SensorUse{};
}

std::vector<WatchedSensor> GuardedEstimator::sensors() const {
  std::vector<WatchedSensor> sensors;
  for (WatchedSensor& watched : state_.guard.sensors()) {
    const auto isIt = [&](const Seen& it) {
      return it.sensor == watched.sensor && state_.guard.sees(seconds(state_.last - it.last_sighting));
    };
    if (std::any_of(state_.seen.begin(), state_.seen.end(), isIt)) sensors.push_back(std::move(watched));
  }
  return sensors;
}

bool GuardedEstimator::decides() const {
  return settings_->guard.enabled &&
         std::count_if(state_.seen.begin(), state_.seen.end(), [this](const Seen& seen) {
           return state_.guard.mayCorroborate(seen.sensor, seconds(state_.last - seen.last_sighting));
         }) >= 3;
}

}  // namespace sightline::core
