#include "sightline/core/positions/stations/station_noise.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "sightline/core/model/sphere.h"

namespace sightline::core {
namespace {

constexpr double kLongestStep = 0.15;     // [s] between directions whose third difference is taken
constexpr double kWhiteMemory = 300.0;    // third differences that count
constexpr double kFewestWhite = 10.0;     // of them, before the stated noise is left
constexpr double kWhiteClip = 30.0;       // of one squared third difference over the mean so far
constexpr double kLeastWhite = 1e-4;      // variance over the stated one
constexpr double kSlowInterval = 0.1;     // [s] between estimates of the slow error that are taken
constexpr double kLeastRest = 0.3 * 0.3;  // of the stated variance, that may be slow when all seems white
constexpr double kFewestLags = 20.0;      // [s] of data before the time constant is left

}  // namespace

double slowReference(double stated_variance, double white_variance) {  // (P-9)
  return std::max(stated_variance - white_variance, kLeastRest * stated_variance);
}

StationNoise::StationNoise(const StationNoiseParams& params) : params_(params) {
  const auto require = [](bool ok, const char* what) {
    if (!ok) throw std::invalid_argument(std::string("StationNoiseParams: ") + what + " is required");
  };
  require(params.slow_scale >= 0.0, "slow_scale >= 0");
  require(params.time_constant > 0.0, "time_constant > 0 s");
  require(params.safety > 0.0, "safety > 0");
  require(params.memory > 0.0, "memory > 0 s");
  require(params.prior_weight >= 0.0, "prior_weight >= 0 s");
  require(params.least_scale > 0.0 && params.most_scale > params.least_scale, "0 < least_scale < most_scale");
  require(params.least_time > 0.0 && params.most_time > params.least_time, "0 < least_time < most_time");
}

void StationNoise::noteDirection(Time time, const Eigen::Vector3d& direction,
                                 double stated_variance) {  // (P-13)
  if (!(stated_variance > 0.0)) return;
  if (direction_count_ > 0) {
    const double h = seconds(time - directions_[direction_count_ - 1].time);
    if (!(h > 0.0)) return;
    if (h > kLongestStep) direction_count_ = 0;
  }
  if (direction_count_ == directions_.size()) {
    std::move(directions_.begin() + 1, directions_.end(), directions_.begin());
    --direction_count_;
  }
  directions_[direction_count_++] = {time, direction};
  if (direction_count_ < directions_.size()) return;

  // Divided difference of third order: zero for every motion up to a steady acceleration.
  Eigen::Vector3d difference = Eigen::Vector3d::Zero();
  double squares = 0.0;
  for (std::size_t i = 0; i < 4; ++i) {
    double product = 1.0;
    for (std::size_t j = 0; j < 4; ++j)
      if (j != i) product *= seconds(directions_[i].time - directions_[j].time);
    difference += directions_[i].direction / product;
    squares += 1.0 / (product * product);
  }
  double ratio = 0.5 * difference.squaredNorm() / squares / stated_variance;
  if (white_weight_ > kFewestWhite) ratio = std::min(ratio, kWhiteClip * white_sum_ / white_weight_);
  const double kept = 1.0 - 1.0 / kWhiteMemory;
  white_sum_ = kept * white_sum_ + ratio;
  white_weight_ = kept * white_weight_ + 1.0;
}

double StationNoise::whiteScale() const {
  if (white_weight_ < kFewestWhite) return 1.0;
  return std::clamp(white_sum_ / white_weight_, kLeastWhite, 1.0);
}

void StationNoise::noteSlowError(const SlowErrorEstimate& estimate, double reference,
                                 double since) {  // (P-9)
  if (!(reference > 0.0) || !estimate.covariance.allFinite() || !estimate.error.allFinite()) return;
  const double h = std::clamp(since, 0.0, kLongestStep);
  const double passed = last_ ? std::max(seconds(estimate.time - *last_), 0.0) : 0.0;
  last_ = estimate.time;
  const double kept = std::exp(-passed / params_.memory);
  // What is estimated of it has the variance of the error less what stays unknown; what no other station
  // can contradict is not estimated at all and tells nothing.
  const double square = 0.5 * estimate.error.squaredNorm() / reference;
  const double told = 1.0 - 0.5 * estimate.covariance.trace() / slowError(reference).variance;
  slow_sum_ = kept * slow_sum_ + h * params_.safety * square;
  slow_weight_ = kept * slow_weight_ + h * std::clamp(told, 0.0, 1.0);

  if (past_count_ > 0 && seconds(estimate.time - past_[past_count_ - 1].time) < kSlowInterval) return;
  // Correlation with what was found about half a time constant ago.
  const Eigen::Vector3d error = estimate.basis.transpose() * estimate.error / std::sqrt(reference);
  const double lag = std::clamp(0.5 * timeConstant(), 0.2, 1.5);
  for (std::size_t i = past_count_; i-- > 0;) {
    const double age = seconds(estimate.time - past_[i].time);
    if (age < lag) continue;
    if (age > 1.5 * lag + kSlowInterval) break;
    same_sum_ = kept * same_sum_ + h * 0.5 * (error.squaredNorm() + past_[i].error.squaredNorm());
    lag_sum_ = kept * lag_sum_ + h * error.dot(past_[i].error);
    lag_seconds_ = kept * lag_seconds_ + h * age;
    lag_weight_ = kept * lag_weight_ + h;
    break;
  }
  if (past_count_ == kPast) {
    std::move(past_.begin() + 1, past_.end(), past_.begin());
    --past_count_;
  }
  past_[past_count_++] = {estimate.time, error};
}

double StationNoise::slowScale() const {
  const double first = params_.slow_scale * params_.slow_scale;
  const double weight = params_.prior_weight + slow_weight_;
  if (!(weight > 0.0)) return params_.slow_scale;
  const double square = (params_.prior_weight * first + slow_sum_) / weight;
  return std::clamp(std::sqrt(square), params_.least_scale, params_.most_scale);
}

double StationNoise::timeConstant() const {
  if (!params_.learn_time || lag_weight_ < kFewestLags || !(same_sum_ > 0.0)) return params_.time_constant;
  const double correlation = std::clamp(lag_sum_ / same_sum_, 1e-3, 0.999);
  return std::clamp(-lag_seconds_ / lag_weight_ / std::log(correlation), params_.least_time,
                    params_.most_time);
}

SlowError StationNoise::slowError(double reference) const {
  const double scale = slowScale();
  return {scale * scale * reference, timeConstant()};
}

}  // namespace sightline::core
