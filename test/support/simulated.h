#pragma once

#include <cmath>
#include <random>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "sightline/core/estimators/estimator.h"

/// Sightings of a target that flies by a formula, for the tests of the estimators.
namespace sightline::test {

/// (azimuth, elevation, rates) at t [s].
using Path = Eigen::Vector4d (*)(double t);

inline Eigen::Vector4d sinusoid(double t) {
  return {std::sin(t), std::cos(t), std::cos(t), -std::sin(t)};
}
inline Eigen::Vector4d straight(double t) {
  return {-1.0 + 0.3 * t, 0.5 - 0.1 * t, 0.3, -0.1};
}

/// Sightings over `duration` [s] at the paper's intervals of 10 to 50 ms, with noise of covariance `R`;
/// angles, rates and noise times `scale`.
inline std::vector<core::Measurement> sightingsOf(Path path, const Eigen::Matrix2d& R, unsigned seed,
                                                  double duration = 10.0, double scale = 1.0) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_int_distribution<int> ticks(1, 5);
  const Eigen::Matrix2d root = R.llt().matrixL();
  std::vector<core::Measurement> sightings;
  for (int tick = 0; 0.01 * tick <= duration; tick += ticks(random)) {
    core::Measurement sighting;
    sighting.time = core::Time(std::chrono::milliseconds(10 * tick));
    const double n1 = normal(random), n2 = normal(random);
    sighting.position = scale * (path(0.01 * tick).head<2>() + root * Eigen::Vector2d(n1, n2));
    sighting.covariance = scale * scale * R;
    sightings.push_back(sighting);
  }
  return sightings;
}

inline std::vector<core::Measurement> sightingsOf(Path path, double sigma, unsigned seed,
                                                  double duration = 10.0, double scale = 1.0) {
  return sightingsOf(path, Eigen::Matrix2d(sigma * sigma * Eigen::Matrix2d::Identity()), seed, duration,
                     scale);
}

inline double timeOf(const core::Measurement& sighting) {
  return core::seconds(sighting.time.time_since_epoch());
}

/// Mean squares over the runs of one estimator, both channels, t > 1 s.
struct BenchmarkFigures {
  double estimate = 0.0, prediction = 0.0;  ///< root mean square errors of the position, in sigmas
  double anees = 0.0;                       ///< squared error of the estimate over its variance
  double innovation = 0.0;                  ///< squared innovation over its variance
};

template <typename Make>
BenchmarkFigures benchmark(Path path, double sigma, int runs, const Make& make) {
  BenchmarkFigures sum;
  int count = 0;
  for (int run = 1; run <= runs; ++run) {
    const auto estimator = make();
    for (const core::Measurement& sighting : sightingsOf(path, sigma, static_cast<unsigned>(run))) {
      const auto before = estimator->stateAt(sighting.time);
      estimator->update(sighting);
      const auto after = estimator->stateAt(sighting.time);
      if (timeOf(sighting) <= 1.0) continue;
      for (int channel = 0; channel < 2; ++channel) {
        const double truth = path(timeOf(sighting))(channel);
        sum.estimate += std::pow(after->mean(channel) - truth, 2);
        sum.prediction += std::pow(before->mean(channel) - truth, 2);
        sum.anees += std::pow(after->mean(channel) - truth, 2) / after->covariance(channel, channel);
        sum.innovation += std::pow(sighting.position(channel) - before->mean(channel), 2) /
                          (before->covariance(channel, channel) + sigma * sigma);
        ++count;
      }
    }
  }
  return {std::sqrt(sum.estimate / count) / sigma, std::sqrt(sum.prediction / count) / sigma,
          sum.anees / count, sum.innovation / count};
}

}  // namespace sightline::test
