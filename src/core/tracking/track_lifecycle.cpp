#include "sightline/core/tracking/track_lifecycle.h"

#include <algorithm>

namespace sightline::core {
namespace {

constexpr double kPaces = 4.0;           // usual intervals that a silence may always last
constexpr double kIntervalMemory = 0.2;  // share of the newest interval in the usual one
constexpr double kLookMemory = 50.0;     // scans over which a track's own share of sightings is taken ...
constexpr double kTrustInSensor = 10.0;  // ... against so many of the sensor's
constexpr double kHopeless = 0.01;       // share of its odds at the start that ends a tentative track
constexpr double kSeenAgain = 0.9;       // existence from which a lost track is shown again

}  // namespace

double TrackLifecycle::leastSilence() const {
  return kPaces * interval_;
}

/// A limit on silence, given in units of time, as it counts for this track [s].
double TrackLifecycle::limit(double silence) const {
  return silence > 0.0 ? std::max(silence * unit_, leastSilence()) : leastSilence();
}

// (S-40)
double TrackLifecycle::detectionProbability(double of_sensor) const {
  return (seen_ + kTrustInSensor * of_sensor) / (looked_ + kTrustInSensor);
}

void TrackLifecycle::noteSighting(Time time, double likelihood_ratio, bool is_expected,
                                  const LifecycleParams& params) {
  const double since_last = seconds(time - last_sighting_);
  weigh(time, likelihood_ratio, params);
  if (is_expected) noteLook(true);
  interval_ = hits_ == 1 ? since_last : interval_ + kIntervalMemory * (since_last - interval_);
  last_sighting_ = time;
  misses_ = 0;
  ++hits_;
  ++scans_;
  if (!isTentative() || isConfirmedBy(params)) status_ = TrackStatus::confirmed;
  if (lost_ && (!params.by_existence || existence() >= kSeenAgain)) lost_ = false;
}

void TrackLifecycle::noteMiss(Time time, double likelihood_ratio, bool is_expected,
                              const LifecycleParams& params) {
  weigh(time, likelihood_ratio, params);
  if (!is_expected) return;
  ++misses_;
  ++scans_;
  noteLook(false);
}

void TrackLifecycle::weigh(Time time, double likelihood_ratio, const LifecycleParams& params) {
  existence_.pass(seconds(time - weighed_) / unit_, params.presence);
  existence_.weigh(likelihood_ratio);
  weighed_ = time;
}

void TrackLifecycle::noteLook(bool is_seen) {
  constexpr double keep = 1.0 - 1.0 / kLookMemory;
  looked_ = keep * looked_ + 1.0;
  seen_ = keep * seen_ + (is_seen ? 1.0 : 0.0);
}

bool TrackLifecycle::isConfirmedBy(const LifecycleParams& params) const {
  return static_cast<int>(hits_) >= params.confirm_hits &&
         (!params.by_existence || existence() >= params.confirm_existence);
}

void TrackLifecycle::updateStatus(Time time, const LifecycleParams& params) {
  if (isTentative()) return;
  const double silence = seconds(time - last_sighting_);
  const bool coasts =
      silence > limit(params.coast_silence) || static_cast<int>(misses_) >= params.coast_misses;
  status_ = coasts ? TrackStatus::coasting : TrackStatus::confirmed;
  const bool is_improbable = params.by_existence && existence() < params.show_existence;
  if (isSilentTooLong(time, params) || is_improbable) lost_ = true;
}

bool TrackLifecycle::isOver(Time time, const LifecycleParams& params) const {
  if (isTentative()) return isSilentTooLong(time, params) || isHopeless(params);
  return lost_ && seconds(time - last_sighting_) > limit(params.remember);
}

/// Silent, or without existence missed, for so long that the target is gone or cannot be found again.
bool TrackLifecycle::isSilentTooLong(Time time, const LifecycleParams& params) const {
  return seconds(time - last_sighting_) > limit(params.delete_silence) ||
         (!params.by_existence && static_cast<int>(misses_) >= params.delete_misses);
}

/// Whether a tentative track will hardly be confirmed any more.
bool TrackLifecycle::isHopeless(const LifecycleParams& params) const {
  if (params.by_existence) return existence_.gain() < kHopeless;
  return scans_ - static_cast<int>(hits_) > params.confirm_scans - params.confirm_hits;
}

}  // namespace sightline::core
