#include "sightline/core/sensors/scatter.h"

#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace {

using sightline::core::durationOf;
using sightline::core::Scatter;
using sightline::core::Time;

struct Noise {
  double sigma;   // true [rad]
  double stated;  // [rad]
  double period = 0.033;
  double wild_share = 0.0;  // of sightings that are anywhere
};

/// Sightings of a target on the paper's sinusoid.
Scatter scatterOf(const Noise& noise, int count = 400, double azimuth = 0.0) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  Scatter scatter;
  Scatter::Chain chain;
  double t = 0.0;
  for (int k = 0; k < count; ++k) {
    t += noise.period * (0.5 + uniform(random));
    Eigen::Vector2d angles(azimuth + std::sin(t), 0.8 * std::cos(t));
    angles += noise.sigma * Eigen::Vector2d(normal(random), normal(random));
    if (uniform(random) < noise.wild_share) angles.x() += uniform(random);
    scatter.add(chain, Time(durationOf(t)), angles,
                noise.stated * noise.stated * Eigen::Matrix2d::Identity());
  }
  return scatter;
}

TEST(Scatter, IsThatOfTheNoiseWhateverItIs) {
  // 397 overlapping samples: the median's relative error is below 0.12 (three sigma, counting a quarter).
  for (const double sigma : {1e-4, 1e-3, 1e-2}) {
    EXPECT_NEAR(*scatterOf({sigma, sigma}).ratio(), 1.0, 0.12) << sigma;
    EXPECT_NEAR(*scatterOf({sigma, sigma / 3.0}).ratio(), 3.0, 0.36) << sigma;
    EXPECT_NEAR(*scatterOf({sigma, 10.0 * sigma}).ratio(), 0.1, 0.012) << sigma;
  }
}

TEST(Scatter, WrapsTheAzimuth) {
  EXPECT_NEAR(*scatterOf({1e-3, 1e-3}, 400, 3.0).ratio(), 1.0, 0.12);
}

TEST(Scatter, IsNotMovedMuchByStraySightings) {
  EXPECT_LT(*scatterOf({1e-3, 1e-3, 0.033, 0.02}).ratio(), 1.4);
}

TEST(Scatter, IsNotDeterminedByFewOrSlowSightings) {
  EXPECT_FALSE(scatterOf({1e-3, 1e-3}, 10).ratio());
  EXPECT_FALSE(scatterOf({1e-3, 1e-3, 1.0}).ratio()) << "one a second: the target's motion would count";
}

TEST(Scatter, SightingsOfDifferentTargetsAreNotCompared) {
  Scatter scatter;
  const Eigen::Matrix2d covariance = 1e-6 * Eigen::Matrix2d::Identity();
  std::vector<Scatter::Chain> chains(100);
  for (int k = 0; k < 300; ++k)
    scatter.add(chains[static_cast<std::size_t>(k / 3)], Time(durationOf(0.03 * k)), {0.0, 0.0}, covariance);
  EXPECT_EQ(scatter.samples(), 0u) << "three of each";
  for (int k = 300; k < 400; ++k) scatter.add(chains[0], Time(durationOf(0.03 * k)), {0.0, 0.0}, covariance);
  EXPECT_EQ(scatter.samples(), 97u);
}

}  // namespace
