#include "sightline/core/estimators/estimator.h"

#include <cmath>

#include <Eigen/LU>

namespace sightline::core {

std::vector<Hypothesis> Estimator::hypothesesAt(Time time) const {
  const std::optional<AngularState> state = stateAt(time);
  return state ? std::vector<Hypothesis>{{1.0, *state}} : std::vector<Hypothesis>{};
}
namespace {

constexpr std::size_t kSettledSightings = 20;
constexpr double kSettledSpan = 0.5;  // [s]

}  // namespace

double nextTo(double other, double angle) {
  return angle + 2.0 * kPi * std::round((other - angle) / (2.0 * kPi));
}

Measurement rotate(const Measurement& measurement, const Eigen::Matrix3d& R_new_old) {  // (S-13)
  const Eigen::Matrix2d J = rotationJacobian(measurement.position, R_new_old);
  Measurement turned = measurement;
  turned.position = rotateAngles(measurement.position, R_new_old);
  turned.covariance = symmetric(J * measurement.covariance * J.transpose());
  return turned;
}

void rotate(std::vector<Measurement>& window, const Eigen::Matrix3d& R_new_old) {  // (S-13)
  for (std::size_t i = window.size(); i-- > 0;) {
    window[i] = rotate(window[i], R_new_old);
    if (i + 1 == window.size()) continue;
    window[i].position.x() = nextTo(window[i + 1].position.x(), window[i].position.x());
  }
}

AngularState firstState(const Measurement& measurement, double rate_sigma) {  // (S-22)
  AngularState state;
  state.mean << measurement.position, Eigen::Vector2d::Zero();
  state.covariance.topLeftCorner<2, 2>() = measurement.covariance;
  state.covariance.bottomRightCorner<2, 2>().diagonal().setConstant(rate_sigma * rate_sigma);
  return state;
}

// (S-22)
AngularState withRatePrior(AngularState state, double rate_sigma, std::size_t sightings, double span) {
  if (sightings >= kSettledSightings || span >= kSettledSpan) return state;
  const double prior = rate_sigma * rate_sigma;
  if (!(state.covariance.diagonal().tail<2>().maxCoeff() > prior)) return state;
  const Eigen::Matrix2d S = state.covariance.bottomRightCorner<2, 2>() + prior * Eigen::Matrix2d::Identity();
  const Eigen::Matrix<double, 4, 2> K = state.covariance.rightCols<2>() * S.inverse();  // S >= prior * I
  state.mean -= K * Eigen::Vector2d(state.rates());
  Eigen::Matrix4d J = Eigen::Matrix4d::Identity();
  J.rightCols<2>() -= K;
  state.covariance = symmetric(J * state.covariance * J.transpose() + prior * K * K.transpose());
  return state;
}

}  // namespace sightline::core
