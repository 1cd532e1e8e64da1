#include "sightline/core/sensor_health.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace sightline::core {
namespace {

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

}  // namespace

void SensorHealth::CumulatedSum::add(double evidence, Time time) {
  if (value == 0.0) began = time;
  value = std::max(0.0, value + evidence);
}

SensorHealth::SensorHealth(const SensorHealthParams& params, Time since, int channels)
    : params_(checked(params, channels)), last_(since), mean_(PerChannel::Zero(channels)) {}

std::optional<HealthChange> SensorHealth::add(Time time, const Innovation& innovation) {
  const PerChannel u = (innovation.nu / (innovation.predicted + innovation.stated).sqrt())
                           .cwiseMax(-params_.largest_innovation)
                           .cwiseMin(params_.largest_innovation);
  if (verdict_ == SensorVerdict::healthy) cumulate(time, innovation, u);
  average(time, innovation, u);
  return judge(time);
}

/// The sums of section 5.1: one for the variance over both channels, two for the mean of each.
void SensorHealth::cumulate(Time time, const Innovation& innovation, const PerChannel& u) {
  const PerChannel expected = innovation.predicted + innovation.stated;
  const PerChannel grown = innovation.predicted + params_.noise_ratio * innovation.stated;
  const PerChannel evidence =
      0.5 * (innovation.nu.square() * (1.0 / expected - 1.0 / grown) + (expected / grown).log());
  noise_.add(evidence.cwiseMin(params_.largest_evidence).sum(), time);
  for (int channel = 0; channel < u.size(); ++channel) {
    above_[channel].add(u(channel) - params_.bias_slack, time);
    below_[channel].add(-u(channel) - params_.bias_slack, time);
  }
}

/// The sizes: v and m of section 5.1.
void SensorHealth::average(Time time, const Innovation& innovation, const PerChannel& u) {
  const double share = -std::expm1(-seconds(time - last_) / params_.memory);
  const PerChannel ratio = ((innovation.nu.square() - innovation.predicted) / innovation.stated)
                               .cwiseMax(0.0)
                               .cwiseMin(params_.largest_scale);
  scale_ += share * (ratio.mean() - scale_);
  mean_ += share * (u - mean_);
  last_ = time;
}

std::optional<HealthChange> SensorHealth::judge(Time time) {
  if (verdict_ == SensorVerdict::healthy) return alarm(time);
  if (!hasRecovered(time)) return std::nullopt;
  return change(time, time, SensorVerdict::healthy);
}

std::optional<HealthChange> SensorHealth::alarm(Time time) {
  if (noise_.value > params_.noise_threshold) {
    scale_ = std::max(scale_, params_.least_scale);
    return change(time, noise_.began, SensorVerdict::noisy);
  }
  const CumulatedSum* largest = &above_[0];
  for (const auto* sums : {&above_, &below_}) {
    for (const CumulatedSum& sum : *sums) {
      if (sum.value > largest->value) largest = &sum;
    }
  }
  if (largest->value > params_.bias_threshold) return change(time, largest->began, SensorVerdict::biased);
  return std::nullopt;
}

bool SensorHealth::hasRecovered(Time time) const {
  if (verdict_ == SensorVerdict::noisy) return scale_ < params_.noise_release;
  return mean_.abs().maxCoeff() < params_.bias_release &&
         seconds(time - last_change_->time) >= params_.least_exclusion;
}

/// From here on the sums start anew.
HealthChange SensorHealth::change(Time time, Time began, SensorVerdict verdict) {
  noise_ = {};
  above_ = below_ = {};
  verdict_ = verdict;
  HealthChange change;
  change.time = time;
  change.began = began;
  change.verdict = verdict;
  change.scale = scale_;
  change.bias = mean_;
  last_change_ = change;
  return change;
}

double SensorHealth::noiseScale() const {
  switch (verdict_) {
    case SensorVerdict::healthy:
      return 1.0;
    case SensorVerdict::noisy:
      return std::max(1.0, scale_);
    case SensorVerdict::biased:
      return std::numeric_limits<double>::infinity();
  }
  return 1.0;
}

}  // namespace sightline::core
