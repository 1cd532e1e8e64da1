#include "sightline/core/estimators/noga_models.h"

#include <cmath>
#include <stdexcept>
#include <string>

#include "sightline/core/estimators/harmonic_motion.h"
#include "sightline/core/model/kinematics.h"

namespace sightline::core {
namespace {

// In units of the model; kappa in 1/s^2.
constexpr double kUnusedSigma = 1.0;      // of acceleration and kappa after a model that does not know them
constexpr double kFixedKappaSigma = 4.0;  // of the kappa that a fixed harmonic hands to the others

/// Constant velocity with white acceleration; of acceleration and kappa, of which it knows nothing, it says
/// N(0, sigma^2) each.
Transition straightStep(double h, double q) {
  Transition step;
  step.mean.setZero();
  step.F.setZero();
  step.F.topLeftCorner<2, 2>() << 1.0, h, 0.0, 1.0;
  step.Q.setZero();
  step.Q.topLeftCorner<2, 2>() = whiteAccelerationNoise(h, q);
  step.Q(2, 2) = step.Q(3, 3) = kUnusedSigma * kUnusedSigma;
  return step;
}

}  // namespace

Eigen::Matrix2d whiteAccelerationNoise(double h, double q) {  // (S-17)
  const double age = std::abs(h);
  Eigen::Matrix2d noise;
  noise << q * age * age * age / 3.0, q * h * age / 2.0, q * h * age / 2.0, q * age;
  return noise;
}

std::vector<ResponseModel> defaultResponseModels() {
  return {{ResponseModel::Kind::straight, 1e-8, 0.0, 0.0, 1.0, 0.4},
          {ResponseModel::Kind::straight, 1e-5, 0.0, 0.0, 1.0, 0.3},
          {ResponseModel::Kind::straight, 1e-3, 0.0, 0.0, 1.0, 0.5},
          {ResponseModel::Kind::straight, 0.05, 0.0, 0.0, 1.0, 1.5},
          {ResponseModel::Kind::straight, 0.25, 0.0, 0.0, 1.0, 1.5},
          {ResponseModel::Kind::straight, 1.25},
          {ResponseModel::Kind::straight, 30.0, 0.0, 0.0, 1.0, 0.2},
          {ResponseModel::Kind::harmonic, 1e-3, 1e-2, 0.0, 1.0, 4.0},
          {ResponseModel::Kind::harmonic, 0.3, 1.0, 0.0, 1.0, 0.3},
          {ResponseModel::Kind::fixed_harmonic, 1.0, 0.0, 8.0, 1.0, 0.05},
          {ResponseModel::Kind::fading, 10.0, 0.0, 0.0, 2.0},
          {ResponseModel::Kind::fading, 1000.0, 0.0, 0.0, 2.0, 0.5}};
}

int agilestStraight(const std::vector<ResponseModel>& models) {
  int agilest = -1;
  double most = 0.0;
  for (std::size_t i = 0; i < models.size(); ++i) {
    if (models[i].kind != ResponseModel::Kind::straight || models[i].q < most) continue;
    most = models[i].q;
    agilest = static_cast<int>(i);
  }
  return agilest;
}

Motion<4> motionOf(const ResponseBelief& belief) {
  Motion<4> motion;
  for (Eigen::Index i = 0; i < 2; ++i) {
    for (int channel = 0; channel < 2; ++channel) {
      motion.mean(2 * i + channel) = belief.mean[channel](i);
      for (Eigen::Index j = 0; j < 2; ++j)
        motion.covariance(2 * i + channel, 2 * j + channel) = belief.covariance[channel](i, j);
    }
    for (Eigen::Index j = 0; j < 2; ++j) {
      motion.covariance(2 * i, 2 * j + 1) = belief.cross(i, j);
      motion.covariance(2 * j + 1, 2 * i) = belief.cross(i, j);
    }
  }
  return motion;
}

void turn(ResponseBelief& belief, const Eigen::Matrix3d& R_new_old) {
  using Vector8d = Eigen::Matrix<double, 8, 1>;
  using Matrix8d = Eigen::Matrix<double, 8, 8>;
  const auto turned = [&](const Vector8d& x) {
    Eigen::Matrix<double, 6, 1> mean;
    mean << x(0), x(4), x(1), x(5), x(2), x(6);
    const Eigen::Matrix<double, 6, 1> y = rotateMean(mean, R_new_old);
    return (Vector8d() << y(0), y(2), y(4), x(3), y(1), y(3), y(5), x(7)).finished();
  };
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

void check(const ResponseModel& model) {
  if (!(model.q >= 0.0) || !(model.q_kappa >= 0.0) || !std::isfinite(model.kappa) || !(model.fade > 0.0) ||
      !(model.attraction > 0.0)) {
    throw std::invalid_argument(
        "NogaConsistentParams: a model needs q >= 0, q_kappa >= 0, a finite kappa, fade > 0 s and "
        "attraction > 0, "
        "got q " +
        std::to_string(model.q) + ", q_kappa " + std::to_string(model.q_kappa) + ", kappa " +
        std::to_string(model.kappa) + ", fade " + std::to_string(model.fade) + ", attraction " +
        std::to_string(model.attraction));
  }
}

Transition transitionOf(const ResponseModel& model, const Eigen::Vector4d& state, double h) {
  switch (model.kind) {
    case ResponseModel::Kind::straight:
      return straightStep(h, model.q);
    case ResponseModel::Kind::harmonic:
      return harmonicStep(state, h, model.q, model.q_kappa);
    case ResponseModel::Kind::fixed_harmonic:
      return fixedHarmonicStep(state, h, model.q, model.kappa, kFixedKappaSigma);
    case ResponseModel::Kind::fading:
      return fadingStep(state, h, model.q, model.fade, kUnusedSigma);
  }
  return {};
}

}  // namespace sightline::core
