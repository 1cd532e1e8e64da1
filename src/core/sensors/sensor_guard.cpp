#include "sightline/core/sensors/sensor_guard.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace sightline::core {
namespace {

constexpr std::size_t kMostWatched = 64;       // that are watched
constexpr std::size_t kMostUnassociated = 32;  // in a scan, beyond which they show nothing
constexpr int kClutterMemory = 50;    // scans over which the number of unassociated sightings is smoothed
constexpr double kMostFalse = 0.001;  // false sightings expected nearer than an unassociated one that counts
constexpr double kVague = 16.0;  // variance of a prediction over that of the sightings it is compared with
constexpr double kClockInterval = 1.0;  // between comparisons of the clocks [s]
constexpr double kBiasReach = 6.0;      // of a biased sighting from where the bias puts it [sigma]
constexpr double kBiasShare = 0.2;      // of the bias, by which it may be farther
constexpr int kOthersThatDecide = 2;    // with one other sensor, either may be to blame

Innovation innovationOf(const TrackPrediction& prediction, const Sighting& sighting) {
  Innovation innovation;
  innovation.nu =
      angleDifference(prediction.chart.coordinatesOf(sighting.direction), prediction.state.angles());
  innovation.predicted = prediction.state.anglesCovariance().diagonal();
  innovation.stated = prediction.chart.covarianceOf(sighting).diagonal();
  return innovation;
}

/// Whether the track knows much less of the target than the sensor states: it cannot corroborate. False
/// tracks are like that.
bool isVague(const Innovation& innovation) {
  return (innovation.predicted > kVague * innovation.stated).any();
}

double distanceSquared(const Innovation& innovation) {
  return (innovation.nu.square() / (innovation.predicted + innovation.stated)).sum();
}

/// Sightings that no established track is associated with.
std::vector<std::size_t> unassociatedOf(const Scan& scan, const std::vector<TrackPrediction>& predictions,
                                        const AssociationResult& result) {
  std::vector<std::size_t> unassociated;
  for (std::size_t j = 0; j < scan.sightings.size(); ++j) {
    const int owner = result.prediction_of[j];
    if (owner < 0 || !predictions[static_cast<std::size_t>(owner)].believed) unassociated.push_back(j);
  }
  return unassociated;
}

/// The nearest unassociated sighting in reach of a track, and how many there are.
struct Nearby {
  int count = 0;
  double distance_squared = 0.0;
  std::optional<Innovation> nearest;
};

Nearby nearbyOf(const Scan& scan, const std::vector<std::size_t>& unassociated,
                const TrackPrediction& prediction, double reach) {
  Nearby nearby;
  nearby.distance_squared = reach * reach;
  for (const std::size_t j : unassociated) {
    Innovation innovation = innovationOf(prediction, scan.sightings[j]);
    const double distance = distanceSquared(innovation);
    if (distance > reach * reach) continue;
    ++nearby.count;
    if (distance > nearby.distance_squared) continue;
    nearby.distance_squared = distance;
    nearby.nearest = std::move(innovation);
  }
  return nearby;
}

}  // namespace

double signedMedian(double* values, int count) {
  if (count == 0) return 0.0;
  std::sort(values, values + count);
  const double a = values[(count - 1) / 2], b = values[count / 2];
  if (a * b <= 0.0) return 0.0;  // (S-53)
  return 0.5 * (a + b);
}

SensorGuard::SensorGuard(const GuardParams& params) : params_(params) {
  if (!(params.roll_back >= 0.0) || !(params.support > 0.0) || !(params.reach > 0.0) ||
      !(params.clock.memory > 0.0) || !(params.clock.significance > 0.0) || !(params.clock.least >= 0.0)) {
    throw std::invalid_argument(
        "GuardParams: roll_back >= 0 s, support > 0 s, reach > 0, and of the clock memory > 0 s, "
        "significance "
        "> 0 and least >= 0 s are required");
  }
  SensorHealth(params.health, Time{});  // refuses what cannot work
}

std::size_t SensorGuard::placeOf(const std::string& sensor) const {
  std::size_t place = 0;
  while (place < watches_.size() && watches_[place].sensor < sensor) ++place;
  return place;
}

const SensorGuard::Watch* SensorGuard::find(const std::string& sensor) const {
  const std::size_t place = placeOf(sensor);
  return place < watches_.size() && watches_[place].sensor == sensor ? &watches_[place] : nullptr;
}

SensorGuard::Watch* SensorGuard::findOrStart(const std::string& sensor, Time time) {
  const std::size_t place = placeOf(sensor);
  if (place < watches_.size() && watches_[place].sensor == sensor) return &watches_[place];
  if (watches_.size() >= kMostWatched) return nullptr;
  return &*watches_.emplace(watches_.begin() + static_cast<std::ptrdiff_t>(place), sensor, params_, time);
}

SensorUse SensorGuard::useOf(const std::string& sensor) const {
  const Watch* watch = find(sensor);
  return watch == nullptr || watch->undecided ? SensorUse{} : watch->health.use();
}

bool SensorGuard::holdsAnything() const {
  return std::any_of(watches_.begin(), watches_.end(),
                     [](const Watch& watch) { return !watch.undecided && !watch.health.use().isAsStated(); });
}

double SensorGuard::clockVariance(const std::string& sensor) const {
  const Watch* watch = find(sensor);
  if (watch == nullptr || !watch->wrong_clock || watch->clock_undecided) return 0.0;
  // (S-56)
  return watch->wrong_clock->behind * watch->wrong_clock->behind +
         watch->wrong_clock->sigma * watch->wrong_clock->sigma;
}

/// Once a second; it needs the sightings of many.
void SensorGuard::compareClocks(Time time) {
  if (seconds(time - clocks_compared_) < kClockInterval) return;
  clocks_compared_ = time;
  std::vector<std::optional<ClockOffset>> against;
  for (Watch& watch : watches_) {
    watch.wrong_clock.reset();
    against.push_back(watch.clock.against());
  }
  for (const ClockFinding& finding : wrongClocks(against, params_.clock)) {
    watches_[finding.sensor].wrong_clock = finding.offset;
    watches_[finding.sensor].clock_undecided = finding.undecided;
  }
}

bool SensorGuard::isExplainedByBias(const std::string& sensor, const TrackPrediction& prediction,
                                    const Sighting& sighting) const {
  const Watch* watch = find(sensor);
  return watch != nullptr && isExplainedByBias(watch->health, innovationOf(prediction, sighting));
}

bool SensorGuard::isExplainedByBias(const SensorHealth& health, const Innovation& innovation) {
  if (health.verdict() != SensorVerdict::biased) return false;
  const PerChannel u = innovation.nu / (innovation.predicted + innovation.stated).sqrt();
  const PerChannel bias = health.biasSinceChange();
  // (S-54)
  const double reach = kBiasReach + kBiasShare * std::sqrt(bias.square().sum());
  return (u - bias).square().sum() <= reach * reach;
}

/// A sighting outside every gate may be the target's all the same: when the track has none of this scan, the
/// nearest unassociated one counts for its sensor, as far as the sensor's false sightings are too few to
/// explain it and the sensor has seen the target just before, or is known to be biased by as much.
void SensorGuard::watch(const Scan& scan, const std::vector<TrackPrediction>& predictions,
                        const AssociationResult& result, const std::vector<Corroboration>& corroboration) {
  Watch* watch = nullptr;
  std::vector<std::size_t> unassociated;
  int most_others = 0;
  for (std::size_t i = 0; i < predictions.size(); ++i) {
    if (!predictions[i].believed || corroboration[i].others < 1) continue;
    if (watch == nullptr) {
      watch = findOrStart(scan.sensor, scan.time);
      if (watch == nullptr) return;
      unassociated = unassociatedOf(scan, predictions, result);
      if (unassociated.size() > kMostUnassociated) unassociated.clear();
    }
    const Nearby nearby = nearbyOf(scan, unassociated, predictions[i], params_.reach);
    const int own = result.sighting_of[i];
    if (own >= 0) {
      watch->scans = std::min(watch->scans + 1, kClutterMemory);
      watch->clutter += (nearby.count - watch->clutter) / watch->scans;
      const Sighting& sighting = scan.sightings[static_cast<std::size_t>(own)];
      Innovation innovation = innovationOf(predictions[i], sighting);
      innovation.shared = corroboration[i].shared;
      if (isVague(innovation)) continue;
      watch->health.take(scan.time, innovation);
      watch->clock.take(scan.time, innovation.nu.matrix(), predictions[i].chart.covarianceOf(sighting),
                        predictions[i].state);
    } else if (nearby.nearest && (watch->health.verdict() == SensorVerdict::biased
                                      ? isExplainedByBias(watch->health, *nearby.nearest)
                                      : corroboration[i].has_sensor)) {
      const double in_reach = (watch->clutter * watch->scans + 0.5) / (watch->scans + 1);
      // (S-54)
      const double expected_false = in_reach * nearby.distance_squared / (params_.reach * params_.reach);
      if (expected_false > kMostFalse || isVague(*nearby.nearest)) continue;
      watch->health.take(scan.time, *nearby.nearest);
    } else {
      continue;
    }
    most_others = std::max(most_others, corroboration[i].others);
  }
  if (most_others == 0) return;
  watch->last_compared = scan.time;
  compareClocks(scan.time);
  watch->decides = most_others >= kOthersThatDecide;
  if (watch->decides && watch->undecided) {
    watch->health.forget(scan.time);
    watch->undecided = false;
  }
}

std::optional<SensorChange> SensorGuard::judge(Time time, const std::string& sensor) {
  if (find(sensor) == nullptr) return std::nullopt;
  Watch& watch = watches_[placeOf(sensor)];
  const bool was_healthy = watch.health.verdict() == SensorVerdict::healthy;
  auto change = watch.health.judge(time);
  const bool is_idle = seconds(time - watch.last_compared) > params_.support;
  if (!change && !was_healthy && is_idle) change = watch.health.release(time);
  if (!change) return std::nullopt;
  if (was_healthy) watch.undecided = !watch.decides;
  const SensorChange made{sensor, *change, watch.undecided};
  if (change->verdict == SensorVerdict::healthy) watch.undecided = false;
  return made;
}

void SensorGuard::setThresholds(const SensorHealthParams& health) {
  params_.health = health;
  for (Watch& watch : watches_) watch.health.setThresholds(health);
}

void SensorGuard::clearVerdict(Time time, const std::string& sensor) {
  if (find(sensor) == nullptr) return;
  Watch& watch = watches_[placeOf(sensor)];
  watch.health.forget(time);
  watch.undecided = false;
}

bool SensorGuard::changedSince(const std::string& sensor, Time since) const {
  const Watch* watch = find(sensor);
  return watch != nullptr && watch->health.lastChange() && watch->health.lastChange()->time >= since;
}

void SensorGuard::adopt(const SensorGuard& later, Time since) {
  for (const Watch& watch : later.watches_) {
    if (!later.changedSince(watch.sensor, since)) continue;
    const std::size_t place = placeOf(watch.sensor);
    if (place == watches_.size() || watches_[place].sensor != watch.sensor) {
      watches_.insert(watches_.begin() + static_cast<std::ptrdiff_t>(place), watch);
    } else {
      watches_[place] = watch;
    }
  }
}

std::vector<WatchedSensor> SensorGuard::sensors() const {
  std::vector<WatchedSensor> sensors;
  for (const Watch& watch : watches_) {
    const SensorUse use = useOf(watch.sensor);
    sensors.push_back({watch.sensor, watch.health.verdict(), watch.undecided, use.noise_scale,
                       use.is_excluded, watch.wrong_clock, watch.clock_undecided, watch.health.lastChange()});
  }
  return sensors;
}

}  // namespace sightline::core
