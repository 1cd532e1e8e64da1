#include "sightline/core/association/clusters.h"

#include <cmath>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

namespace sightline::core {
namespace {

TEST(Clusters, PairsThatShareATrackOrASightingBelongTogether) {
  const std::vector<GatedPair> pairs{{3, 0, 0.0}, {1, 5, 0.0}, {3, 2, 0.0},
                                     {0, 7, 0.0}, {2, 5, 0.0}, {4, 2, 0.0}};
  EXPECT_EQ(clusters(pairs), (std::vector<std::vector<int>>{{0, 2, 5}, {1, 4}, {3}}));
}

TEST(Clusters, OfNothingAreNone) {
  EXPECT_TRUE(clusters({}).empty());
}

TEST(Clusters, NegativeIndexIsRefused) {
  EXPECT_THROW(clusters({{-1, 0, 0.0}}), std::invalid_argument);
  EXPECT_THROW(clusters({{0, -1, 0.0}}), std::invalid_argument);
}

TEST(Clusters, HundredThousandPairsInARingAreOne) {
  std::vector<GatedPair> pairs;
  for (int k = 0; k < 50'000; ++k) {
    pairs.push_back({k, k, 0.0});
    pairs.push_back({k, (k + 1) % 50'000, 0.0});
  }
  const auto groups = clusters(pairs);
  ASSERT_EQ(groups.size(), 1U);
  EXPECT_EQ(groups.front().size(), pairs.size());
}

TEST(Clusters, OneClusterNumbersItsTracksAndSightingsFromZero) {
  const std::vector<GatedPair> pairs{{7, 4, 1.0}, {0, 0, 0.0}, {5, 4, 2.0}, {7, 9, 3.0}};
  std::vector<double> miss_weight(8, 1.0);
  miss_weight[7] = 0.1;
  miss_weight[5] = 0.0;
  const Cluster cluster = clusterOf(pairs, {0, 2, 3}, miss_weight);
  EXPECT_EQ(cluster.tracks, (std::vector<int>{5, 7}));
  EXPECT_EQ(cluster.takers, (std::vector<std::vector<int>>{{1, 0}, {1}}));
  ASSERT_EQ(cluster.choices[0].size(), 1U);
  ASSERT_EQ(cluster.choices[1].size(), 2U);
  EXPECT_EQ(cluster.choices[1][1].pair, 3);
  EXPECT_EQ(cluster.choices[1][1].sighting, 1);
  EXPECT_DOUBLE_EQ(cluster.choices[1][1].weight, 3.0 - std::log(0.1));
  EXPECT_DOUBLE_EQ(cluster.choices[0][0].weight, 2.0 - std::log(kLeastMissWeight));
}

}  // namespace
}  // namespace sightline::core
