#include "sightline/core/evaluation/metrics.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "sightline/core/model/chart.h"
#include "sightline/core/model/sphere.h"

namespace sightline::core {
namespace {

constexpr double kNormal975 = 1.959963984540054;  // 97.5 % point of the normal distribution

/// error^T covariance^-1 error over the dimension; nullopt when the covariance is not positive definite.
template <int N>
std::optional<double> normalisedSquare(const Eigen::Matrix<double, N, 1>& error,
                                       const Eigen::Matrix<double, N, N>& covariance) {
  const Eigen::LLT<Eigen::Matrix<double, N, N>> cholesky(covariance);
  if (cholesky.info() != Eigen::Success || !covariance.allFinite()) return std::nullopt;
  const Eigen::Matrix<double, N, 1> whitened = cholesky.matrixL().solve(error);
  return whitened.squaredNorm() / N;
}

/// Factors that turn chart coordinates at the truth into arcs.
Eigen::Vector2d arcsPerCoordinate(const Eigen::Vector2d& truth_chart) {
  return {std::cos(truth_chart.y()), 1.0};
}

/// Position part common to estimates and sightings.
DirectionError positionError(const Eigen::Vector2d& difference_chart, const Eigen::Matrix2d& covariance_chart,
                             const Eigen::Vector2d& arcs, Channels channels) {
  DirectionError error;
  error.position = arcs.cwiseProduct(difference_chart);
  error.sigma = arcs.cwiseProduct(covariance_chart.diagonal().cwiseMax(0.0).cwiseSqrt());
  if (channels == Channels::azimuth_only) {
    error.position.y() = error.sigma.y() = 0.0;
    error.position_nees =
        normalisedSquare<1>(difference_chart.head<1>(), covariance_chart.topLeftCorner<1, 1>());
  } else {
    error.position_nees = normalisedSquare<2>(difference_chart, covariance_chart);
  }
  return error;
}

}  // namespace

DirectionError errorOf(const AngularState& estimate, const AngularState& truth, Channels channels) {
  const Chart chart = Chart::around(directionOf(truth.angles()));
  const AngularState estimate_chart = chart.fromTracking(estimate), truth_chart = chart.fromTracking(truth);
  const Eigen::Vector2d arcs = arcsPerCoordinate(truth_chart.angles());
  Eigen::Vector4d difference = estimate_chart.mean - truth_chart.mean;  // the truth is far from the wrap
  const Eigen::Matrix4d& covariance = estimate_chart.covariance;

  DirectionError error =
      positionError(difference.head<2>(), covariance.topLeftCorner<2, 2>(), arcs, channels);
  error.rate = arcs.cwiseProduct(difference.tail<2>());
  if (channels == Channels::azimuth_only) {
    error.rate->y() = 0.0;
    Eigen::Matrix2d azimuth_covariance;
    azimuth_covariance << covariance(0, 0), covariance(0, 2), covariance(2, 0), covariance(2, 2);
    error.state_nees = normalisedSquare<2>({difference(0), difference(2)}, azimuth_covariance);
  } else {
    error.state_nees = normalisedSquare<4>(difference, covariance);
  }
  return error;
}

DirectionError errorOf(const Sighting& sighting, const AngularState& truth, Channels channels) {
  const Eigen::Vector3d truth_direction = directionOf(truth.angles());
  const Chart chart = Chart::around(truth_direction);
  const Eigen::Vector2d truth_chart = chart.coordinatesOf(truth_direction);
  return positionError(chart.coordinatesOf(sighting.direction) - truth_chart, chart.covarianceOf(sighting),
                       arcsPerCoordinate(truth_chart), channels);
}

void ErrorStatistics::add(const DirectionError& error) {
  position_.add(error.position.squaredNorm() / dimensions());
  if (error.rate) rate_.add(error.rate->squaredNorm() / dimensions());
  if (error.position_nees) position_nees_.add(*error.position_nees);
  if (error.state_nees) state_nees_.add(*error.state_nees);
}

double ErrorStatistics::rmse() const {
  return std::sqrt(position_.mean());
}

double ErrorStatistics::rateRmse() const {
  return std::sqrt(rate_.mean());
}

Band aneesBand(double degrees) {
  const double variance = 2.0 / (9.0 * degrees);
  const double half_width = kNormal975 * std::sqrt(variance);
  const double low = std::max(1.0 - variance - half_width, 0.0);
  return {std::pow(low, 3), std::pow(1.0 - variance + half_width, 3)};
}

std::optional<double> beatsTheory(double s) {
  if (!(s >= 0.0) || !(s <= 1.0)) return std::nullopt;
  return 0.5 + std::asin(std::sqrt((1.0 - s) / (1.0 + 3.0 * s))) / kPi;  // (S-10)
}

}  // namespace sightline::core
