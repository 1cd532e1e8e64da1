#include "sightline/core/noga_consistent.h"

#include <cmath>
#include <stdexcept>
#include <string>

#include <Eigen/Cholesky>

#include "sightline/core/kinematics.h"

namespace sightline::core {
namespace {

// Section 4.2 and 4.3; sigmas in amplitudes [rad] per s^n, kappa in 1/s^2.
constexpr double kInitialSigma = 2.0;     // of rate, acceleration and kappa before anything is known
constexpr double kUnusedSigma = 1.0;      // of acceleration and kappa after a model that does not know them
constexpr double kFixedKappaSigma = 4.0;  // of the kappa that a fixed harmonic hands to the others
constexpr double kSigmasOfAmplitude = 10.0;  // amplitude over sigma where the amplitude is not given
constexpr double kCoupling = 1e-6;           // correlation from which azimuth and elevation count as coupled
constexpr double kOutlierReach = 20.0;  // sigmas of the innovation over which outliers lie at least: a track
                                        // that has just started must believe its second sighting
constexpr double kLog2Pi = 1.8378770664093454836;

using Matrix8d = Eigen::Matrix<double, 8, 8>;
using Vector8d = Eigen::Matrix<double, 8, 1>;

void check(const NogaConsistentParams& params) {
  for (const ResponseModel& model : params.models) {
    if (!(model.q >= 0.0) || !(model.q_kappa >= 0.0) || !std::isfinite(model.kappa)) {
      throw std::invalid_argument(
          "NogaConsistentParams: a model needs q >= 0, q_kappa >= 0 and a finite kappa, got q " +
          std::to_string(model.q) + ", q_kappa " + std::to_string(model.q_kappa) + ", kappa " +
          std::to_string(model.kappa));
    }
  }
  if (!(params.amplitude >= 0.0) || !(params.initial_rate_sigma > 0.0) ||
      !(params.outlier_share >= 0.0 && params.outlier_share < 1.0) || !(params.outlier_width > 0.0)) {
    throw std::invalid_argument(
        "NogaConsistentParams: amplitude >= 0 rad, initial_rate_sigma > 0 rad/s, outlier_share in [0, 1) and "
        "outlier_width > 0 are "
        "required");
  }
}

/// log(exp(a) + exp(b)).
double logSum(double a, double b) {
  return std::max(a, b) + std::log1p(std::exp(-std::abs(a - b)));
}

}  // namespace

NogaConsistentEstimator::NogaConsistentEstimator(const NogaConsistentParams& params)
    : params_(params), chain_(static_cast<int>(params.models.size()), params.dwell) {
  check(params);
}

std::unique_ptr<Estimator> NogaConsistentEstimator::clone() const {
  return std::unique_ptr<Estimator>(new NogaConsistentEstimator(*this));
}

void NogaConsistentEstimator::update(const Measurement& measurement) {
  const Eigen::Matrix2d& R = measurement.covariance;
  coupled_ = coupled_ || std::abs(R(0, 1)) > kCoupling * std::sqrt(R(0, 0) * R(1, 1));
  noise_.add(R, measurement.sightings);
  if (time_) {
    const double h = seconds(measurement.time - *time_);
    beliefs_ = expected(h);  // 4.3 (i), (ii)
    ModeArray log_likelihoods(modes());
    for (int mode = 0; mode < modes(); ++mode)
      log_likelihoods(mode) = reduce(beliefs_[mode], measurement);  // (iii)
    chain_.update(h, log_likelihoods);                              // (iv)
  } else {
    start(measurement);
  }
  time_ = measurement.time;
}

/// The angle [rad] that stands for 1 rad of the bank.
double NogaConsistentEstimator::amplitude(int channel) const {
  if (params_.amplitude > 0.0) return params_.amplitude;
  return kSigmasOfAmplitude * std::sqrt(noise_.covariance()(channel, channel));
}

void NogaConsistentEstimator::start(const Measurement& measurement) {
  for (int mode = 0; mode < modes(); ++mode) {
    const ResponseModel& model = params_.models[static_cast<std::size_t>(mode)];
    Belief& belief = beliefs_[mode];
    belief.cross(0, 0) = measurement.covariance(0, 1);
    for (int channel = 0; channel < 2; ++channel) {
      const double acceleration_sigma = kInitialSigma * amplitude(channel);
      belief.mean[channel] << measurement.position(channel), 0.0, 0.0, 0.0;
      if (model.kind == ResponseModel::Kind::fixed_harmonic) belief.mean[channel](3) = model.kappa;
      belief.covariance[channel].diagonal() << measurement.covariance(channel, channel),
          params_.initial_rate_sigma * params_.initial_rate_sigma, acceleration_sigma * acceleration_sigma,
          kInitialSigma * kInitialSigma;
    }
  }
}

/// What each model expects `h` seconds after the last sighting, after the models have interacted.
NogaConsistentEstimator::Beliefs NogaConsistentEstimator::expected(double h) const {
  const ModeMatrix mixing = chain_.mixing(h);
  Beliefs ahead;
  for (int mode = 0; mode < modes(); ++mode) {
    ahead[mode] = mixed(mode, mixing);
    step(ahead[mode], params_.models[static_cast<std::size_t>(mode)], h);
  }
  return ahead;
}

/// The belief with which a model starts into the next interval.
NogaConsistentEstimator::Belief NogaConsistentEstimator::mixed(int mode, const ModeMatrix& mixing) const {
  Belief belief;
  for (int from = 0; from < modes(); ++from) {
    for (int channel = 0; channel < 2; ++channel)
      belief.mean[channel] += mixing(from, mode) * beliefs_[from].mean[channel];
  }
  for (int from = 0; from < modes(); ++from) {
    const double weight = mixing(from, mode);
    Eigen::Vector4d offset[2];
    for (int channel = 0; channel < 2; ++channel) {
      offset[channel] = beliefs_[from].mean[channel] - belief.mean[channel];
      belief.covariance[channel] +=
          weight * (beliefs_[from].covariance[channel] + offset[channel] * offset[channel].transpose());
    }
    if (coupled_) belief.cross += weight * (beliefs_[from].cross + offset[0] * offset[1].transpose());
  }
  return belief;
}

void NogaConsistentEstimator::step(Belief& belief, const ResponseModel& model, double h) const {
  Transition transition[2];
  for (int channel = 0; channel < 2; ++channel) {
    const double unit = amplitude(channel);
    const double q = model.q * unit * unit;
    const Eigen::Vector4d& state = belief.mean[channel];
    switch (model.kind) {
      case ResponseModel::Kind::straight:
        transition[channel] = straightStep(state, h, q, kUnusedSigma * unit, kUnusedSigma);
        break;
      case ResponseModel::Kind::harmonic:
        transition[channel] = harmonicStep(state, h, q, model.q_kappa);
        break;
      case ResponseModel::Kind::fixed_harmonic:
        transition[channel] = fixedHarmonicStep(state, h, q, model.kappa, kFixedKappaSigma);
        break;
    }
    const Eigen::Matrix4d& F = transition[channel].F;
    belief.mean[channel] = transition[channel].mean;
    belief.covariance[channel] =
        symmetric(F * belief.covariance[channel] * F.transpose() + transition[channel].Q);
  }
  if (coupled_) belief.cross = transition[0].F * belief.cross * transition[1].F.transpose();
}

/// The reduction (20)-(23) with the sighting; returns the log likelihood of the model.
double NogaConsistentEstimator::reduce(Belief& belief, const Measurement& measurement) const {
  if (coupled_) return reduceCoupled(belief, measurement);
  double log_likelihood = 0.0;
  for (int channel = 0; channel < 2; ++channel) {
    log_likelihood += reduceChannel(belief, channel, measurement.position(channel),
                                    measurement.covariance(channel, channel));
  }
  return log_likelihood;
}

/// Soft gate: the share of a sighting that is the target's, when outliers are spread evenly.
double NogaConsistentEstimator::takenShare(double log_likelihood, double log_outlier_density,
                                           double& log_mixture) const {
  if (params_.outlier_share == 0.0) {
    log_mixture = log_likelihood;
    return 1.0;
  }
  const double genuine = std::log1p(-params_.outlier_share) + log_likelihood;
  log_mixture = logSum(genuine, std::log(params_.outlier_share) + log_outlier_density);
  return std::exp(genuine - log_mixture);
}

/// `D`: variance of the innovation.
double NogaConsistentEstimator::logOutlierDensity(int channel, double D) const {
  return -std::log(std::max(params_.outlier_width * amplitude(channel), kOutlierReach * std::sqrt(D)));
}

double NogaConsistentEstimator::reduceChannel(Belief& belief, int channel, double position,
                                              double variance) const {
  Eigen::Vector4d& x = belief.mean[channel];
  Eigen::Matrix4d& P = belief.covariance[channel];
  const double D = P(0, 0) + variance, nu = position - x(0);
  double log_mixture = 0.0;
  const double beta =
      takenShare(-0.5 * (nu * nu / D + std::log(D) + kLog2Pi), logOutlierDensity(channel, D), log_mixture);

  const Eigen::Vector4d K = P.col(0) / D;
  Eigen::Matrix4d J = Eigen::Matrix4d::Identity();
  J.col(0) -= K;
  J(0, 0) = variance / D;  // free of the cancellation in 1 - K
  const Eigen::Matrix4d taken = J * P * J.transpose() + variance * K * K.transpose();  // (S-7)
  x += beta * nu * K;
  P = symmetric((1.0 - beta) * P + beta * taken + beta * (1.0 - beta) * nu * nu * K * K.transpose());
  return log_mixture;
}

double NogaConsistentEstimator::reduceCoupled(Belief& belief, const Measurement& measurement) const {
  Vector8d x;
  Matrix8d P;
  x << belief.mean[0], belief.mean[1];
  P << belief.covariance[0], belief.cross, belief.cross.transpose(), belief.covariance[1];
  Eigen::Matrix<double, 8, 2> PH;
  PH << P.col(0), P.col(4);
  const Eigen::Matrix2d D =
      (Eigen::Matrix2d() << P(0, 0), P(0, 4), P(4, 0), P(4, 4)).finished() + measurement.covariance;
  const Eigen::LLT<Eigen::Matrix2d> llt(D);
  const Eigen::Vector2d nu = measurement.position - Eigen::Vector2d(x(0), x(4));
  const double log_det = 2.0 * std::log(llt.matrixLLT()(0, 0) * llt.matrixLLT()(1, 1));
  double log_mixture = 0.0;
  const double beta = takenShare(-0.5 * (llt.matrixL().solve(nu).squaredNorm() + log_det) - kLog2Pi,
                                 logOutlierDensity(0, D(0, 0)) + logOutlierDensity(1, D(1, 1)), log_mixture);

  const Eigen::Matrix<double, 8, 2> K = llt.solve(PH.transpose()).transpose();
  Matrix8d J = Matrix8d::Identity();
  J.col(0) -= K.col(0);
  J.col(4) -= K.col(1);
  const Matrix8d taken = J * P * J.transpose() + K * measurement.covariance * K.transpose();  // (S-7)
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
  if (h == 0.0) return moments(chain_.probabilities(), beliefs_);
  return moments(chain_.predicted(h), expected(h));
}

/// Position and rates of the mixture (S-6), both channels together.
AngularState NogaConsistentEstimator::moments(const ModeArray& weights, const Beliefs& beliefs) const {
  std::array<Motion<4>, kMaxModes> motions;
  for (int mode = 0; mode < modes(); ++mode) {
    const Belief& belief = beliefs[mode];
    Motion<4>& motion = motions[mode];
    for (Eigen::Index i = 0; i < 2; ++i) {
      for (int channel = 0; channel < 2; ++channel) {
        motion.mean(2 * i + channel) = belief.mean[channel](i);
        for (Eigen::Index j = 0; j < 2; ++j) {
          motion.covariance(2 * i + channel, 2 * j + channel) = belief.covariance[channel](i, j);
        }
      }
      for (Eigen::Index j = 0; j < 2; ++j) {
        motion.covariance(2 * i, 2 * j + 1) = belief.cross(i, j);
        motion.covariance(2 * j + 1, 2 * i) = belief.cross(i, j);
      }
    }
  }
  return mixture(weights, motions.data()).angularState();
}

/// Position, rate and acceleration turn exactly in the mean and by the derivative in the covariance; kappa is
/// a property of the motion and stays.
void NogaConsistentEstimator::rotate(const Eigen::Matrix3d& R_new_old) {
  if (!time_) return;
  const auto asMotion = [](const Vector8d& x) {
    Motion<6> motion;
    motion.mean << x(0), x(4), x(1), x(5), x(2), x(6);
    return motion;
  };
  const auto turned = [&](const Vector8d& x) {
    const Eigen::Matrix<double, 6, 1> y = rotateMotion(asMotion(x), R_new_old).mean;
    return (Vector8d() << y(0), y(2), y(4), x(3), y(1), y(3), y(5), x(7)).finished();
  };
  noise_.transform(rotationJacobian({beliefs_[0].mean[0](0), beliefs_[0].mean[1](0)}, R_new_old));
  for (int mode = 0; mode < modes(); ++mode) {
    Belief& belief = beliefs_[mode];
    Vector8d x;
    Matrix8d P, J;
    x << belief.mean[0], belief.mean[1];
    P << belief.covariance[0], belief.cross, belief.cross.transpose(), belief.covariance[1];
    const Vector8d centre = turned(x);
    for (int i = 0; i < 8; ++i) {
      const double small = 1e-6;
      Vector8d difference = turned(x + small * Vector8d::Unit(i)) - turned(x - small * Vector8d::Unit(i));
      difference(0) = wrapAngle(difference(0));
      J.col(i) = difference / (2.0 * small);
    }
    P = symmetric(J * P * J.transpose());
    belief.mean[0] = centre.head<4>();
    belief.mean[1] = centre.tail<4>();
    belief.covariance[0] = P.topLeftCorner<4, 4>();
    belief.covariance[1] = P.bottomRightCorner<4, 4>();
    belief.cross = P.topRightCorner<4, 4>();
  }
  coupled_ = coupled_ || beliefs_[0].cross.cwiseAbs().maxCoeff() > 0.0;
}

}  // namespace sightline::core
