#include "sightline/core/estimators/kalman.h"

#include <stdexcept>
#include <string>

namespace sightline::core {

KalmanEstimator::KalmanEstimator(const KalmanParams& params)
    : params_(params), rate_(params.initial_rate_sigma) {
  if (!(params.process_noise >= 0.0) || !(params.process_noise > 0.0 || params.process_noise_ratio > 0.0) ||
      !(params.initial_rate_sigma >= 0.0)) {
    throw std::invalid_argument(
        "KalmanParams: process_noise >= 0 (0 = by process_noise_ratio), process_noise_ratio > 0 and "
        "initial_rate_sigma >= 0 are required, got " +
        std::to_string(params.process_noise) + ", " + std::to_string(params.process_noise_ratio) + " and " +
        std::to_string(params.initial_rate_sigma));
  }
}

std::unique_ptr<Estimator> KalmanEstimator::clone() const {
  return std::unique_ptr<Estimator>(new KalmanEstimator(*this));
}

void KalmanEstimator::update(const Measurement& measurement) {  // (S-18)
  if (time_) {
    const double h = seconds(measurement.time - *time_);
    rate_.learn(measurement.position - motion_.mean.head<2>(),
                motion_.covariance.topLeftCorner<2, 2>() + measurement.covariance, h);
    if (!revisit_.isKnown()) motion_.covariance.diagonal().tail<2>().setConstant(rate_.variance());
    motion_ = predicted(measurement.time);
    revisit_.note(h);
    condition(motion_, measurement.position, measurement.covariance);
  } else {
    const AngularState first = firstState(measurement, rate_.sigma());
    motion_ = {first.mean, first.covariance};
  }
  noise_.add(measurement.covariance, measurement.sightings);
  time_ = measurement.time;
}

std::optional<AngularState> KalmanEstimator::stateAt(Time time) const {
  if (!time_) return std::nullopt;
  if (rate_.isOpen()) {
    return rate_.stateAfter(seconds(time - *time_), motion_.mean.head<2>(),
                            motion_.covariance.topLeftCorner<2, 2>());
  }
  return predicted(time).angularState();
}

Motion<4> KalmanEstimator::predicted(Time time) const {  // (S-17)
  const double h = seconds(time - *time_), unit = revisit_.unit(h);
  Motion<4> motion = motion_;
  moveOn(motion, h);
  const ProcessNoise process_noise{params_.process_noise, params_.process_noise_ratio};
  Eigen::Matrix2d density = process_noise.accelerationFor(noise_.covariance(), unit);
  if (params_.process_noise == 0.0) density += passingAcceleration(motion_.mean.tail<2>(), unit);
  addWhiteAcceleration(motion, density, h);
  motion.covariance = symmetric(motion.covariance);
  return motion;
}

void KalmanEstimator::rotate(const Eigen::Matrix3d& R_new_old) {
  if (!time_) return;
  noise_.transform(rotationJacobian(motion_.mean.head<2>(), R_new_old));
  motion_ = rotateMotion(motion_, R_new_old);
}

}  // namespace sightline::core
