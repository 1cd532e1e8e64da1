#include "sightline/core/twbls_consistent.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <Eigen/Cholesky>

namespace sightline::core {
namespace {

constexpr double kSameTime = 1e-6;  // sightings closer than this [s] determine no rate

/// The sightings at one instant taken together.
void join(Measurement& mean, const Measurement& other) {
  Motion<4> motion;
  motion.mean.head<2>() = mean.position;
  motion.covariance.topLeftCorner<2, 2>() = mean.covariance;
  motion.covariance.bottomRightCorner<2, 2>().setIdentity();
  condition(motion, other.position, other.covariance);
  mean.position = motion.mean.head<2>();
  mean.covariance = motion.covariance.topLeftCorner<2, 2>();
}

/// The motion at the second of two sightings `h` seconds apart when nothing was known before: the limit of an
/// endless prior.
Motion<4> throughTwo(const Measurement& first, const Measurement& second, double h,
                     const Eigen::Matrix2d& density) {
  Motion<4> motion;
  motion.mean << second.position, (second.position - first.position) / h;
  motion.covariance.topLeftCorner<2, 2>() = second.covariance;
  motion.covariance.topRightCorner<2, 2>() = motion.covariance.bottomLeftCorner<2, 2>() =
      second.covariance / h;
  motion.covariance.bottomRightCorner<2, 2>() =
      (first.covariance + second.covariance) / (h * h) + h / 3.0 * density;
  return motion;
}

}  // namespace

TwblsConsistentEstimator::TwblsConsistentEstimator(const TwblsConsistentParams& params)
    : params_(params), evidence_(ModeArray::Zero(static_cast<Eigen::Index>(params.process_noises.size()))) {
  const bool sound_bank =
      !params.process_noises.empty() && params.process_noises.size() <= kMaxModes &&
      std::all_of(params.process_noises.begin(), params.process_noises.end(), [](const ProcessNoise& noise) {
        return noise.density > 0.0 || (noise.density == 0.0 && noise.ratio > 0.0);
      });
  if (!sound_bank || params.max_sightings < 3 || !(params.memory > 0.0) ||
      !(params.initial_rate_sigma > 0.0)) {
    throw std::invalid_argument("TwblsConsistentParams: 1 to " + std::to_string(kMaxModes) +
                                " process noises with density or ratio > 0, max_sightings >= 3, memory and "
                                "initial_rate_sigma > 0 are required");
  }
  window_.reserve(static_cast<std::size_t>(params.max_sightings) + 1);
}

std::unique_ptr<Estimator> TwblsConsistentEstimator::clone() const {
  return std::unique_ptr<Estimator>(new TwblsConsistentEstimator(*this));
}

void TwblsConsistentEstimator::update(const Measurement& measurement) {
  if (!window_.empty()) weigh(measurement);
  noise_.add(measurement.covariance, measurement.sightings);
  window_.push_back(measurement);
  if (window_.size() > static_cast<std::size_t>(params_.max_sightings)) window_.erase(window_.begin());
  fitWindow();
}

/// The evidence fades, and each process noise gains the log likelihood of what it had predicted.
void TwblsConsistentEstimator::weigh(const Measurement& measurement) {
  const double h = seconds(measurement.time - window_.back().time);
  evidence_ *= std::exp(-h / params_.memory);
  if (!isDetermined()) return;  // nothing was predicted
  for (int mode = 0; mode < modes(); ++mode) {
    Motion<4> predicted = motions_[mode];
    moveOn(predicted, h);
    addWhiteAcceleration(
        predicted, params_.process_noises[static_cast<std::size_t>(mode)].densityFor(noise_.covariance()), h);
    evidence_(mode) += condition(predicted, measurement.position, measurement.covariance);
  }
}

ModeArray TwblsConsistentEstimator::weights() const {
  const ModeArray likelihood = (evidence_ - evidence_.maxCoeff()).exp();
  return likelihood / likelihood.sum();
}

void TwblsConsistentEstimator::fitWindow() {
  for (int mode = 0; mode < modes(); ++mode) {
    motions_[mode] =
        fitted(params_.process_noises[static_cast<std::size_t>(mode)].densityFor(noise_.covariance()));
  }
}

/// The generalised least squares line (S-5) at the last sighting for one density.
Motion<4> TwblsConsistentEstimator::fitted(const Eigen::Matrix2d& density) const {
  Measurement first = window_.front();
  std::size_t next = 1;
  while (next < window_.size() && seconds(window_[next].time - first.time) < kSameTime)
    join(first, window_[next++]);
  Motion<4> motion;
  if (next == window_.size()) {
    const AngularState state = firstState(first, params_.initial_rate_sigma);
    motion.mean = state.mean;
    motion.covariance = state.covariance;
    return motion;
  }
  motion = throughTwo(first, window_[next], seconds(window_[next].time - first.time), density);
  for (++next; next < window_.size(); ++next) {
    const double h = seconds(window_[next].time - window_[next - 1].time);
    moveOn(motion, h);
    addWhiteAcceleration(motion, density, h);
    condition(motion, window_[next].position, window_[next].covariance);
  }
  return motion;
}

std::optional<AngularState> TwblsConsistentEstimator::stateAt(Time time) const {
  if (window_.empty()) return std::nullopt;
  const double h = seconds(time - window_.back().time);
  Motion<4> predicted[kMaxModes];
  for (int mode = 0; mode < modes(); ++mode) {
    predicted[mode] = motions_[mode];
    moveOn(predicted[mode], h);
    addWhiteAcceleration(
        predicted[mode],
        params_.process_noises[static_cast<std::size_t>(mode)].densityFor(noise_.covariance()), h);
  }
  const double span = seconds(window_.back().time - window_.front().time);
  return withRatePrior(mixture(weights(), predicted).angularState(), params_.initial_rate_sigma,
                       window_.size(), span);  // (S-6)
}

void TwblsConsistentEstimator::rotate(const Eigen::Matrix3d& R_new_old) {
  if (window_.empty()) return;
  noise_.transform(rotationJacobian(window_.back().position, R_new_old));
  for (Measurement& sighting : window_) sighting = core::rotate(sighting, R_new_old);
  fitWindow();
}

}  // namespace sightline::core
