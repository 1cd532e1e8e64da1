#pragma once

#include <cmath>

#include <Eigen/Cholesky>
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

/// Makes the motion agree with a sighting at `position` [rad] of covariance `R` [rad^2], positive definite;
/// the covariance in Joseph form. Returns the log likelihood of the innovation, log N(innovation; 0, S).
template <int N>
double condition(Motion<N>& motion, const Eigen::Vector2d& position, const Eigen::Matrix2d& R) {
  using Columns = Eigen::Matrix<double, N, 2>;
  auto& P = motion.covariance;
  const Eigen::Matrix2d S = symmetric(P.template topLeftCorner<2, 2>() + R);
  const Eigen::LLT<Eigen::Matrix2d> llt(S);
  const Columns K = llt.solve(P.template topRows<2>()).transpose();
  const Eigen::Vector2d innovation = position - motion.mean.template head<2>();
  motion.mean += K * innovation;

  // (I - K H) P (I - K H)^T + K R K^T. Only the first two columns of I - K H are not those of I; its upper
  // left block is R S^-1, free of the cancellation of 1 - K.
  Columns A = -K;
  A.template topRows<2>() = llt.solve(R).transpose();
  Eigen::Matrix<double, N, N> AP = A * P.template topRows<2>();
  AP.template bottomRows<N - 2>() += P.template bottomRows<N - 2>();
  const Columns KR = K * R;
  Eigen::Matrix<double, N, N> updated = AP.template leftCols<2>() * A.transpose() + KR * K.transpose();
  updated.template rightCols<N - 2>() += AP.template rightCols<N - 2>();
  P = symmetric(updated);

  const double log_det = 2.0 * std::log(llt.matrixLLT()(0, 0) * llt.matrixLLT()(1, 1));
  constexpr double kLog2Pi = 1.8378770664093454836;
  return -0.5 * (llt.matrixL().solve(innovation).squaredNorm() + log_det) - kLog2Pi;
}

/// The same motion in a frame turned by R_new_old (constant in time). Means transform exactly; the covariance
/// by the Jacobian, which for N = 6 is taken numerically.
Motion<4> rotateMotion(const Motion<4>& motion, const Eigen::Matrix3d& R_new_old);
Motion<6> rotateMotion(const Motion<6>& motion, const Eigen::Matrix3d& R_new_old);

}  // namespace sightline::core
