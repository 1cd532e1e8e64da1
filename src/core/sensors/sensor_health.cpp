#include "sightline/core/sensors/sensor_health.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace sightline::core {
namespace {

constexpr double kMostSigmas = 100.0;    // that an innovation may count for in a likelihood
constexpr double kPriceOfBias = 1.0;     // log likelihood by which a bias, with a parameter more, must win
constexpr double kWeakEvidence = 3.0;    // of a sum: what came up to there may be from before the change
constexpr double kLargestShare = 0.1;    // of one instant in the sizes, however seldom the sensor looks
constexpr double kOverturned = 4.0;      // log likelihood that overturns a verdict (S-52)
constexpr double kSharedByChance = 0.3;  // mean innovation of others that may be chance [sigma] (S-53)
constexpr double kUnequalShares = 2.0;   // a lag shows by so much more in one sensor than in another

const SensorHealthParams& checked(const SensorHealthParams& params, int channels) {
  const bool positive = params.noise_threshold > 0.0 && params.largest_evidence > 0.0 &&
                        params.bias_threshold > 0.0 && params.bias_slack > 0.0 &&
                        params.largest_innovation > 0.0 && params.memory > 0.0 && params.bias_release > 0.0;
  if (!positive || !(params.noise_ratio > 1.0) || !(params.largest_scale > 1.0) ||
      !(params.least_scale >= 1.0) || !(params.noise_release > 1.0) || !(params.least_exclusion >= 0.0)) {
    throw std::invalid_argument(
        "SensorHealthParams: thresholds, slack, largest values, memory and bias_release > 0, noise_ratio, "
        "largest_scale and noise_release > 1, least_scale >= 1 and least_exclusion >= 0 are required");
  }
  if (channels < 1 || channels > 2) {
    throw std::invalid_argument("SensorHealth: 1 or 2 channels can be watched, got " +
                                std::to_string(channels));
  }
  return params;
}

PerChannel cut(const PerChannel& values, double most) {
  return values.cwiseMax(-most).cwiseMin(most);
}

/// e of (S-53): the error of the track itself [sigma], as the other sensors show it.
PerChannel trackError(const Innovation& innovation) {
  if (innovation.shared.size() == 0) return PerChannel::Zero(innovation.nu.size());
  const PerChannel shared = innovation.shared / (innovation.predicted + innovation.stated).sqrt();
  return kUnequalShares * shared.sign() * (shared.abs() - kSharedByChance).cwiseMax(0.0);
}

/// l_noise - l_bias of (S-52): log likelihood of the innovations in a sum under the variance that explains
/// them best, less that under the bias that does. Both are up to the same constant.
double noiseAgainstBias(const SensorHealth::CumulatedSum& sum) {
  const auto channels = static_cast<double>(sum.squares.size());
  const double numbers = channels * sum.sightings;
  const double variance = std::max(1.0, sum.squares.sum() / numbers);
  const double noise = -0.5 * (numbers * std::log(variance) + sum.squares.sum() / variance);
  const double bias = -0.5 * (sum.squares - sum.u.square() / sum.sightings).sum();
  return noise - bias;
}

}  // namespace

void SensorHealth::CumulatedSum::add(double evidence, Time time, const PerChannel& u_now, double ratio_now) {
  if (value == 0.0) began = time;
  if (value < kWeakEvidence) {
    sightings = ratio = 0.0;
    u = squares = PerChannel::Zero(u_now.size());
  }
  value = std::max(0.0, value + evidence);  // (S-49), (S-50)
  note(u_now, ratio_now);
}

void SensorHealth::CumulatedSum::note(const PerChannel& u_now, double ratio_now) {
  sightings += 1.0;
  u += u_now;
  squares += u_now.square();
  ratio += ratio_now;
}

void SensorHealth::CumulatedSum::forget(double share) {
  sightings *= 1.0 - share;
  u *= 1.0 - share;
  squares *= 1.0 - share;
  ratio *= 1.0 - share;
}

SensorHealth::SensorHealth(const SensorHealthParams& params, Time since, int channels)
    : params_(checked(params, channels)),
      mean_(PerChannel::Zero(channels)),
      last_(since),
      mean_before_(mean_),
      u_sum_(mean_) {}

void SensorHealth::setThresholds(const SensorHealthParams& params) {
  params_.noise_threshold = params.noise_threshold;
  params_.bias_threshold = params.bias_threshold;
  params_.noise_release = params.noise_release;
  params_.bias_release = params.bias_release;
  params_.least_exclusion = params.least_exclusion;
}

void SensorHealth::forget(Time time) {
  *this = SensorHealth(params_, time, static_cast<int>(mean_.size()));
}

void SensorHealth::take(Time time, const Innovation& innovation) {
  const PerChannel u = cut(innovation.nu / (innovation.predicted + innovation.stated).sqrt(), kMostSigmas);
  const double ratio = ((innovation.nu.square() - innovation.predicted) / innovation.stated)
                           .cwiseMax(0.0)
                           .cwiseMin(params_.largest_scale)
                           .mean();
  if (verdict_ == SensorVerdict::healthy) cumulate(time, innovation, u, ratio);
  average(time, cut(u, params_.largest_innovation), ratio);
  if (verdict_ != SensorVerdict::healthy) since_change_.note(u, ratio);
}

std::optional<HealthChange> SensorHealth::add(Time time, const Innovation& innovation) {
  take(time, innovation);
  return judge(time);
}

/// One sum for the variance over both channels (S-49), two for the mean of each (S-50). The error of the
/// track itself counts against no sensor, and never against one that does not show it.
void SensorHealth::cumulate(Time time, const Innovation& innovation, const PerChannel& u, double ratio) {
  const PerChannel expected = innovation.predicted + innovation.stated;
  const PerChannel grown = innovation.predicted + params_.noise_ratio * innovation.stated;
  const PerChannel error = trackError(innovation);  // (S-53)
  const PerChannel above = u - error.cwiseMax(0.0), below = -u - (-error).cwiseMax(0.0);
  const PerChannel own = above.cwiseMax(below).cwiseMax(0.0);
  const PerChannel evidence =
      0.5 * (own.square() * expected * (1.0 / expected - 1.0 / grown) + (expected / grown).log());
  noise_.add(evidence.cwiseMin(params_.largest_evidence).sum(), time, u, ratio);  // (S-49)
  const PerChannel up = cut(above, params_.largest_innovation), down = cut(below, params_.largest_innovation);
  for (int channel = 0; channel < u.size(); ++channel) {  // (S-50)
    above_[channel].add(up(channel) - params_.bias_slack, time, u, ratio);
    below_[channel].add(down(channel) - params_.bias_slack, time, u, ratio);
  }
}

/// The sizes v and m (S-51). All innovations of one instant count as one.
void SensorHealth::average(Time time, const PerChannel& u, double ratio) {
  if (time != last_ || innovations_ == 0) {
    share_ = -std::expm1(-seconds(time - last_) / params_.memory);  // (S-51)
    if (params_.form == HealthForm::refined) share_ = std::min(share_, kLargestShare);
    scale_before_ = scale_;
    mean_before_ = mean_;
    innovations_ = 0;
    ratio_sum_ = 0.0;
    u_sum_.setZero();
    last_ = time;
    if (verdict_ != SensorVerdict::healthy) since_change_.forget(share_);
  }
  ++innovations_;
  ratio_sum_ += ratio;
  u_sum_ += u;
  scale_ = scale_before_ + share_ * (ratio_sum_ / innovations_ - scale_before_);
  mean_ = mean_before_ + share_ * (u_sum_ / innovations_ - mean_before_);
}

std::optional<HealthChange> SensorHealth::judge(Time time) {
  if (verdict_ == SensorVerdict::healthy) return alarm(time);
  if (hasRecovered(time)) return change(time, time, SensorVerdict::healthy);
  if (params_.form == HealthForm::refined) return reconsider(time);
  return std::nullopt;
}

const SensorHealth::CumulatedSum& SensorHealth::largestBiasSum() const {
  const CumulatedSum* largest = &above_[0];
  for (const auto* sums : {&above_, &below_}) {
    for (const CumulatedSum& sum : *sums) {
      if (sum.value > largest->value) largest = &sum;
    }
  }
  return *largest;
}

std::optional<HealthChange> SensorHealth::alarm(Time time) {
  const CumulatedSum& bias = largestBiasSum();
  const bool noise_alarms = noise_.value > params_.noise_threshold;
  if (!noise_alarms && !(bias.value > params_.bias_threshold)) return std::nullopt;
  since_change_ = noise_alarms ? noise_ : bias;
  bool is_noise = noise_alarms;
  if (params_.form == HealthForm::refined) {
    is_noise = noiseAgainstBias(since_change_) > -kPriceOfBias;  // (S-52)
    scale_ = since_change_.ratio / since_change_.sightings;
  }
  if (is_noise) scale_ = std::max(scale_, params_.least_scale);
  return change(time, since_change_.began, is_noise ? SensorVerdict::noisy : SensorVerdict::biased);
}

/// Overturns a verdict when the other fault explains the innovations better (S-52). The change is reported
/// with the time at which the fault began.
std::optional<HealthChange> SensorHealth::reconsider(Time time) {
  scale_ = since_change_.ratio / since_change_.sightings;
  const double noise_lead = noiseAgainstBias(since_change_);
  const bool was_noise = verdict_ == SensorVerdict::noisy;
  if (was_noise ? noise_lead > -kOverturned : noise_lead < kOverturned) return std::nullopt;
  return change(time, last_change_->began, was_noise ? SensorVerdict::biased : SensorVerdict::noisy);
}

/// (S-51), release.
bool SensorHealth::hasRecovered(Time time) const {
  if (verdict_ == SensorVerdict::noisy) return scale_ < params_.noise_release;
  return mean_.abs().maxCoeff() < params_.bias_release &&
         seconds(time - last_change_->time) >= params_.least_exclusion;
}

/// Records a change of the verdict; the sums start anew.
HealthChange SensorHealth::change(Time time, Time began, SensorVerdict verdict) {
  noise_ = {};
  above_ = below_ = {};
  innovations_ = 0;
  verdict_ = verdict;
  HealthChange change;
  change.time = time;
  change.began = began;
  change.verdict = verdict;
  change.scale = scale_;
  change.bias = mean_;
  const bool has_size = verdict != SensorVerdict::healthy && params_.form == HealthForm::refined;
  if (has_size) change.bias = since_change_.u / since_change_.sightings;
  last_change_ = change;
  return change;
}

HealthChange SensorHealth::release(Time time) {
  scale_ = 1.0;
  mean_.setZero();
  return change(time, time, SensorVerdict::healthy);
}

PerChannel SensorHealth::biasSinceChange() const {
  if (!(since_change_.sightings > 0.0)) return PerChannel::Zero(mean_.size());
  return since_change_.u / since_change_.sightings;
}

SensorUse SensorHealth::use() const {
  SensorUse use;
  if (verdict_ == SensorVerdict::noisy) use.noise_scale = std::max(1.0, scale_);
  use.is_excluded = verdict_ == SensorVerdict::biased;
  return use;
}

}  // namespace sightline::core
