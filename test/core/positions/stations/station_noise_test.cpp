#include "sightline/core/positions/stations/station_noise.h"

#include <cmath>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "sightline/core/simulation/random_stream.h"

#include "../simulated_stations.h"

namespace sightline::core {
namespace {

using Vector = Eigen::Vector3d;

constexpr double kStep = 0.04;           // [s]
constexpr double kStated = 1e-3 * 1e-3;  // [rad^2]

TEST(StationNoise, WhiteNoiseIsToldFromAManoeuvreAndASlowError) {
  for (const double sigma : {5e-5, 3e-4}) {
    test::SimulatedStation station(0, Vector::Zero(), sigma, {kStated, 3.0}, 4);
    StationNoise noise;
    EXPECT_DOUBLE_EQ(noise.whiteScale(), 1.0);
    for (int i = 1; i < 1000; ++i) {
      const double t = i * kStep;
      const auto seen = station.see(t, {50, 20 * std::sin(0.5 * t), 10 + 5 * std::cos(0.3 * t)});
      noise.noteDirection(seen.time, seen.ray.direction, kStated);
    }
    // The slow error of 1 mrad and 3 s moves by 0.16 mrad from sighting to sighting: the third difference has
    // a part of that, too.
    const double moved = 2.0 * kStated * kStep / 3.0;
    EXPECT_GT(noise.whiteScale(), 0.7 * sigma * sigma / kStated);
    EXPECT_LT(noise.whiteScale(), 1.3 * (sigma * sigma + 0.5 * moved) / kStated);
  }
}

TEST(StationNoise, NeverMoreThanStatedAndNeverAcrossGaps) {
  RandomStream random(3);
  StationNoise noise;
  for (int i = 0; i < 300; ++i) {  // a second between sightings: the target's motion, not noise
    const Vector direction = Vector(1, 0.1 * std::sin(i), 0.1 * std::cos(2.0 * i)).normalized();
    noise.noteDirection(Time(durationOf(i)), direction, kStated);
  }
  EXPECT_DOUBLE_EQ(noise.whiteScale(), 1.0);
  for (int i = 0; i < 300; ++i) {
    const Eigen::Vector2d error = 0.01 * random.normalPair();
    noise.noteDirection(Time(durationOf(400 + i * kStep)), Vector(1, error.x(), error.y()).normalized(),
                        kStated);
  }
  EXPECT_DOUBLE_EQ(noise.whiteScale(), 1.0);
}

/// Four stations follow one target, each with its own size of slow error; what is learnt of the first.
double learntScale(double true_scale, const StationNoiseParams& params, std::uint64_t seed) {
  const std::vector<Vector> origins{{0, 0, 0}, {100, 0, 2}, {40, 90, 5}, {-50, 60, 0}};
  test::WanderingTarget target({{30, 40, 20}, {1, -1, 0.2}}, 0.1, seed);
  std::vector<test::SimulatedStation> stations;
  std::vector<StationNoise> noise(origins.size(), StationNoise(params));
  for (std::size_t s = 0; s < origins.size(); ++s)
    stations.emplace_back(static_cast<int>(s), origins[s], 1e-4,
                          SlowError{(s ? 1.0 : true_scale * true_scale) * kStated, 3.0}, seed * 10 + s);
  PositionEstimator estimator;
  for (int i = 1; i < 3000; ++i) {
    const auto& now = target.advance(kStep);
    for (std::size_t s = 0; s < origins.size(); ++s) {
      StationMeasurement m = stations[s].see(i * kStep, now.position);
      m.slow = noise[s].slowError(kStated);
      estimator.update(m);
      if (const auto slow = estimator.slowErrorOf(static_cast<int>(s)))
        noise[s].noteSlowError(*slow, kStated, slow->since);
    }
  }
  return noise[0].slowScale();
}

TEST(StationNoise, LearnsTheSizeOfAStationsSlowErrorFromBelow) {
  StationNoiseParams params;
  params.safety = 1.0;
  params.memory = 20.0;
  params.prior_weight = 2.0;
  double mean = 0.0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) mean += learntScale(2.5, params, seed) / 4.0;
  EXPECT_GT(mean, 0.7 * 2.5);
  EXPECT_LT(mean, 1.4 * 2.5);
}

// What the other stations get wrong ends up in part in the estimates of the best one, so that it is found
// better than the others, but not as good as it is.
TEST(StationNoise, FindsThatAStationIsBetterThanTheOthersAndNeverTooGood) {
  StationNoiseParams params;
  params.safety = 1.0;
  params.memory = 20.0;
  params.prior_weight = 2.0;
  double mean = 0.0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) mean += learntScale(0.4, params, seed) / 4.0;
  EXPECT_GT(mean, 0.4);
  EXPECT_LT(mean, 0.85);
}

TEST(StationNoise, EstimatesThatTellNothingLeaveTheSizeAlone) {
  StationNoise noise;
  SlowErrorEstimate estimate;
  const SlowError first = noise.slowError(kStated);
  estimate.covariance = first.variance * Eigen::Matrix2d::Identity();  // no better than before
  estimate.basis << 1, 0, 0, 0, 1, 0;
  for (int i = 0; i < 1000; ++i) {
    estimate.time = Time(durationOf(i * kStep));
    noise.noteSlowError(estimate, kStated, kStep);
  }
  EXPECT_NEAR(noise.slowScale(), StationNoiseParams{}.slow_scale, 1e-9);
}

TEST(StationNoise, TheTimeConstantIsLearntWhenAskedFor) {
  StationNoiseParams params;
  params.learn_time = true;
  for (const double truth : {1.0, 8.0}) {
    StationNoise noise(params);
    RandomStream random(6);
    SlowErrorEstimate estimate;
    estimate.basis << 1, 0, 0, 0, 1, 0;
    estimate.covariance = 1e-9 * Eigen::Matrix2d::Identity();
    Eigen::Vector2d error = Eigen::Vector2d::Zero();
    const double h = kStep, phi = std::exp(-h / truth);
    for (int i = 0; i < 5000; ++i) {
      error = phi * error + 1e-3 * std::sqrt(1.0 - phi * phi) * random.normalPair();
      estimate.error = error;
      estimate.time = Time(durationOf(i * h));
      noise.noteSlowError(estimate, kStated, kStep);
    }
    EXPECT_GT(noise.timeConstant(), 0.5 * truth);
    EXPECT_LT(noise.timeConstant(), 2.0 * truth);
  }
}

TEST(StationNoise, ParametersOutOfRangeAreRefused) {
  StationNoiseParams params;
  params.memory = 0.0;
  EXPECT_THROW(StationNoise{params}, std::invalid_argument);
  params = {};
  params.least_scale = 40.0;
  EXPECT_THROW(StationNoise{params}, std::invalid_argument);
}

}  // namespace
}  // namespace sightline::core
