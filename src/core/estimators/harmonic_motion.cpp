#include "sightline/core/estimators/harmonic_motion.h"

#include <algorithm>
#include <cmath>

namespace sightline::core {
namespace {

constexpr double kSeriesBelow = 0.5;
constexpr double kLeastKappa = -1.0, kLargestKappa = 40.0;  // [1/s^2]
constexpr double kLargestGrowth = 5.0;                      // e-foldings of one step

/// sum over k of (-z)^k / (2k + n)!, for n = 3 or 4; nine terms suffice below kSeriesBelow.
double stumpffSeries(double z, int n) {
  constexpr int kTerms = 9;
  double sum = 1.0;
  for (int k = kTerms; k-- > 1;) sum = 1.0 - z / ((2 * k + n - 1) * (2 * k + n)) * sum;
  return sum / (n == 3 ? 6.0 : 24.0);
}

Stumpff bySeries(double z) {
  // c_n = 1 / n! - z c_{n+2}
  const double c4 = stumpffSeries(z, 4), c3 = stumpffSeries(z, 3);
  const double c2 = 0.5 - z * c4, c1 = 1.0 - z * c3, c0 = 1.0 - z * c2;
  // c_n' = (n c_{n+2} - c_{n+1}) / 2, free of the division by z
  return {c0, c1, c2, -0.5 * c1, 0.5 * (c3 - c2), 0.5 * (2.0 * c4 - c3)};
}

/// The part of (S-8) that does not concern kappa.
Transition harmonicCore(const Eigen::Vector4d& state, double h, double q, double kappa, const Stumpff& s) {
  Transition step;
  step.F.setZero();
  step.F.topLeftCorner<3, 3>() << 1.0, h * s.c1, h * h * s.c2,  //
      0.0, s.c0, h * s.c1,                                      //
      0.0, -kappa * h * s.c1, s.c0;
  step.mean.head<3>() = step.F.topLeftCorner<3, 3>() * state.head<3>();
  // Looking back in time makes the state as uncertain; only its correlations with the rate change sign.
  const double age = std::abs(h), age2 = h * h, age3 = age2 * age;
  step.Q.setZero();
  step.Q.topLeftCorner<3, 3>() << age3 * age2 / 20.0, h * age3 / 8.0, age3 / 6.0,  //
      h * age3 / 8.0, age3 / 3.0, h * age / 2.0,                                   //
      age3 / 6.0, h * age / 2.0, age;
  step.Q *= q;
  return step;
}

/// Response of (position, rate, acceleration) to a unit jerk `s` seconds ago, z = s / tau: s^(2-i) times
/// sum_k (-z)^k / (k + 2 - i)!.
constexpr int kTerms = 12;
constexpr double kFadingSeriesBelow = 0.5;  // z

double factorial(int n) {
  double product = 1.0;
  for (int i = 2; i <= n; ++i) product *= i;
  return product;
}

/// Coefficients of the integral of the responses' products: Q_ij = h^(5-i-j) sum_n c_ij,n (-h/tau)^n.
struct FadingSeries {
  double c[3][3][kTerms] = {};
  FadingSeries() {
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        for (int n = 0; n < kTerms; ++n) {
          for (int k = 0; k <= n; ++k) c[i][j][n] += 1.0 / (factorial(k + 2 - i) * factorial(n - k + 2 - j));
          c[i][j][n] /= n + 5 - i - j;
        }
      }
    }
  }
};

/// Covariance of (position, rate, acceleration) after `h` >= 0 seconds of white jerk of density one.
Eigen::Matrix3d fadingNoise(double h, double tau) {  // (S-29)
  const double z = h / tau;
  Eigen::Matrix3d Q;
  if (z < kFadingSeriesBelow) {  // the closed form cancels
    static const FadingSeries series;
    const double power[] = {h, h * h, h * h * h, h * h * h * h, h * h * h * h * h};
    for (int i = 0; i < 3; ++i) {
      for (int j = i; j < 3; ++j) {
        double sum = 0.0;
        for (int n = kTerms; n-- > 0;) sum = series.c[i][j][n] - z * sum;
        Q(i, j) = Q(j, i) = power[4 - i - j] * sum;
      }
    }
    return Q;
  }
  const double e = std::exp(-z), e2 = e * e, tau2 = tau * tau, tau3 = tau2 * tau;
  Q(0, 0) = tau3 * tau2 / 2.0 * (1.0 - e2 + 2.0 * z + 2.0 / 3.0 * z * z * z - 2.0 * z * z - 4.0 * z * e);
  Q(0, 1) = Q(1, 0) = tau2 * tau2 / 2.0 * (e2 + 1.0 - 2.0 * e + 2.0 * z * e - 2.0 * z + z * z);
  Q(0, 2) = Q(2, 0) = tau3 / 2.0 * (1.0 - e2 - 2.0 * z * e);
  Q(1, 1) = tau3 / 2.0 * (4.0 * e - 3.0 - e2 + 2.0 * z);
  Q(1, 2) = Q(2, 1) = tau2 / 2.0 * (1.0 - e) * (1.0 - e);
  Q(2, 2) = tau / 2.0 * (1.0 - e2);
  return Q;
}

}  // namespace

Stumpff stumpff(double z) {  // (S-8)
  if (std::abs(z) < kSeriesBelow) return bySeries(z);
  Stumpff s{};
  if (z > 0.0) {
    const double root = std::sqrt(z);
    s.c0 = std::cos(root);
    s.c1 = std::sin(root) / root;
  } else {
    const double root = std::sqrt(-z);
    s.c0 = std::cosh(root);
    s.c1 = std::sinh(root) / root;
  }
  s.c2 = (1.0 - s.c0) / z;
  s.d0 = -0.5 * s.c1;
  s.d1 = (s.c0 - s.c1) / (2.0 * z);
  s.d2 = (s.c1 - 2.0 * s.c2) / (2.0 * z);
  return s;
}

Transition harmonicStep(const Eigen::Vector4d& state, double h, double q, double q_kappa) {  // (S-8)
  // Over a long silence a motion that runs away would leave every number behind.
  const double least = std::max(kLeastKappa, -kLargestGrowth * kLargestGrowth / (h * h + 1e-9));
  const double kappa = std::clamp(state(3), least, kLargestKappa);
  const double v = state(1), a = state(2), h2 = h * h, h3 = h2 * h;
  const Stumpff s = stumpff(kappa * h2);
  Transition step = harmonicCore(state, h, q, kappa, s);
  step.mean(3) = kappa;
  step.F.col(3) << h3 * s.d1 * v + h2 * h2 * s.d2 * a,        //
      h2 * s.d0 * v + h3 * s.d1 * a,                          //
      -h * s.c1 * v - kappa * h3 * s.d1 * v + h2 * s.d0 * a,  //
      1.0;
  step.Q(3, 3) = q_kappa * std::abs(h);
  return step;
}

Transition fixedHarmonicStep(const Eigen::Vector4d& state, double h, double q, double kappa,
                             double kappa_sigma) {  // (S-8)
  Transition step = harmonicCore(state, h, q, kappa, stumpff(kappa * h * h));
  step.mean(3) = kappa;
  step.Q(3, 3) = kappa_sigma * kappa_sigma;
  return step;
}

// (S-29)
Transition fadingStep(const Eigen::Vector4d& state, double h, double q, double tau, double kappa_sigma) {
  const double age = std::abs(h), faded = -std::expm1(-age / tau);
  const double sign = h < 0.0 ? -1.0 : 1.0;
  Transition step;
  step.F.setZero();
  step.F.topLeftCorner<3, 3>() << 1.0, h, tau * (age - tau * faded),  //
      0.0, 1.0, sign * tau * faded,                                   //
      0.0, 0.0, 1.0 - faded;
  step.mean = step.F * state;
  step.Q.setZero();
  step.Q.topLeftCorner<3, 3>() = q * fadingNoise(age, tau);
  step.Q(0, 1) *= sign;
  step.Q(1, 0) *= sign;
  step.Q(1, 2) *= sign;
  step.Q(2, 1) *= sign;
  step.Q(3, 3) = kappa_sigma * kappa_sigma;
  return step;
}

Eigen::Vector2d autoRegression(double kappa, double h_1, double h_2) {  // (13C)
  const auto s = [kappa](double h) { return h * stumpff(kappa * h * h).c1; };
  return {s(h_1 + h_2) / s(h_2), -s(h_1) / s(h_2)};  // (13C)
}

}  // namespace sightline::core
