#include "sightline/core/estimators/twbls_consistent.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <Eigen/Cholesky>

namespace sightline::core {
namespace {

constexpr std::size_t kMostSightings = 4096;  // of a window, whatever its span
constexpr std::size_t kUsualSightings = 256;  // that one sensor of 33 Hz needs

/// The sightings at one instant taken together.
void join(Measurement& mean, const Measurement& other) {  // (S-18)
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
                     const Eigen::Matrix2d& density) {  // (S-21)
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

std::vector<ProcessNoise> defaultAccelerations() {
  return {{0.0, 0.01},  {0.0, 1.0},   {0.0, 4.0}, {0.0, 12.0}, {0.0, 36.0},
          {0.0, 110.0}, {0.0, 330.0}, {0.0, 3e3}, {0.0, 1e5}};
}

TwblsConsistentEstimator::TwblsConsistentEstimator(const TwblsConsistentParams& params)
    : params_(params),
      rate_(params.initial_rate_sigma),
      noise_learning_(params.noise),
      evidence_(ModeArray::Zero(
          static_cast<Eigen::Index>(std::min<std::size_t>(params.process_noises.size(), kMaxModes)))) {
  const bool sound_bank =
      !params.process_noises.empty() && params.process_noises.size() <= kMaxModes &&
      std::all_of(params.process_noises.begin(), params.process_noises.end(), [](const ProcessNoise& noise) {
        return noise.density > 0.0 || (noise.density == 0.0 && noise.ratio > 0.0);
      });
  if (!sound_bank || params.sightings < 3 || !(params.min_span >= 0.0) || !(params.memory > 0.0) ||
      !(params.initial_rate_sigma >= 0.0)) {
    throw std::invalid_argument(
        "TwblsConsistentParams: 1 to " + std::to_string(kMaxModes) +
        " process noises with density or ratio > 0, sightings >= 3, min_span >= 0, memory "
        "> 0 and initial_rate_sigma >= 0 are required");
  }
  for (Eigen::Vector2d& noise : noise_) noise.setOnes();
  window_.reserve(kUsualSightings);
}

std::unique_ptr<Estimator> TwblsConsistentEstimator::clone() const {
  return std::unique_ptr<Estimator>(new TwblsConsistentEstimator(*this));
}

void TwblsConsistentEstimator::update(const Measurement& measurement) {
  if (!window_.empty()) {
    const double h = seconds(measurement.time - window_.back().time);
    rate_.learn(measurement.position - window_.back().position,
                window_.back().covariance + measurement.covariance, h);
    weigh(measurement);
    revisit_.note(h);
  }
  if (measurement.is_certain || window_.empty())
    sighting_noise_.add(measurement.covariance, measurement.sightings);
  add(measurement);
  shortenWindow();
}

/// The evidence fades, and each process noise gains the log likelihood of what it had predicted.
void TwblsConsistentEstimator::weigh(const Measurement& measurement) {  // (S-6), (S-11)
  if (!measurement.is_certain) return;  // nothing was seen that tells the models apart
  const double h = seconds(measurement.time - window_.back().time);
  const double units = h / revisit_.unit(h);
  evidence_ *= std::exp(-units / params_.memory);
  if (window_.size() < 2) return;  // nothing was predicted
  noise_learning_.next(units);
  for (int mode = 0; mode < modes(); ++mode) {
    const Motion<4> expected = predicted(mode, h);
    const Eigen::Matrix2d S =
        noiseCovariance(expected.covariance.topLeftCorner<2, 2>() + measurement.covariance, noise_[mode]);
    const Eigen::LLT<Eigen::Matrix2d> llt(symmetric(S));
    const Eigen::Vector2d innovation = measurement.position - expected.mean.head<2>();
    const Eigen::Vector2d white = llt.matrixL().solve(innovation);
    for (int i = 0; i < 2; ++i) {
      evidence_(mode) +=
          noise_learning_.logDensity(white(i) * white(i), 2.0 * std::log(llt.matrixLLT()(i, i)));
    }
    // A density given as such does not scale with the noise, so that the noise is taken as stated.
    if (params_.process_noises[static_cast<std::size_t>(mode)].density > 0.0) continue;
    for (int i = 0; i < 2; ++i)
      noise_[mode](i) = noise_learning_.learnt(noise_[mode](i), innovation(i) * innovation(i) / S(i, i));
  }
}

ModeArray TwblsConsistentEstimator::weights() const {  // (S-6)
  const ModeArray likelihood = (evidence_ - evidence_.maxCoeff()).exp();
  return likelihood / likelihood.sum();
}

Eigen::Vector2d TwblsConsistentEstimator::noiseScale() const {
  const ModeArray weight = weights();
  Eigen::Vector2d scale = Eigen::Vector2d::Zero();
  for (int mode = 0; mode < modes(); ++mode) scale += weight(mode) * noise_[mode];
  return scale;
}

void TwblsConsistentEstimator::learnNoise(bool enabled) {
  noise_learning_.enable(enabled);
  for (Eigen::Vector2d& scale : noise_) scale.setOnes();
}

/// Lengthens the window by a sighting; those at its first instant are one.
void TwblsConsistentEstimator::add(const Measurement& measurement) {
  if (window_.size() == 1 && seconds(measurement.time - window_.front().time) < kSameTime) {
    join(window_.front(), measurement);
  } else {
    window_.push_back(measurement);
  }
  for (int mode = 0; mode < modes(); ++mode) take(motions_[mode], mode, window_.size() - 1);
}

void TwblsConsistentEstimator::shortenWindow() {
  const auto least = static_cast<std::size_t>(params_.sightings);
  const std::size_t most = params_.exact_window ? least : 2 * least;
  if (window_.size() <= most) return;
  std::size_t keep = least;
  if (!params_.exact_window && window_.size() <= kMostSightings) {
    if (seconds(window_.back().time - window_.front().time) < 2.0 * params_.min_span) return;
    while (seconds(window_.back().time - window_[window_.size() - keep].time) < params_.min_span) ++keep;
  }
  window_.erase(window_.begin(), window_.end() - static_cast<std::ptrdiff_t>(keep));
  while (window_.size() > 1 && seconds(window_[1].time - window_[0].time) < kSameTime) {
    join(window_[0], window_[1]);
    window_.erase(window_.begin() + 1);
  }
  fitWindow();
}

void TwblsConsistentEstimator::fitWindow() {
  for (int mode = 0; mode < modes(); ++mode) {
    for (std::size_t index = 0; index < window_.size(); ++index) take(motions_[mode], mode, index);
  }
}

/// The generalised least squares line (S-5) through the window up to a sighting, at that sighting, from the
/// one up to the sighting before.
void TwblsConsistentEstimator::take(Motion<4>& motion, int mode, std::size_t index) const {
  const Measurement& sighting = window_[index];
  if (index == 0) {
    const AngularState state = firstState(sighting, rate_.sigma());
    motion.mean = state.mean;
    motion.covariance = state.covariance;
    return;
  }
  const double h = seconds(sighting.time - window_[index - 1].time);
  if (index == 1) {
    motion = throughTwo(window_[0], sighting, h, density(mode, h));
    return;
  }
  moveOn(motion, h);
  addWhiteAcceleration(motion, density(mode, h), h);
  condition(motion, sighting.position, sighting.covariance);
}

Eigen::Matrix2d TwblsConsistentEstimator::density(int mode, double h) const {  // (S-24), (S-91)
  return params_.process_noises[static_cast<std::size_t>(mode)].accelerationFor(sighting_noise_.covariance(),
                                                                                revisit_.unit(h));
}

/// By the stated covariances.
Motion<4> TwblsConsistentEstimator::predicted(int mode, double h) const {  // (S-17)
  Motion<4> motion = motions_[mode];
  moveOn(motion, h);
  addWhiteAcceleration(motion, density(mode, h), h);
  return motion;
}

std::optional<AngularState> TwblsConsistentEstimator::stateAt(Time time) const {
  if (window_.empty()) return std::nullopt;
  const double h = seconds(time - window_.back().time);
  if (rate_.isOpen()) return rate_.stateAfter(h, window_.back().position, window_.back().covariance);
  Motion<4> expected[kMaxModes];
  for (int mode = 0; mode < modes(); ++mode) {
    expected[mode] = predicted(mode, h);
    const Eigen::Vector4d growth = noise_[mode].cwiseSqrt().replicate<2, 1>();
    expected[mode].covariance = growth.asDiagonal() * expected[mode].covariance * growth.asDiagonal();
  }
  const double span = seconds(window_.back().time - window_.front().time) / revisit_.unit(h);
  return withRatePrior(mixture(weights(), expected).angularState(), rate_.sigma(), window_.size(),
                       span);  // (S-6)
}

void TwblsConsistentEstimator::rotate(const Eigen::Matrix3d& R_new_old) {
  if (window_.empty()) return;
  sighting_noise_.transform(rotationJacobian(window_.back().position, R_new_old));
  core::rotate(window_, R_new_old);
  fitWindow();
}

}  // namespace sightline::core
