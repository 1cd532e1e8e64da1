#include "sightline/core/estimators/noga.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include <Eigen/LU>

#include "sightline/core/estimators/twbls.h"
#include "sightline/core/estimators/uncertainty_reduction.h"
#include "sightline/core/model/kinematics.h"

namespace sightline::core {
namespace {

constexpr int kMaxRows = 62;
constexpr double kPause = 8.0;            // mean intervals, beyond which an interval is a pause
constexpr double kLeastVariance = 1e-9;   // of a published position, in variances of a sighting
constexpr double kLeastRateMemory = 1.0;  // [s], in which the variance of a coasting rate grows by itself

using WindowArray = Eigen::Array<double, Eigen::Dynamic, 1, 0, kMaxRows + 2, 1>;
using Vector1 = Eigen::Matrix<double, 1, 1>;

void check(const NogaParams& params) {
  if (params.rows < 3 || params.rows > kMaxRows || !(params.initial_rate_sigma >= 0.0)) {
    throw std::invalid_argument("NogaParams: rows in [3, " + std::to_string(kMaxRows) +
                                "] and initial_rate_sigma >= 0 are required, got " +
                                std::to_string(params.rows) + " and " +
                                std::to_string(params.initial_rate_sigma));
  }
}

}  // namespace

/// What the model says of the next sighting's value in one channel: q = S (a_1, a_2, rate).
struct NogaEstimator::Response {
  LinearModel<double, 3, 1> model;
  Eigen::Matrix3d C_a = Eigen::Matrix3d::Zero();
  double printed_variance = 0.0;   // of q: S C_a S^T [rad^2]
  double residual_variance = 0.0;  // of q by the residuals of the auto-regression [rad^2]
};

NogaEstimator::NogaEstimator(const NogaParams& params) : params_(params), rate_(params.initial_rate_sigma) {
  check(params);
  const int capacity = params.rows + 2;
  time_.resize(static_cast<std::size_t>(capacity));
  for (Eigen::ArrayXd* array :
       {&value_[0], &value_[1], &variance_[0], &variance_[1], &cross_covariance_, &ifov_}) {
    array->setZero(capacity);
  }
}

std::unique_ptr<Estimator> NogaEstimator::clone() const {
  return std::unique_ptr<Estimator>(new NogaEstimator(*this));
}

void NogaEstimator::update(const Measurement& measurement) {
  const double h = size_ > 0 ? seconds(measurement.time - time_[size_ - 1]) : 0.0;
  if (size_ > 0) {
    rate_.learn(measurement.position - state_.angles(), state_.anglesCovariance() + measurement.covariance,
                h);
  }
  if (isPause(h)) series_ = 0;
  auto_regressive_ = hasRows();
  Measurement stored = measurement;
  if (auto_regressive_) {
    reduce(measurement);
    if (params_.feedback) stored.position = state_.angles();
  }
  store(stored);
  fitLines();
  if (auto_regressive_) {
    state_.mean.tail<2>() = line_.rates();
    state_.covariance.bottomRightCorner<2, 2>() = line_.covariance.bottomRightCorner<2, 2>();
  } else {
    state_ = line_;
  }
}

bool NogaEstimator::isPause(double h) const {
  return size_ > 1 && h > kPause * mean_;
}

/// (20)-(22) with the sighting as r and the auto-regression on those before it as the model.
void NogaEstimator::reduce(const Measurement& measurement) {
  const double h = seconds(measurement.time - time_[size_ - 1]);
  state_ = AngularState();
  for (int channel = 0; channel < 2; ++channel) {
    const Response response = responseAfter(channel, h);
    const double C_r = measurement.covariance(channel, channel);
    const auto reduced =
        reduceUncertainty(response.model, response.C_a, Vector1(measurement.position(channel)), Vector1(C_r));
    state_.mean(channel) = reduced.r(0);
    double variance = reduced.C_r(0);
    if (params_.covariance == NogaCovariance::residual) {
      // The estimate is (1 - g) q + g r, whatever the variances are called.
      const double g = response.printed_variance / (response.printed_variance + C_r);
      variance = (1.0 - g) * (1.0 - g) * response.residual_variance + g * g * C_r;
    }
    state_.covariance(channel, channel) = std::max(variance, kLeastVariance * C_r);
  }
}

NogaEstimator::Response NogaEstimator::responseAfter(int channel, double h) const {  // (S-30)
  // The auto-regression speaks of the next sighting. One that is late is where the line's rate takes it.
  const double late = h > longest_ ? h - mean_ : 0.0;
  const double next = h - late;
  const Eigen::ArrayXd& value = value_[channel];
  WindowArray weight = WindowArray::Ones(size_);
  if (params_.weighted) {
    for (int i = 0; i < size_; ++i) {  // (16)
      const double d = next + seconds(time_[size_ - 1] - time_[i]);
      weight(i) = d * std::exp(-d) / (ifov_(i) * ifov_(i));
    }
  }
  const AutoRegression fit = *fitAutoRegression(value, weight);

  Response response;
  const int k = size_;
  response.model.S << weight(k - 1) * value(k - 1), weight(k - 2) * value(k - 2), late;
  response.model.a << fit.a, line_.mean(channel + 2);
  response.model.q = response.model.S * response.model.a;
  response.C_a.topLeftCorner<2, 2>() = fit.C_a;
  response.C_a(2, 2) = line_.covariance(channel + 2, channel + 2);

  // EFIT^2 is of the sightings about the model: their own noise, that of the regressors, and the error of the
  // model.
  const Eigen::Array2d gain(fit.a(0) * weight(k - 1), fit.a(1) * weight(k - 2));
  const double regressors =
      (gain.square() * Eigen::Array2d(variance_[channel](k - 1), variance_[channel](k - 2))).sum();
  const double beyond_noise = fit.efit_squared - variance_[channel].mean();
  response.printed_variance = (response.model.S * response.C_a * response.model.S.transpose())(0);
  response.residual_variance = response.printed_variance + std::max(regressors, beyond_noise);
  return response;
}

void NogaEstimator::store(const Measurement& measurement) {
  const int capacity = params_.rows + 2;
  if (size_ == capacity) {
    std::copy(time_.begin() + 1, time_.end(), time_.begin());
    for (Eigen::ArrayXd* array :
         {&value_[0], &value_[1], &variance_[0], &variance_[1], &cross_covariance_, &ifov_}) {
      std::copy(array->begin() + 1, array->end(), array->begin());
    }
    --size_;
  }
  const int i = size_++;
  series_ = std::min(series_ + 1, capacity);
  time_[i] = measurement.time;
  for (int channel = 0; channel < 2; ++channel) {
    value_[channel](i) = measurement.position(channel);
    variance_[channel](i) = measurement.covariance(channel, channel);
  }
  cross_covariance_(i) = measurement.covariance(0, 1);
  // A sensor that does not tell its ifov counts as one whose ifov is its sigma.
  ifov_(i) = measurement.ifov > 0.0 ? measurement.ifov : std::pow(measurement.covariance.determinant(), 0.25);

  mean_ = size_ > 1 ? seconds(time_[size_ - 1] - time_[0]) / (size_ - 1) : 0.0;
  longest_ = 0.0;
  for (int j = size_ - series_ + 1; j < size_; ++j)
    longest_ = std::max(longest_, seconds(time_[j] - time_[j - 1]));
}

void NogaEstimator::fitLines() {  // (3), (S-2), (S-23)
  WindowArray age(size_);
  for (int i = 0; i < size_; ++i) age(i) = seconds(time_[size_ - 1] - time_[i]);
  Measurement last;
  for (int channel = 0; channel < 2; ++channel) {
    last.position(channel) = value_[channel](size_ - 1);
    last.covariance(channel, channel) = variance_[channel](size_ - 1);
  }
  line_ = firstState(last, rate_.sigma());
  for (int channel = 0; channel < 2; ++channel) {
    const auto variance = variance_[channel].head(size_);
    const auto fit = fitLine(age, value_[channel].head(size_), variance, WindowArray(variance.inverse()));
    if (!fit) continue;
    const Eigen::Matrix2d P = std::max(1.0, fit->misfit) * fit->covariance;
    line_.mean(channel) = fit->C(1);  // (position, rate) = (C_2, -C_1)
    line_.mean(channel + 2) = -fit->C(0);
    line_.covariance(channel, channel) = P(1, 1);
    line_.covariance(channel + 2, channel + 2) = P(0, 0);
    line_.covariance(channel, channel + 2) = line_.covariance(channel + 2, channel) = -P(0, 1);
  }
  line_ = withRatePrior(line_, rate_.sigma(), static_cast<std::size_t>(size_), age(0));
}

std::optional<AngularState> NogaEstimator::stateAt(Time time) const {
  if (size_ == 0) return std::nullopt;
  const double h = seconds(time - time_[size_ - 1]);
  if (rate_.isOpen()) return rate_.stateAfter(h, state_.angles(), state_.anglesCovariance());
  if (h <= 0.0 || !hasRows()) return coasted(state_, h);

  AngularState next = state_;
  const double late = h > longest_ ? h - mean_ : 0.0;
  next.covariance.topRightCorner<2, 2>().setZero();
  next.covariance.bottomLeftCorner<2, 2>().setZero();
  for (int channel = 0; channel < 2; ++channel) {
    const Response response = responseAfter(channel, h - late);
    const double variance = params_.covariance == NogaCovariance::residual ? response.residual_variance
                                                                           : response.printed_variance;
    next.mean(channel) = response.model.q(0);
    next.covariance(channel, channel) = std::max(variance, kLeastVariance * variance_[channel](size_ - 1));
  }
  return coasted(next, late);
}

/// The state `h` seconds later at its rates, which become less certain.
AngularState NogaEstimator::coasted(AngularState state, double h) const {  // (S-30)
  if (h == 0.0) return state;
  const double memory = std::max(mean_ * (size_ - 1), kLeastRateMemory);
  Motion<4> motion{state.mean, state.covariance};
  moveOn(motion, h);
  addWhiteAcceleration(motion, Eigen::Matrix2d(state.covariance.diagonal().tail<2>().asDiagonal()) / memory,
                       h);
  motion.covariance = symmetric(motion.covariance);
  return motion.angularState();
}

void NogaEstimator::rotate(const Eigen::Matrix3d& R_new_old) {
  if (size_ == 0) return;
  for (int i = size_; i-- > 0;) {
    const Eigen::Vector2d position(value_[0](i), value_[1](i));
    Eigen::Matrix2d R;
    R << variance_[0](i), cross_covariance_(i), cross_covariance_(i), variance_[1](i);
    const Eigen::Matrix2d J = rotationJacobian(position, R_new_old);
    Eigen::Vector2d turned = rotateAngles(position, R_new_old);
    if (i + 1 < size_) turned.x() = nextTo(value_[0](i + 1), turned.x());
    R = symmetric(J * R * J.transpose());
    for (int channel = 0; channel < 2; ++channel) {
      value_[channel](i) = turned(channel);
      variance_[channel](i) = R(channel, channel);
    }
    cross_covariance_(i) = R(0, 1);
  }
  state_ = rotateState(state_, R_new_old);
  fitLines();
}

}  // namespace sightline::core
