#include "sightline/core/simulation/random_stream.h"

#include <cmath>
#include <set>

#include <gtest/gtest.h>

namespace sightline::core {
namespace {

constexpr int kDraws = 100000;

TEST(RandomStream, SequenceIsTheSameOnEveryMachine) {
  RandomStream stream(0);  // the published first outputs of SplitMix64 for seed 0
  EXPECT_EQ(stream.bits(), 0xe220a8397b1dcdafULL);
  EXPECT_EQ(stream.bits(), 0x6e789e6aa1b965f4ULL);
  EXPECT_EQ(stream.bits(), 0x06c45d188009454fULL);
}

TEST(RandomStream, SeedsOfDifferentNamesDiffer) {
  std::set<std::uint64_t> seeds;
  for (const char* name : {"", "a", "b", "ab", "ba", "tracking_1", "tracking_2", "tracking_12"}) {
    for (std::uint64_t seed = 0; seed < 100; ++seed) seeds.insert(seedOf(seed, name));
  }
  EXPECT_EQ(seeds.size(), 800U);
  EXPECT_EQ(seedOf(7, "tracking_1"), seedOf(7, "tracking_1"));
}

TEST(RandomStream, StreamsOfDifferentNamesAreUncorrelated) {
  RandomStream a(seedOf(1, "noise of 1")), b(seedOf(1, "noise of 2"));
  double product = 0.0;
  for (int i = 0; i < kDraws; ++i) product += a.normalPair().dot(b.normalPair());
  EXPECT_LT(std::abs(product), 5.0 * std::sqrt(2.0 * kDraws));  // 5 sigma of a sum of 2 n products
}

TEST(RandomStream, UniformNumbersFillTheUnitInterval) {
  RandomStream stream(3);
  double sum = 0.0, smallest = 1.0, largest = 0.0;
  for (int i = 0; i < kDraws; ++i) {
    const double u = stream.uniform();
    ASSERT_GE(u, 0.0);
    ASSERT_LT(u, 1.0);
    sum += u;
    smallest = std::min(smallest, u);
    largest = std::max(largest, u);
  }
  EXPECT_NEAR(sum / kDraws, 0.5, 5.0 / std::sqrt(12.0 * kDraws));
  EXPECT_LT(smallest, 20.0 / kDraws);
  EXPECT_GT(largest, 1.0 - 20.0 / kDraws);
}

TEST(RandomStream, NormalNumbersHaveTheirFirstFourMoments) {
  RandomStream stream(4);
  Eigen::Array4d moments = Eigen::Array4d::Zero();
  double cross = 0.0;
  for (int i = 0; i < kDraws; ++i) {
    const Eigen::Vector2d pair = stream.normalPair();
    cross += pair.x() * pair.y();
    for (const double x : {pair.x(), pair.y()}) moments += Eigen::Array4d(x, x * x, x * x * x, x * x * x * x);
  }
  const double n = 2.0 * kDraws;
  moments /= n;  // their variances are 1, 2, 15 and 96 over n
  EXPECT_NEAR(moments(0), 0.0, 5.0 * std::sqrt(1.0 / n));
  EXPECT_NEAR(moments(1), 1.0, 5.0 * std::sqrt(2.0 / n));
  EXPECT_NEAR(moments(2), 0.0, 5.0 * std::sqrt(15.0 / n));
  EXPECT_NEAR(moments(3), 3.0, 5.0 * std::sqrt(96.0 / n));
  EXPECT_NEAR(cross / kDraws, 0.0, 5.0 / std::sqrt(kDraws));
}

TEST(RandomStream, PoissonNumbersHaveTheirMeanAsVariance) {
  for (const double mean : {0.0, 0.2, 3.0, 1000.0}) {
    RandomStream stream(5);
    const int draws = 20000;
    double sum = 0.0, squares = 0.0;
    for (int i = 0; i < draws; ++i) {
      const double k = stream.poisson(mean);
      sum += k;
      squares += (k - mean) * (k - mean);
    }
    EXPECT_NEAR(sum / draws, mean, 5.0 * std::sqrt(mean / draws));
    // var of (k - m)^2 is m + 2 m^2
    EXPECT_NEAR(squares / draws, mean, 5.0 * std::sqrt((mean + 2.0 * mean * mean) / draws));
  }
}

}  // namespace
}  // namespace sightline::core
