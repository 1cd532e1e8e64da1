#include "sightline/core/estimators/twbls.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "sightline/core/estimators/revisit_time.h"

namespace sightline::core {
namespace {

constexpr double kMisfitPrior = 4.0;  // degrees of freedom of the belief that the stated sigmas are right

/// What a sighting of age s adds to (C_1, C_2) for each radian of its value: a column of P F^T W.
Eigen::Vector2d influence(const LineFit& fit, double age, double weight) {  // (S-2)
  return fit.P * Eigen::Vector2d(age, 1.0) * weight;
}

double timeWeight(const TwblsParams& params, double age, double oldest) {  // (6C)
  switch (params.time_weight) {
    case TimeWeight::linear:
      return std::max(0.0, 1.0 - age / (1.05 * std::max(params.window, oldest)));
    case TimeWeight::exponential:
      return std::exp(-age / params.decay);
    case TimeWeight::none:
      break;
  }
  return 1.0;
}

}  // namespace

std::optional<LineFit> fitLine(const Eigen::Ref<const Eigen::ArrayXd>& age,
                               const Eigen::Ref<const Eigen::ArrayXd>& value,
                               const Eigen::Ref<const Eigen::ArrayXd>& variance,
                               const Eigen::Ref<const Eigen::ArrayXd>& weight) {
  const Eigen::Index n = age.size();
  const double S0 = weight.sum();
  if (n < 2 || !(S0 > 0.0)) return std::nullopt;
  const double mean_age = (weight * age).sum() / S0;
  const double mean_value = (weight * value).sum() / S0;
  const double D = (weight * (age - mean_age).square()).sum();  // = (S_0 S_2 - S_1^2) / S_0
  if (!(D > S0 * kSameTime * kSameTime)) return std::nullopt;

  LineFit fit;  // (3), about the mean age
  const double C1 = (weight * (age - mean_age) * (value - mean_value)).sum() / D;
  fit.C << C1, mean_value - C1 * mean_age;
  fit.P << 1.0 / D, -mean_age / D, -mean_age / D, 1.0 / S0 + mean_age * mean_age / D;

  for (Eigen::Index i = 0; i < n; ++i) {  // (S-2)
    const Eigen::Vector2d g = influence(fit, age(i), weight(i));
    fit.covariance += g * g.transpose() * variance(i);
  }

  const double residual = (weight * (value - fit.C(0) * age - fit.C(1)).square()).sum();
  fit.rms = std::sqrt(residual / S0);                                                         // (7)
  fit.efit = std::sqrt(residual / S0 * static_cast<double>(n) / static_cast<double>(n - 2));  // (8)
  if (n == 2) {  // no degree of freedom left: the stated sigmas stand in
    fit.efit = std::numeric_limits<double>::quiet_NaN();
    fit.E = fit.covariance.diagonal().cwiseSqrt();
    return fit;
  }
  fit.E = fit.efit * (fit.P.diagonal() * S0 / static_cast<double>(n)).cwiseSqrt();  // (9C)

  // What the stated variances let the weighted residual be on average: sum w sigma^2 - tr(P^-1 cov).
  Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
  normal << D + S0 * mean_age * mean_age, S0 * mean_age, S0 * mean_age, S0;
  const double expected = (weight * variance).sum() - (normal * fit.covariance).trace();
  if (expected > 0.0) {
    const double freedom = static_cast<double>(n - 2);
    fit.misfit = (kMisfitPrior + freedom * residual / expected) / (kMisfitPrior + freedom);
  }
  return fit;
}

double paperGateHalfWidth(const LineFit& fit, double h, double sigma) {
  return 3.0 * std::max(fit.E(1) + h * fit.E(0), sigma);  // (5)
}

TwblsEstimator::TwblsEstimator(const TwblsParams& params)
    : params_(params), rate_(params.initial_rate_sigma) {
  if (params.min_sightings < 2 || params.max_sightings < std::max(params.min_sightings, 3) ||
      !(params.window > 0.0) || !(params.decay > 0.0) || !(params.initial_rate_sigma >= 0.0)) {
    throw std::invalid_argument(
        "TwblsParams: 2 <= min_sightings <= max_sightings, max_sightings >= 3, window and decay > 0 "
        "and initial_rate_sigma >= 0 are required");
  }
  window_.reserve(static_cast<std::size_t>(params.max_sightings) + 1);
  for (Eigen::ArrayXd* array : {&age_, &time_weight_, &cross_covariance_, &value_[0], &value_[1],
                                &variance_[0], &variance_[1], &weight_[0], &weight_[1]}) {
    array->resize(params.max_sightings);
  }
}

std::unique_ptr<Estimator> TwblsEstimator::clone() const {
  return std::unique_ptr<Estimator>(new TwblsEstimator(*this));
}

void TwblsEstimator::update(const Measurement& measurement) {
  if (params_.sensor_weight == SensorWeight::ifov && !(measurement.ifov > 0.0)) {
    throw std::invalid_argument("TWBLS weights sensors by 1/ifov^2, but a sighting has ifov " +
                                std::to_string(measurement.ifov) +
                                ": set the sensor's ifov or sensor_weight: variance");
  }
  if (!window_.empty()) {
    const Measurement& last = window_.back();
    rate_.learn(measurement.position - last.position, last.covariance + measurement.covariance,
                seconds(measurement.time - last.time));
  }
  window_.push_back(measurement);
  forget(measurement.time);
  refit();
}

void TwblsEstimator::forget(Time now) {
  const auto first_young = std::find_if(window_.begin(), window_.end(), [&](const Measurement& sighting) {
    return seconds(now - sighting.time) < params_.window;
  });
  const auto young = static_cast<int>(window_.end() - first_young);
  const int kept = std::min(
      {std::max(young, params_.min_sightings), params_.max_sightings, static_cast<int>(window_.size())});
  window_.erase(window_.begin(), window_.end() - kept);
}

void TwblsEstimator::refit() {
  const auto n = static_cast<Eigen::Index>(window_.size());
  const double oldest = seconds(window_.back().time - window_.front().time);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Measurement& sighting = window_[static_cast<std::size_t>(i)];
    age_(i) = seconds(window_.back().time - sighting.time);
    time_weight_(i) = timeWeight(params_, age_(i), oldest);
    cross_covariance_(i) = sighting.covariance(0, 1);
    for (int channel = 0; channel < 2; ++channel) {
      value_[channel](i) = sighting.position(channel);
      variance_[channel](i) = sighting.covariance(channel, channel);
      const double scale =
          params_.sensor_weight == SensorWeight::ifov ? sighting.ifov * sighting.ifov : variance_[channel](i);
      weight_[channel](i) = time_weight_(i) / scale;  // (6C)
    }
  }
  for (int channel = 0; channel < 2; ++channel) {
    fits_[channel] =
        fitLine(age_.head(n), value_[channel].head(n), variance_[channel].head(n), weight_[channel].head(n));
  }
  state_ = fits_[0] && fits_[1] ? lineState() : pointState();
}

/// Position and velocity of both lines at the last sighting with their covariance.
AngularState TwblsEstimator::lineState() const {  // (5C), (S-23), (9C)
  const auto n = static_cast<Eigen::Index>(window_.size());
  const bool raw = params_.anchor == TwblsAnchor::raw;
  AngularState state;
  for (int channel = 0; channel < 2; ++channel) {
    state.mean(channel) = raw ? value_[channel](n - 1) : fits_[channel]->C(1);
    state.mean(channel + 2) = -fits_[channel]->C(0);
  }
  if (params_.covariance == TwblsCovariance::fit_error) {
    for (int channel = 0; channel < 2; ++channel) {
      state.covariance(channel, channel) = fits_[channel]->E(1) * fits_[channel]->E(1);
      state.covariance(channel + 2, channel + 2) = fits_[channel]->E(0) * fits_[channel]->E(0);
    }
  } else {
    for (Eigen::Index i = 0; i < n; ++i) {  // (S-2) for both channels together
      Eigen::Matrix<double, 4, 2> gain = Eigen::Matrix<double, 4, 2>::Zero();
      for (int channel = 0; channel < 2; ++channel) {
        const Eigen::Vector2d g = influence(*fits_[channel], age_(i), weight_[channel](i));
        gain(channel, channel) = raw ? (i == n - 1 ? 1.0 : 0.0) : g(1);
        gain(channel + 2, channel) = -g(0);
      }
      Eigen::Matrix2d R;
      R << variance_[0](i), cross_covariance_(i), cross_covariance_(i), variance_[1](i);
      state.covariance += gain * R * gain.transpose();
    }
  }
  if (params_.covariance == TwblsCovariance::residual) {
    Eigen::Vector4d scale;
    for (int channel = 0; channel < 2; ++channel) {
      scale(channel) = scale(channel + 2) = std::sqrt(std::max(1.0, fits_[channel]->misfit));
    }
    state.covariance = scale.asDiagonal() * state.covariance * scale.asDiagonal();
  }

  state.covariance = symmetric(state.covariance);
  return withRatePrior(state, rate_.sigma(), window_.size(), age_(0));
}

/// All sightings at one instant: their weighted mean, and nothing known of the rates.
AngularState TwblsEstimator::pointState() const {  // (3), (S-2)
  const auto n = static_cast<Eigen::Index>(window_.size());
  Measurement mean = window_.back();
  mean.covariance.setZero();
  for (int channel = 0; channel < 2; ++channel) {
    const double total = weight_[channel].head(n).sum();
    mean.position(channel) = (weight_[channel].head(n) * value_[channel].head(n)).sum() / total;
    mean.covariance(channel, channel) =
        (weight_[channel].head(n).square() * variance_[channel].head(n)).sum() / (total * total);
  }
  mean.covariance(0, 1) = (weight_[0].head(n) * weight_[1].head(n) * cross_covariance_.head(n)).sum() /
                          (weight_[0].head(n).sum() * weight_[1].head(n).sum());
  mean.covariance(1, 0) = mean.covariance(0, 1);
  return firstState(mean, rate_.sigma());
}

std::optional<AngularState> TwblsEstimator::stateAt(Time time) const {
  if (window_.empty()) return std::nullopt;
  if (rate_.isOpen())
    return rate_.stateAfter(seconds(time - window_.back().time), state_.angles(), state_.anglesCovariance());
  return propagate(state_, seconds(time - window_.back().time), 0.0);  // (5C)
}

void TwblsEstimator::rotate(const Eigen::Matrix3d& R_new_old) {
  core::rotate(window_, R_new_old);
  if (!window_.empty()) refit();
}

}  // namespace sightline::core
