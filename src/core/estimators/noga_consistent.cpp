#include "sightline/core/estimators/noga_consistent.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include <Eigen/Cholesky>

#include "sightline/core/model/kinematics.h"

namespace sightline::core {
namespace {

// Section 4.2 and 4.3; sigmas in amplitudes [rad] per s^n, kappa in 1/s^2.
constexpr double kInitialSigma = 2.0;        // of rate, acceleration and kappa before anything is known
constexpr double kSigmasOfAmplitude = 10.0;  // amplitude over sigma where the amplitude is not given
constexpr double kCoupling = 1e-6;           // correlation from which azimuth and elevation count as coupled
constexpr double kLongestStep = 30.0;        // [units of time]; what was known of a target is lost by then
constexpr double kOutlierReach = 20.0;  // sigmas of the innovation over which outliers lie at least: a track
                                        // that has just started must believe its second sighting

using Matrix8d = Eigen::Matrix<double, 8, 8>;
using Vector8d = Eigen::Matrix<double, 8, 1>;

void check(const NogaConsistentParams& params) {
  if (params.models.empty() || params.models.size() > kMaxModes) {
    throw std::invalid_argument("NogaConsistentParams: 1 to " + std::to_string(kMaxModes) +
                                " models are required, got " + std::to_string(params.models.size()));
  }
  for (const ResponseModel& model : params.models) check(model);
  if (!(params.amplitude >= 0.0) || !(params.initial_rate_sigma >= 0.0) ||
      !(params.outlier_share >= 0.0 && params.outlier_share < 1.0) || !(params.outlier_width > 0.0)) {
    throw std::invalid_argument(
        "NogaConsistentParams: amplitude >= 0 rad, initial_rate_sigma >= 0 rad/s, outlier_share in [0, 1) "
        "and "
        "outlier_width > 0 are "
        "required");
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
NoiseLearningParams noiseLearning(const NogaConsistentParams& params) {
  NoiseLearningParams learning = params.noise;
  if (params.amplitude > 0.0) learning.enabled = false;
  return learning;
}

/// log(exp(a) + exp(b)).
double logSum(double a, double b) {
  return std::max(a, b) + std::log1p(std::exp(-std::abs(a - b)));
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
  params.noise.enabled = false;
  return params;
}

NogaConsistentEstimator::NogaConsistentEstimator(const NogaConsistentParams& params)
    : params_(params),
      chain_(attractions(params), params.dwell),
      rate_(params.initial_rate_sigma),
      noise_learning_(noiseLearning(params)) {}

std::unique_ptr<Estimator> NogaConsistentEstimator::clone() const {
  return std::unique_ptr<Estimator>(new NogaConsistentEstimator(*this));
}

void NogaConsistentEstimator::update(const Measurement& measurement) {
  const Eigen::Matrix2d& R = measurement.covariance;
  coupled_ = coupled_ || std::abs(R(0, 1)) > kCoupling * std::sqrt(R(0, 0) * R(1, 1));
  if (measurement.is_certain || !time_) sighting_noise_.add(R, measurement.sightings);
  const double h = time_ ? seconds(measurement.time - *time_) : 0.0;
  const double units = h / revisit_.unit(h);
  if (time_ && units <= kLongestStep) {
    is_second_look_ = rate_.isOpen();
    if (!revisit_.isKnown()) {
      const Belief& belief = beliefs_[0];
      const Eigen::Vector2d position(belief.mean[0](0), belief.mean[1](0));
      Eigen::Matrix2d both = R;
      both.diagonal() += Eigen::Vector2d(belief.covariance[0](0, 0), belief.covariance[1](0, 0));
      rate_.learn(measurement.position - position, both, h);
      setUnknown(h);
    }
    noise_learning_.next(units);
    beliefs_ = expected(h);  // 4.3 (i), (ii)
    ModeArray log_likelihoods(modes());
    for (int mode = 0; mode < modes(); ++mode) {
      const auto kind = params_.models[static_cast<std::size_t>(mode)].kind;
      log_likelihoods(mode) =
          reduce(beliefs_[mode], measurement, kind == ResponseModel::Kind::straight);  // (iii)
    }
    if (!measurement.is_certain) log_likelihoods.setZero();  // it tells nothing of the models
    chain_.update(units, log_likelihoods);                   // (iv)
    revisit_.note(h);
  } else {
    start(measurement);
  }
  time_ = measurement.time;
}

/// The angle [rad] that stands for 1 rad of the bank, where the sightings have `noise` times the stated
/// variance.
double NogaConsistentEstimator::amplitude(int channel, double noise) const {
  if (params_.amplitude > 0.0) return params_.amplitude;
  return kSigmasOfAmplitude * std::sqrt(noise * sighting_noise_.covariance()(channel, channel));
}

void NogaConsistentEstimator::start(const Measurement& measurement) {
  for (int mode = 0; mode < modes(); ++mode) {
    Belief& belief = beliefs_[mode];
    belief.cross(0, 0) = measurement.covariance(0, 1);
    for (int channel = 0; channel < 2; ++channel) {
      belief.mean[channel] << measurement.position(channel), 0.0, 0.0, 0.0;
      belief.covariance[channel](0, 0) = measurement.covariance(channel, channel);
    }
  }
  setUnknown(0.0);
}

/// Variances of what one sighting does not tell, for a prediction `h` seconds ahead.
void NogaConsistentEstimator::setUnknown(double h) {
  const double unit = revisit_.unit(h);
  const double kappa_sigma = kInitialSigma / (unit * unit);
  for (int mode = 0; mode < modes(); ++mode) {
    const ResponseModel& model = params_.models[static_cast<std::size_t>(mode)];
    for (int channel = 0; channel < 2; ++channel) {
      const double acceleration_sigma = kappa_sigma * amplitude(channel, 1.0);
      beliefs_[mode].covariance[channel].diagonal().tail<3>() << rate_.variance(),
          acceleration_sigma * acceleration_sigma, kappa_sigma * kappa_sigma;
      if (model.kind == ResponseModel::Kind::fixed_harmonic)
        beliefs_[mode].mean[channel](3) = model.kappa / (unit * unit);
    }
  }
}

/// What each model expects `h` seconds after the last sighting, after the models have interacted.
NogaConsistentEstimator::Beliefs NogaConsistentEstimator::expected(double h) const {  // (S-25), (S-26)
  const double unit = revisit_.unit(h);
  const double units = std::clamp(h / unit, -kLongestStep, kLongestStep);
  const ModeArray own = chain_.ownShares(units);
  const Belief all = mixtureOfAll();
  Beliefs ahead;
  for (int mode = 0; mode < modes(); ++mode) {
    const ResponseModel& model = params_.models[static_cast<std::size_t>(mode)];
    const Belief& own_belief = beliefs_[mode];
    if (model.kind == ResponseModel::Kind::straight)
      blend<2>(own(mode), own_belief, all, ahead[mode]);
    else
      blend<4>(own(mode), own_belief, all, ahead[mode]);
    const Eigen::Vector2d& noise = ahead[mode].noise;
    inUnits(ahead[mode], unit);
    step(ahead[mode], model, {amplitude(0, noise(0)), amplitude(1, noise(1))}, units, coupled_);
    inUnits(ahead[mode], 1.0 / unit);
  }
  return ahead;
}

NogaConsistentEstimator::Belief NogaConsistentEstimator::mixtureOfAll() const {  // (S-6)
  const ModeArray& weights = chain_.probabilities();
  Belief all;
  all.noise.setZero();
  for (int mode = 0; mode < modes(); ++mode) {
    for (int channel = 0; channel < 2; ++channel)
      all.mean[channel] += weights(mode) * beliefs_[mode].mean[channel];
    all.noise += weights(mode) * beliefs_[mode].noise;
  }
  for (int mode = 0; mode < modes(); ++mode) {
    Eigen::Vector4d offset[2];
    for (int channel = 0; channel < 2; ++channel) {
      offset[channel] = beliefs_[mode].mean[channel] - all.mean[channel];
      all.covariance[channel] += weights(mode) * beliefs_[mode].covariance[channel];
      all.covariance[channel].noalias() += weights(mode) * offset[channel] * offset[channel].transpose();
    }
    if (coupled_) all.cross += weights(mode) * (beliefs_[mode].cross + offset[0] * offset[1].transpose());
  }
  return all;
}

/// `share` of `own`, for the rest `other`, in the first N components.
template <int N>
void NogaConsistentEstimator::blend(double share, const Belief& own, const Belief& other,
                                    Belief& mixed) const {  // (S-6)
  const double rest = 1.0 - share;
  Eigen::Matrix<double, N, 1> offset[2];
  for (int channel = 0; channel < 2; ++channel) {
    offset[channel] = (own.mean[channel] - other.mean[channel]).template head<N>();
    mixed.mean[channel].template head<N>() = other.mean[channel].template head<N>() + share * offset[channel];
    auto covariance = mixed.covariance[channel].template topLeftCorner<N, N>();
    covariance = share * own.covariance[channel].template topLeftCorner<N, N>() +
                 rest * other.covariance[channel].template topLeftCorner<N, N>();
    covariance.noalias() += (share * rest * offset[channel]) * offset[channel].transpose();
  }
  if (coupled_) {
    mixed.cross.setZero();
    mixed.cross.template topLeftCorner<N, N>() = share * own.cross.template topLeftCorner<N, N>() +
                                                 rest * other.cross.template topLeftCorner<N, N>() +
                                                 share * rest * offset[0] * offset[1].transpose();
  }
  mixed.noise = share * own.noise + rest * other.noise;
}

/// The reduction (20)-(23) with the sighting; returns the log likelihood of the model.
double NogaConsistentEstimator::reduce(Belief& belief, const Measurement& measurement,
                                       bool is_straight) const {
  double log_likelihood = 0.0;
  Eigen::Vector2d distances_squared;
  if (coupled_) {
    log_likelihood = reduceCoupled(belief, measurement, distances_squared);
  } else {
    for (int channel = 0; channel < 2; ++channel) {
      const double position = measurement.position(channel);
      const double variance = belief.noise(channel) * measurement.covariance(channel, channel);
      log_likelihood +=
          is_straight ? reduceChannel<2>(belief, channel, position, variance, distances_squared(channel))
                      : reduceChannel<4>(belief, channel, position, variance, distances_squared(channel));
    }
  }
  if (measurement.is_certain) learnNoise(belief, distances_squared);
  return log_likelihood;
}

/// Takes the innovations, squared and over what was expected of them, as evidence of the sightings' noise;
/// the angles' covariance grows and shrinks with it, as does every gain's denominator: the gains stay.
// (S-11)
void NogaConsistentEstimator::learnNoise(Belief& belief, const Eigen::Vector2d& distances_squared) const {
  Eigen::Vector4d growth[2];
  for (int channel = 0; channel < 2; ++channel) {
    const double before = belief.noise(channel);
    belief.noise(channel) = noise_learning_.learnt(before, distances_squared(channel));
    growth[channel].setConstant(std::sqrt(belief.noise(channel) / before));
    growth[channel](3) = 1.0;  // kappa is no angle
    belief.covariance[channel] =
        growth[channel].asDiagonal() * belief.covariance[channel] * growth[channel].asDiagonal();
  }
  if (coupled_) belief.cross = growth[0].asDiagonal() * belief.cross * growth[1].asDiagonal();
}

Eigen::Vector2d NogaConsistentEstimator::noiseScale() const {
  if (!time_) return Eigen::Vector2d::Ones();
  Eigen::Vector2d scale = Eigen::Vector2d::Zero();
  for (int mode = 0; mode < modes(); ++mode) scale += chain_.probabilities()(mode) * beliefs_[mode].noise;
  return scale;
}

/// A target whose rates are not known yet has no outliers: its second sighting may be anywhere.
double NogaConsistentEstimator::outlierShare() const {
  return is_second_look_ ? 0.0 : params_.outlier_share;
}

/// Soft gate: the share of a sighting that is the target's, when outliers are spread evenly.
double NogaConsistentEstimator::takenShare(double log_likelihood, double log_outlier_density,
                                           double& log_mixture) const {  // (S-28)
  const double share = outlierShare();
  if (share == 0.0) {
    log_mixture = log_likelihood;
    return 1.0;
  }
  const double genuine = std::log1p(-share) + log_likelihood;
  log_mixture = logSum(genuine, std::log(share) + log_outlier_density);
  return std::exp(genuine - log_mixture);
}

/// `D`: variance of the innovation.
double NogaConsistentEstimator::logOutlierDensity(int channel, double noise, double D) const {  // (S-28)
  return -std::log(std::max(params_.outlier_width * amplitude(channel, noise), kOutlierReach * std::sqrt(D)));
}

/// With only the first N components known to the model.
template <int N>
double NogaConsistentEstimator::reduceChannel(Belief& belief, int channel, double position, double variance,
                                              double& distance_squared) const {
  using Vector = Eigen::Matrix<double, N, 1>;
  using Matrix = Eigen::Matrix<double, N, N>;
  auto x = belief.mean[channel].template head<N>();
  const Matrix P = belief.covariance[channel].template topLeftCorner<N, N>();
  const double D = P(0, 0) + variance, nu = position - x(0);
  double log_mixture = 0.0;
  const double beta = takenShare(noise_learning_.logDensity(nu * nu / D, std::log(D)),
                                 logOutlierDensity(channel, belief.noise(channel), D), log_mixture);
  distance_squared = beta * nu * nu / D + (1.0 - beta);  // an outlier tells nothing

  // (I - K H) P (I - K H)^T + K variance K^T (S-7); only the first column of I - K H is not that of I, and
  // variance / D is its first element free of the cancellation in 1 - K.
  const Vector K = P.col(0) / D;
  Vector column = -K;
  column(0) = variance / D;
  Matrix half = P;
  half.row(0).setZero();
  half.noalias() += column * P.row(0);
  Matrix taken = half;
  taken.col(0).setZero();
  taken.noalias() += half.col(0) * column.transpose();
  taken.noalias() += (variance * K) * K.transpose();
  x += beta * nu * K;
  taken = (1.0 - beta) * P + beta * taken;
  taken.noalias() += (beta * (1.0 - beta) * nu * nu * K) * K.transpose();
  belief.covariance[channel].template topLeftCorner<N, N>() = symmetric(taken);
  return log_mixture;
}

double NogaConsistentEstimator::reduceCoupled(Belief& belief, const Measurement& measurement,
                                              Eigen::Vector2d& distances_squared) const {
  Vector8d x;
  Matrix8d P;
  x << belief.mean[0], belief.mean[1];
  P << belief.covariance[0], belief.cross, belief.cross.transpose(), belief.covariance[1];
  Eigen::Matrix<double, 8, 2> PH;
  PH << P.col(0), P.col(4);
  const Eigen::Matrix2d R = noiseCovariance(measurement.covariance, belief.noise);
  const Eigen::Matrix2d D = (Eigen::Matrix2d() << P(0, 0), P(0, 4), P(4, 0), P(4, 4)).finished() + R;
  const Eigen::LLT<Eigen::Matrix2d> llt(D);
  const Eigen::Vector2d nu = measurement.position - Eigen::Vector2d(x(0), x(4));
  const Eigen::Vector2d white = llt.matrixL().solve(nu);
  double log_likelihood = 0.0, log_outlier_density = 0.0, log_mixture = 0.0;
  for (int i = 0; i < 2; ++i) {
    log_likelihood += noise_learning_.logDensity(white(i) * white(i), 2.0 * std::log(llt.matrixLLT()(i, i)));
    log_outlier_density += logOutlierDensity(i, belief.noise(i), D(i, i));
  }
  const double beta = takenShare(log_likelihood, log_outlier_density, log_mixture);
  distances_squared = beta * nu.cwiseAbs2().cwiseQuotient(D.diagonal()).array() + (1.0 - beta);

  const Eigen::Matrix<double, 8, 2> K = llt.solve(PH.transpose()).transpose();
  Matrix8d J = Matrix8d::Identity();
  J.col(0) -= K.col(0);
  J.col(4) -= K.col(1);
  const Matrix8d taken = J * P * J.transpose() + K * R * K.transpose();  // (S-7)
  const Vector8d shift = K * nu;
  x += beta * shift;
  P = symmetric((1.0 - beta) * P + beta * taken + beta * (1.0 - beta) * shift * shift.transpose());
  belief.mean[0] = x.head<4>();
  belief.mean[1] = x.tail<4>();
  belief.covariance[0] = P.topLeftCorner<4, 4>();
  belief.covariance[1] = P.bottomRightCorner<4, 4>();
  belief.cross = P.topRightCorner<4, 4>();
  return log_mixture;
}

std::optional<AngularState> NogaConsistentEstimator::stateAt(Time time) const {
  if (!time_) return std::nullopt;
  const double h = seconds(time - *time_);
  if (rate_.isOpen()) {
    const AngularState first = moments(chain_.probabilities(), beliefs_);
    return rate_.stateAfter(h, first.angles(), first.anglesCovariance());
  }
  if (h == 0.0) return moments(chain_.probabilities(), beliefs_);
  return moments(chain_.predicted(h / revisit_.unit(h)), expected(h));
}

std::vector<Hypothesis> NogaConsistentEstimator::hypothesesAt(Time time) const {
  if (!time_ || rate_.isOpen()) return Estimator::hypothesesAt(time);
  const double h = seconds(time - *time_);
  return hypothesesOf(chain_.predicted(h / revisit_.unit(h)), motionsOf(expected(h)).data());
}

/// Position and rates by each model.
std::array<Motion<4>, kMaxModes> NogaConsistentEstimator::motionsOf(const Beliefs& beliefs) const {
  std::array<Motion<4>, kMaxModes> motions;
  for (int mode = 0; mode < modes(); ++mode) motions[mode] = motionOf(beliefs[mode]);
  return motions;
}

/// Position and rates of the mixture (S-6).
AngularState NogaConsistentEstimator::moments(const ModeArray& weights, const Beliefs& beliefs) const {
  return mixture(weights, motionsOf(beliefs).data()).angularState();
}

void NogaConsistentEstimator::rotate(const Eigen::Matrix3d& R_new_old) {
  if (!time_) return;
  sighting_noise_.transform(rotationJacobian({beliefs_[0].mean[0](0), beliefs_[0].mean[1](0)}, R_new_old));
  for (int mode = 0; mode < modes(); ++mode) turn(beliefs_[mode], R_new_old);
  coupled_ = coupled_ || beliefs_[0].cross.cwiseAbs().maxCoeff() > 0.0;
}

}  // namespace sightline::core
