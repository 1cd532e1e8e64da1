#include "sightline/core/estimators/imm.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <tuple>

namespace sightline::core {
namespace {

constexpr double kAccelerationMemory = 1.0;  // [units of time], see ImmEstimator

void check(const ImmParams& params) {
  for (const ImmModel& model : params.models) {
    const auto& noise = model.noise;
    if ((model.order != 1 && model.order != 2) || !(noise.density >= 0.0) ||
        !(noise.density > 0.0 || noise.ratio > 0.0)) {
      throw std::invalid_argument(
          "ImmParams: a model needs order 1 or 2 and a noise density or ratio above 0, got order " +
          std::to_string(model.order) + ", density " + std::to_string(noise.density) + ", ratio " +
          std::to_string(noise.ratio));
    }
  }
  if (!(params.initial_rate_sigma >= 0.0) || !(params.initial_acceleration_sigma > 0.0)) {
    throw std::invalid_argument(
        "ImmParams: initial_rate_sigma >= 0 and initial_acceleration_sigma > 0 are required, got " +
        std::to_string(params.initial_rate_sigma) + " and " +
        std::to_string(params.initial_acceleration_sigma));
  }
}

/// The model that expects most of a target: of the highest order there is, that of the largest noise.
int agilestOf(const std::vector<ImmModel>& models) {
  const auto isCalmer = [](const ImmModel& a, const ImmModel& b) {
    return std::tie(a.order, a.noise.density, a.noise.ratio) <
           std::tie(b.order, b.noise.density, b.noise.ratio);
  };
  return static_cast<int>(std::max_element(models.begin(), models.end(), isCalmer) - models.begin());
}

Motion<4> withoutAcceleration(const Motion<6>& motion) {
  return {motion.mean.head<4>(), motion.covariance.topLeftCorner<4, 4>()};
}

/// With an acceleration of covariance `unknown`, of which position and rate say nothing.
Motion<6> withAcceleration(const Motion<4>& motion, const Eigen::Matrix2d& unknown) {
  Motion<6> whole;
  whole.mean.head<4>() = motion.mean;
  whole.covariance.topLeftCorner<4, 4>() = motion.covariance;
  whole.covariance.bottomRightCorner<2, 2>() = unknown;
  return whole;
}

}  // namespace

std::vector<ImmModel> defaultImmModels() {
  return {{1, {0.0, 1.0}}, {1, {0.0, 100.0}}, {2, {0.0, 100.0}}, {2, {0.0, 1e4}}};
}

ImmEstimator::ImmEstimator(const ImmParams& params)
    : params_(params),
      chain_(ModeArray::Ones(static_cast<Eigen::Index>(params.models.size())), params.dwell),
      rate_(params.initial_rate_sigma) {
  check(params);
}

std::unique_ptr<Estimator> ImmEstimator::clone() const {
  return std::unique_ptr<Estimator>(new ImmEstimator(*this));
}

void ImmEstimator::update(const Measurement& measurement) {  // (S-18), (S-27)
  if (time_) {
    const double h = seconds(measurement.time - *time_);
    if (!revisit_.isKnown()) {
      rate_.learn(measurement.position - motions_[0].mean.head<2>(),
                  motions_[0].covariance.topLeftCorner<2, 2>() + measurement.covariance, h);
      setUnknown(h);
    }
    predict(h, motions_);
    ModeArray log_likelihoods(modes());
    for (int mode = 0; mode < modes(); ++mode)
      log_likelihoods(mode) =
          condition(motions_[mode], measurement.position, measurement.covariance).logLikelihood();
    chain_.update(h / revisit_.unit(h), log_likelihoods);
    revisit_.note(h);
  } else {
    const AngularState first = firstState(measurement, rate_.sigma());
    Motion<6> motion;
    motion.mean.head<4>() = first.mean;
    motion.covariance.topLeftCorner<4, 4>() = first.covariance;
    motions_.fill(motion);
    setUnknown(0.0);
  }
  noise_.add(measurement.covariance, measurement.sightings);
  time_ = measurement.time;
}

/// Covariances of what one sighting does not tell, for a prediction `h` seconds ahead. Where nobody says how
/// fast the target is, a unit of time changes its rates by no more than their size: two sightings that tell
/// its rate tell no acceleration.
void ImmEstimator::setUnknown(double h) {  // (S-22)
  const double unit = revisit_.unit(h);
  double acceleration_sigma = params_.initial_acceleration_sigma / (unit * unit);
  if (params_.initial_rate_sigma == 0.0)
    acceleration_sigma = std::min(acceleration_sigma, rate_.sigma() / unit);
  for (int mode = 0; mode < modes(); ++mode) {
    auto diagonal = motions_[mode].covariance.diagonal();
    diagonal.segment<2>(2).setConstant(rate_.variance());
    diagonal.tail<2>().setConstant(acceleration_sigma * acceleration_sigma);
  }
}

std::optional<AngularState> ImmEstimator::stateAt(Time time) const {
  if (!time_) return std::nullopt;
  const double h = seconds(time - *time_);
  const Motion<6>& first = motions_[0];
  if (rate_.isOpen())
    return rate_.stateAfter(h, first.mean.head<2>(), first.covariance.topLeftCorner<2, 2>());
  if (h == 0.0) return mixture(chain_.probabilities(), motions_.data()).angularState();
  return mixture(chain_.predicted(h / revisit_.unit(h)), predicted(h).data()).angularState();  // (S-6)
}

std::vector<Hypothesis> ImmEstimator::hypothesesAt(Time time) const {
  if (!time_ || rate_.isOpen()) return Estimator::hypothesesAt(time);
  const double h = seconds(time - *time_);
  return hypothesesOf(chain_.predicted(h / revisit_.unit(h)), predicted(h).data());
}

ImmEstimator::Motions ImmEstimator::predicted(double h) const {
  Motions ahead;
  predict(h, ahead);
  return ahead;
}

/// What each model expects `h` seconds after the last sighting, after the models have interacted; `ahead` may
/// be the present motions themselves.
void ImmEstimator::predict(double h, Motions& ahead) const {  // (S-25), (S-26), (S-17)
  const double unit = revisit_.unit(h);
  const ModeArray own = chain_.ownShares(h / unit);
  const Motion<6> all = mixture(chain_.probabilities(), motions_.data());
  const Motion<4> all_of_first_order = withoutAcceleration(all);
  const Eigen::Matrix2d unknown = unknownAcceleration(unit);
  const int agilest = agilestOf(params_.models);
  for (int mode = 0; mode < modes(); ++mode) {
    const ImmModel& model = params_.models[static_cast<std::size_t>(mode)];
    if (model.order == 1) {
      Motion<4> motion = mixture(own(mode), withoutAcceleration(motions_[mode]), all_of_first_order);
      moveOn(motion, h);
      addWhiteAcceleration(motion, model.noise.accelerationFor(noise_.covariance(), unit), h);
      ahead[mode] = withAcceleration(motion, unknown);
    } else {
      Motion<6>& motion = ahead[mode] = mixture(own(mode), motions_[mode], all);
      moveOn(motion, h);
      addWhiteJerk(motion, model.noise.jerkFor(noise_.covariance(), unit), h);
    }
    if (mode == agilest && model.noise.density == 0.0)  // (S-97)
      addWhiteAcceleration(ahead[mode], passingAcceleration(all.mean.segment<2>(2), unit), h);
  }
}

/// Covariance of the acceleration by a model that has none.
Eigen::Matrix2d ImmEstimator::unknownAcceleration(double unit) const {  // (S-24)
  const ImmModel* mildest = nullptr;
  double least = 0.0;
  for (const ImmModel& model : params_.models) {
    if (model.order != 2) continue;
    const double strength = model.noise.jerkFor(noise_.covariance(), unit).trace();
    if (!mildest || strength < least) mildest = &model, least = strength;
  }
  if (!mildest) return Eigen::Matrix2d::Zero();
  return kAccelerationMemory * unit * mildest->noise.jerkFor(noise_.covariance(), unit);
}

void ImmEstimator::rotate(const Eigen::Matrix3d& R_new_old) {
  if (!time_) return;
  noise_.transform(rotationJacobian(motions_[0].mean.head<2>(), R_new_old));
  for (int mode = 0; mode < modes(); ++mode) motions_[mode] = rotateMotion(motions_[mode], R_new_old);
}

}  // namespace sightline::core
