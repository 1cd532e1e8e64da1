#include "sightline/core/estimators/noga_consistent.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "sightline/core/model/kinematics.h"

namespace sightline::core {
namespace {

// Section 4.2 and 4.3; sigmas in amplitudes [rad] per s^n, kappa in 1/s^2.
constexpr double kInitialSigma = 2.0;  // of rate, acceleration and kappa before anything is known
constexpr double kCoupling = 1e-6;     // correlation from which azimuth and elevation count as coupled
constexpr double kLongestStep = 30.0;  // [units of time]; what was known of a target is lost by then

void check(const NogaConsistentParams& params) {
  if (params.models.empty() || params.models.size() > kMaxModes) {
    throw std::invalid_argument("NogaConsistentParams: 1 to " + std::to_string(kMaxModes) +
                                " models are required, got " + std::to_string(params.models.size()));
  }
  for (const ResponseModel& model : params.models) check(model);
  if (!(params.amplitude >= 0.0) || !(params.initial_rate_sigma >= 0.0) ||
      !(params.outlier_share >= 0.0 && params.outlier_share < 1.0) || !(params.outlier_width > 0.0) ||
      !(params.left_out >= 0.0 && params.left_out < 1.0)) {
    throw std::invalid_argument(
        "NogaConsistentParams: amplitude >= 0 rad, initial_rate_sigma >= 0 rad/s, outlier_share and left_out "
        "in [0, 1) and outlier_width > 0 are required");
  }
}

ModeArray attractions(const NogaConsistentParams& params) {
  check(params);
  ModeArray attraction(static_cast<Eigen::Index>(params.models.size()));
  for (Eigen::Index i = 0; i < attraction.size(); ++i)
    attraction(i) = params.models[static_cast<std::size_t>(i)].attraction;
  return attraction;
}

/// A bank given at an amplitude does not scale with the noise, so that the noise is taken as stated.
NoiseLearningParams learningOf(const NogaConsistentParams& params) {
  NoiseLearningParams learning = params.noise;
  if (params.amplitude > 0.0) learning.enabled = false;
  return learning;
}

}  // namespace

NogaConsistentParams bankOfSection43() {
  NogaConsistentParams params;
  params.models = {
      {ResponseModel::Kind::straight, 1e-4},     {ResponseModel::Kind::straight, 0.05},
      {ResponseModel::Kind::straight, 0.7},      {ResponseModel::Kind::harmonic, 1e-3, 1e-2},
      {ResponseModel::Kind::harmonic, 0.3, 1.0}, {ResponseModel::Kind::fixed_harmonic, 1.0, 0.0, 8.0}};
  params.amplitude = 1.0;
  params.initial_rate_sigma = 2.0;
  params.dwell = 30.0;
  params.least_drawn = params.left_out = 0.0;
  params.noise.enabled = false;
  return params;
}

NogaConsistentEstimator::NogaConsistentEstimator(const NogaConsistentParams& params)
    : params_(params),
      chain_(attractions(params), params.dwell, params.least_drawn),
      bank_(modes()),
      rate_(params.initial_rate_sigma),
      noise_learning_(learningOf(params)) {}

std::unique_ptr<Estimator> NogaConsistentEstimator::clone() const {
  return std::unique_ptr<Estimator>(new NogaConsistentEstimator(*this));
}

std::optional<BankStep> NogaConsistentEstimator::updateWithStep(const Measurement& measurement) {
  std::optional<BankStep> step;
  take(measurement, &step);
  return step;
}

/// `step`: where to keep the step to this sighting, null = nowhere.
void NogaConsistentEstimator::take(const Measurement& measurement, std::optional<BankStep>* step) {
  const Eigen::Matrix2d& R = measurement.covariance;
  const bool couples = std::abs(R(0, 1)) > kCoupling * std::sqrt(R(0, 0) * R(1, 1));
  if (couples && !is_coupled_) ahead_.forget();
  is_coupled_ = is_coupled_ || couples;
  const double h = time_ ? seconds(measurement.time - *time_) : 0.0;
  const double units = h / revisit_.unit(h);
  if (time_ && !startsAnewAt(measurement.time)) {
    is_second_look_ = rate_.isOpen();
    if (!revisit_.isKnown()) {
      const ResponseBelief first = bank_.belief(0);
      Eigen::Matrix2d both = R;
      both.diagonal() += Eigen::Vector2d(first.covariance[0](0, 0), first.covariance[1](0, 0));
      rate_.learn(measurement.position - Eigen::Vector2d(first.mean[0](0), first.mean[1](0)), both, h);
      setUnknown(h);
      ahead_.forget();
    }
    if (step) {
      *step =
          BankStep{bank_, chain_, noise_learning_, amplitude(), h, revisit_.unit(h), is_coupled_, passing(h)};
    }
    noise_learning_.next(units);
    bank_ = expected(h);  // 4.3 (i), (ii)
    if (measurement.is_certain) sighting_noise_.add(R, measurement.sightings);
    const SoftGate gate{is_second_look_ ? 0.0 : params_.outlier_share, params_.outlier_width};
    ModeArray log_likelihoods =
        bank_.reduce(measurement, gate, noise_learning_, amplitude(), is_coupled_);  // (iii)
    if (!measurement.is_certain) log_likelihoods.setZero();  // it tells nothing of the models
    chain_.update(units, log_likelihoods);                   // (iv)
    revisit_.note(h);
  } else {
    if (measurement.is_certain || !time_) sighting_noise_.add(R, measurement.sightings);
    start(measurement);
  }
  time_ = measurement.time;
  ahead_.forget();
}

bool NogaConsistentEstimator::startsAnewAt(Time time) const {
  if (!time_) return false;
  const double h = seconds(time - *time_);
  return !(h / revisit_.unit(h) <= kLongestStep);
}

BankAmplitude NogaConsistentEstimator::amplitude() const {
  if (params_.amplitude > 0.0)
    return {Eigen::Vector2d::Constant(params_.amplitude * params_.amplitude), false};
  return {kSigmasOfAmplitude * kSigmasOfAmplitude * sighting_noise_.covariance().diagonal(), true};
}

void NogaConsistentEstimator::start(const Measurement& measurement) {
  bank_ = ResponseBank(modes());
  ResponseBelief belief;
  belief.cross(0, 0) = measurement.covariance(0, 1);
  for (int channel = 0; channel < 2; ++channel) {
    belief.mean[channel](0) = measurement.position(channel);
    belief.covariance[channel](0, 0) = measurement.covariance(channel, channel);
  }
  for (int mode = 0; mode < modes(); ++mode) bank_.setBelief(mode, belief);
  setUnknown(0.0);
}

/// Variances of what one sighting does not tell, for a prediction `h` seconds ahead.
void NogaConsistentEstimator::setUnknown(double h) {
  const double unit = revisit_.unit(h);
  const double kappa_sigma = kInitialSigma / (unit * unit);
  const Eigen::Vector2d acceleration_variance = kappa_sigma * kappa_sigma * amplitude().squared;
  for (int mode = 0; mode < modes(); ++mode) {
    const ResponseModel& model = params_.models[static_cast<std::size_t>(mode)];
    ResponseBelief belief = bank_.belief(mode);
    for (int channel = 0; channel < 2; ++channel) {
      belief.covariance[channel].diagonal().tail<3>() << rate_.variance(), acceleration_variance(channel),
          kappa_sigma * kappa_sigma;
      if (model.kind == ResponseModel::Kind::fixed_harmonic)
        belief.mean[channel](3) = model.kappa / (unit * unit);
    }
    bank_.setBelief(mode, belief);
  }
}

/// What each model expects `h` seconds after the last sighting, after the models have interacted.
const ResponseBank& NogaConsistentEstimator::expected(double h) const {  // (S-25), (S-26)
  if (ahead_.isFor(h)) return ahead_.bank();
  const double unit = revisit_.unit(h);
  const double units = std::clamp(h / unit, -kLongestStep, kLongestStep);
  ResponseBank& ahead = ahead_.begin(h, bank_);
  ahead.interact(chain_.ownShares(units), bank_.mixture(chain_.probabilities(), is_coupled_), is_coupled_);
  ahead.step(params_.models, units, unit, amplitude(), is_coupled_);
  const double density = passing(h);
  if (density > 0.0) ahead.addWhiteAcceleration(agilestStraight(params_.models), density, units * unit);
  return ahead;
}

/// Density of the acceleration of a target that passes by, for a prediction `h` seconds ahead [rad^2/s^3].
double NogaConsistentEstimator::passing(double h) const {  // (S-97)
  const double unit = revisit_.unit(h);
  if (params_.amplitude > 0.0 || unit == 1.0 || agilestStraight(params_.models) < 0) return 0.0;
  return passingAcceleration(bank_.motion(chain_.probabilities()).rates(), unit)(0, 0);
}

Eigen::Vector2d NogaConsistentEstimator::noiseScale() const {
  if (!time_) return Eigen::Vector2d::Ones();
  return bank_.noise(chain_.probabilities());
}

void NogaConsistentEstimator::learnNoise(bool enabled) {
  noise_learning_.enable(enabled);
  for (int mode = 0; mode < modes(); ++mode) {
    ResponseBelief belief = bank_.belief(mode);
    belief.noise.setOnes();
    bank_.setBelief(mode, belief);
  }
  ahead_.forget();
}

std::optional<AngularState> NogaConsistentEstimator::stateAt(Time time) const {
  if (!time_) return std::nullopt;
  const double h = seconds(time - *time_);
  if (rate_.isOpen()) {
    const AngularState first = bank_.motion(chain_.probabilities());
    return rate_.stateAfter(h, first.angles(), first.anglesCovariance());
  }
  if (h == 0.0) return bank_.motion(likelyShares(chain_.probabilities(), params_.left_out));
  return expected(h).motion(likelyShares(chain_.predicted(h / revisit_.unit(h)), params_.left_out));
}

std::vector<Hypothesis> NogaConsistentEstimator::hypothesesAt(Time time) const {
  if (!time_ || rate_.isOpen()) return Estimator::hypothesesAt(time);
  const double h = seconds(time - *time_);
  const ResponseBank& ahead = expected(h);
  std::array<Motion<4>, kMaxModes> motions;
  for (int mode = 0; mode < modes(); ++mode)
    motions[static_cast<std::size_t>(mode)] = motionOf(ahead.belief(mode));
  return hypothesesOf(likelyShares(chain_.predicted(h / revisit_.unit(h)), params_.left_out), motions.data());
}

void NogaConsistentEstimator::rotate(const Eigen::Matrix3d& R_new_old) {
  if (!time_) return;
  ahead_.forget();
  const ResponseBelief first = bank_.belief(0);
  sighting_noise_.transform(rotationJacobian({first.mean[0](0), first.mean[1](0)}, R_new_old));
  for (int mode = 0; mode < modes(); ++mode) {
    ResponseBelief belief = bank_.belief(mode);
    turn(belief, R_new_old);
    bank_.setBelief(mode, belief);
  }
  is_coupled_ = is_coupled_ || bank_.belief(0).cross.cwiseAbs().maxCoeff() > 0.0;
}

}  // namespace sightline::core
