#include "sightline/core/estimators/rate_prior.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include <Eigen/LU>

#include "sightline/core/estimators/estimator.h"
#include "sightline/core/estimators/revisit_time.h"
#include "sightline/core/model/sphere.h"

namespace sightline::core {
namespace {

constexpr int kComponents = 10;
constexpr double kLeastSigma = 1e-7, kMostSigma = 30.0;  // of a rate [rad/s]
constexpr double kHidden = 0.3;  // of the noise of a rate by two looks: the least component
constexpr double kGrid = 2.8, kBetweenGrid = 1.25;
constexpr double kFarthest = 1.0;  // standard deviation [rad] of an offset of which nothing is known: the
                                   // sphere is no larger

using Sigmas = std::array<double, kComponents>;

/// Standard deviations evenly on the scale of logarithms from `least` up.
Sigmas sigmasFrom(double least) {
  Sigmas sigmas{};
  const double lowest = std::clamp(least, kLeastSigma, kMostSigma);
  const double step = std::log(kMostSigma / lowest) / (kComponents - 1);
  for (int i = 0; i < kComponents; ++i) sigmas[static_cast<std::size_t>(i)] = lowest * std::exp(step * i);
  return sigmas;
}

/// The components that two looks `h` seconds apart can tell from each other: rates that the noise hides are
/// one.
Sigmas sigmasFor(const Eigen::Matrix2d& R, double h) {
  return sigmasFrom(kHidden * std::sqrt(R.trace() / 2.0) / std::max(std::abs(h), kSameTime));
}

/// Variance of the offset after `h` seconds [rad^2].
double offsetVariance(double sigma, double h) {
  const double spread = std::min(sigma * std::abs(h), kFarthest);
  return spread * spread;
}

double determinantOf(const Eigen::Matrix2d& S) {
  return S(0, 0) * S(1, 1) - S(0, 1) * S(1, 0);
}

/// ln N(x; 0, R + variance I).
double logNormal(const Eigen::Vector2d& x, Eigen::Matrix2d R, double variance) {
  R.diagonal().array() += variance;
  const double determinant = determinantOf(R);
  const double distance_squared =
      (R(1, 1) * x(0) * x(0) - (R(0, 1) + R(1, 0)) * x(0) * x(1) + R(0, 0) * x(1) * x(1)) / determinant;
  return -0.5 * distance_squared - 0.5 * std::log(determinant) - std::log(2.0 * kPi);
}

template <typename Function>
std::array<double, kComponents> forEach(const Sigmas& sigmas, Function logDensity) {
  std::array<double, kComponents> all{};
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = logDensity(sigmas[i]);
  return all;
}

/// ln of the mean of exp(x).
double logMean(const std::array<double, kComponents>& x) {
  const double largest = *std::max_element(x.begin(), x.end());
  double sum = 0.0;
  for (const double value : x) sum += std::exp(value - largest);
  return largest + std::log(sum / kComponents);
}

}  // namespace

namespace rate_prior {

double logDensityOfOffset(const Eigen::Vector2d& offset, const Eigen::Matrix2d& R, double h) {  // (S-92)
  return logMean(
      forEach(sigmasFor(R, h), [&](double sigma) { return logNormal(offset, R, offsetVariance(sigma, h)); }));
}

double reach(double log_density, const Eigen::Matrix2d& least, double trace, double h) {
  // The mean is as large only where a component is; in no direction is one wider than its trace. Components
  // lie between those of a grid, of which the farthest reaches at least 1 / kBetweenGrid as far.
  double reach = 0.0;
  double sigma = kLeastSigma;
  while (sigma < kGrid * kMostSigma) {
    Eigen::Matrix2d S = least;
    S.diagonal().array() += offsetVariance(sigma, h);
    const double log_peak = -0.5 * std::log(determinantOf(S)) - std::log(2.0 * kPi);
    reach = std::max(reach, (S.trace() + trace) * 2.0 * std::max(log_peak - log_density, 0.0));
    sigma *= kGrid;
  }
  return kBetweenGrid * std::sqrt(reach);
}

double logDensityOfRates(const Eigen::Vector2d& rates, const Eigen::Matrix2d& P) {  // (S-92)
  return logMean(
      forEach(sigmasFor(P, 1.0), [&](double sigma) { return logNormal(rates, P, sigma * sigma); }));
}

double sigma() {
  double sum = 0.0;
  for (const double sigma : sigmasFrom(kLeastSigma)) sum += sigma * sigma;
  return std::sqrt(sum / kComponents);
}

double sigma(const Eigen::Vector2d& offset, const Eigen::Matrix2d& R, double h) {  // (S-92)
  const Sigmas sigmas = sigmasFor(R, h);
  const auto log_weights =
      forEach(sigmas, [&](double sigma) { return logNormal(offset, R, offsetVariance(sigma, h)); });
  const double largest = *std::max_element(log_weights.begin(), log_weights.end());
  double sum = 0.0, mean_square = 0.0;
  for (std::size_t i = 0; i < log_weights.size(); ++i) {
    const double prior = std::sqrt(offsetVariance(sigmas[i], h)) / std::abs(h);
    const double variance = prior * prior;
    Eigen::Matrix2d S = R;
    S.diagonal().array() += variance * h * h;
    const Eigen::Matrix2d gain = variance * h * S.inverse();
    const Eigen::Vector2d mean = gain * offset;
    const double square = mean.squaredNorm() + 2.0 * variance - variance * h * gain.trace();
    const double weight = std::exp(log_weights[i] - largest);
    sum += weight;
    mean_square += weight * std::max(square, 0.0) / 2.0;
  }
  return std::max(std::sqrt(mean_square / sum), kLeastSigma);
}

}  // namespace rate_prior

AngularState InitialRate::stateAfter(double h, const Eigen::Vector2d& position,
                                     const Eigen::Matrix2d& R) const {
  const double rate_sigma = h == 0.0 ? sigma_ : std::min(sigma_, kFarthest / std::abs(h));
  Measurement seen;
  seen.position = position;
  seen.covariance = R;
  return propagate(firstState(seen, rate_sigma), h, 0.0);
}

void InitialRate::learn(const Eigen::Vector2d& offset, const Eigen::Matrix2d& R, double h) {
  if (!is_open_ || std::abs(h) < kSameTime) return;
  sigma_ = rate_prior::sigma(offset, R, h);
  is_open_ = false;
}

}  // namespace sightline::core
