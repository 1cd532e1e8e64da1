#pragma once

#include <cmath>

#include <Eigen/Core>

#include "sightline/core/model/sphere.h"

/// Constant-velocity and constant-acceleration motion of (azimuth, elevation) and its linear filter. A motion
/// of size N is (position, rate) for N = 4 or (position, rate, acceleration) for N = 6, each of two channels:
/// [rad, rad/s, rad/s^2]. The channels move alike, so that every step works on 2x2 blocks.
namespace sightline::core {

/// Mean and covariance of a motion in the coordinates of one chart.
template <int N>
struct Motion {
  static_assert(N == 4 || N == 6, "position and rate, or position, rate and acceleration, of two channels");
  Eigen::Matrix<double, N, 1> mean = Eigen::Matrix<double, N, 1>::Zero();
  Eigen::Matrix<double, N, N> covariance = Eigen::Matrix<double, N, N>::Zero();

  /// Position and rate alone.
  AngularState angularState() const {
    AngularState state;
    state.mean = mean.template head<4>();
    state.covariance = covariance.template topLeftCorner<4, 4>();
    return state;
  }
};

/// The motion `h` seconds later, or earlier, undisturbed.
template <int N>
void moveOn(Motion<N>& motion, double h) {
  // F = [1 h h^2/2; 0 1 h; 0 0 1], first on the rows and then on the columns.
  auto& x = motion.mean;
  auto& P = motion.covariance;
  x.template segment<2>(0) += h * x.template segment<2>(2);
  P.template middleRows<2>(0) += h * P.template middleRows<2>(2);
  if constexpr (N == 6) {
    x.template segment<2>(0) += 0.5 * h * h * x.template segment<2>(4);
    x.template segment<2>(2) += h * x.template segment<2>(4);
    P.template middleRows<2>(0) += 0.5 * h * h * P.template middleRows<2>(4);
    P.template middleRows<2>(2) += h * P.template middleRows<2>(4);
  }
  P.template middleCols<2>(0) += h * P.template middleCols<2>(2);
  if constexpr (N == 6) {
    P.template middleCols<2>(0) += 0.5 * h * h * P.template middleCols<2>(4);
    P.template middleCols<2>(2) += h * P.template middleCols<2>(4);
  }
}

/// Adds what white acceleration of spectral density `density` (2x2, [rad^2/s^3]) does to position and rate in
/// `h` seconds; looking back in time it makes them as uncertain.
template <int N>
void addWhiteAcceleration(Motion<N>& motion, const Eigen::Matrix2d& density, double h) {
  const double age = std::abs(h);
  auto& P = motion.covariance;
  P.template block<2, 2>(0, 0) += age * age * age / 3.0 * density;
  P.template block<2, 2>(0, 2) += h * age / 2.0 * density;
  P.template block<2, 2>(2, 0) += h * age / 2.0 * density;
  P.template block<2, 2>(2, 2) += age * density;
}

/// The same for white jerk of spectral density `density` (2x2, [rad^2/s^5]).
inline void addWhiteJerk(Motion<6>& motion, const Eigen::Matrix2d& density, double h) {
  const double age = std::abs(h), age3 = age * age * age;
  auto& P = motion.covariance;
  const auto add = [&](Eigen::Index row, Eigen::Index column, double factor) {
    P.block<2, 2>(2 * row, 2 * column) += factor * density;
    if (row != column) P.block<2, 2>(2 * column, 2 * row) += factor * density;
  };
  add(0, 0, age3 * age * age / 20.0);
  add(0, 1, age3 * h / 8.0);
  add(0, 2, age3 / 6.0);
  add(1, 1, age3 / 3.0);
  add(1, 2, h * age / 2.0);
  add(2, 2, age);
}

/// How likely a sighting was: its innovation against the covariance S of that.
struct InnovationLikelihood {
  double distance_squared = 0.0;  ///< normalised [1]
  double determinant = 0.0;       ///< of S [rad^4]

  /// log N(innovation; 0, S).
  double logLikelihood() const {
    constexpr double kLog2Pi = 1.8378770664093454836;
    return -0.5 * (distance_squared + std::log(determinant)) - kLog2Pi;
  }
};

/// Makes the motion agree with a sighting at `position` [rad] of covariance `R` [rad^2], positive definite:
/// the gain K = P H^T S^-1, S = P_pp + R, by S = L D L^T in closed form. With C = R S^-1, free of the
/// cancellation of I - K H, the covariance becomes C P_pp of the position, C P_pr between it and the rest,
/// and in Joseph form P_rr - K_r P_pr - (K_r P_pr)^T + K_r S K_r^T of the rest.
template <int N>
InnovationLikelihood condition(Motion<N>& motion, const Eigen::Vector2d& position, const Eigen::Matrix2d& R) {
  constexpr int kRest = N - 2;
  using Rest = Eigen::Matrix<double, kRest, 2>;
  auto& P = motion.covariance;
  const double s00 = P(0, 0) + R(0, 0), s01 = 0.5 * (P(0, 1) + P(1, 0) + R(0, 1) + R(1, 0)),
               s11 = P(1, 1) + R(1, 1);
  const double l = s01 / s00, d = s11 - l * s01;
  const double per_s00 = 1.0 / s00, per_d = 1.0 / d;
  const auto perS = [&](const auto& rows) {  // rows S^-1
    auto solved = rows.eval();
    solved.col(1) = (rows.col(1) - l * rows.col(0)) * per_d;
    solved.col(0) = rows.col(0) * per_s00 - l * solved.col(1);
    return solved;
  };
  const Eigen::Matrix2d Ppp = P.template topLeftCorner<2, 2>();
  const Rest Prp = P.template bottomLeftCorner<kRest, 2>();
  const Eigen::Matrix2d Kp = perS(Ppp), C = perS(R);
  const Rest Kr = perS(Prp);
  const Eigen::Vector2d innovation = position - motion.mean.template head<2>();
  motion.mean.template head<2>() += Kp * innovation;
  motion.mean.template tail<kRest>() += Kr * innovation;

  Eigen::Matrix2d S;
  S << s00, s01, s01, s11;
  const Eigen::Matrix<double, kRest, kRest> KP = Kr * Prp.transpose();
  const Rest KS = Kr * S;
  P.template topLeftCorner<2, 2>() = symmetric(C * Ppp);
  const Rest rest = Prp * C.transpose();
  P.template bottomLeftCorner<kRest, 2>() = rest;
  P.template topRightCorner<2, kRest>() = rest.transpose();
  P.template bottomRightCorner<kRest, kRest>() =
      symmetric(P.template bottomRightCorner<kRest, kRest>() - KP - KP.transpose() + KS * Kr.transpose());

  const double second = innovation(1) - l * innovation(0);
  return {innovation(0) * innovation(0) * per_s00 + second * second * per_d, s00 * d};
}

/// Positions, rates and accelerations of two channels in a frame turned by R_new_old (constant in time).
Eigen::Matrix<double, 6, 1> rotateMean(const Eigen::Matrix<double, 6, 1>& mean,
                                       const Eigen::Matrix3d& R_new_old);

/// The same motion in a frame turned by R_new_old (constant in time). Means transform exactly; the covariance
/// by the Jacobian, which for N = 6 is taken numerically.
Motion<4> rotateMotion(const Motion<4>& motion, const Eigen::Matrix3d& R_new_old);
Motion<6> rotateMotion(const Motion<6>& motion, const Eigen::Matrix3d& R_new_old);

}  // namespace sightline::core
