#include "sightline/core/association/exact_marginals.h"

#include <cmath>

#include <gtest/gtest.h>

namespace sightline::core {
namespace {

struct Sum {
  bool is_done = false;
  JointProbabilities probabilities;
};

Sum sumOver(const std::vector<GatedPair>& pairs, const std::vector<double>& miss_weight,
            std::size_t max_terms) {
  Sum sum;
  sum.probabilities.missed.assign(miss_weight.size(), -1.0);
  sum.probabilities.paired.assign(pairs.size(), -1.0);
  const auto groups = clusters(pairs);
  sum.is_done = sumExactly(clusterOf(pairs, groups.front(), miss_weight), max_terms, sum.probabilities);
  return sum;
}

// Two tracks, one sighting: weights w_1 m_2, m_1 w_2, m_1 m_2 of "first", "second", "nobody".
TEST(ExactMarginals, OfTwoTracksAtOneSightingAreThoseByHand) {
  const double w_1 = 8.0, w_2 = 2.0, m_1 = 0.1, m_2 = 0.3;
  const Sum sum = sumOver({{0, 0, std::log(w_1)}, {1, 0, std::log(w_2)}}, {m_1, m_2}, 1000);
  ASSERT_TRUE(sum.is_done);
  const double total = w_1 * m_2 + m_1 * w_2 + m_1 * m_2;
  EXPECT_NEAR(sum.probabilities.paired[0], w_1 * m_2 / total, 1e-14);
  EXPECT_NEAR(sum.probabilities.paired[1], m_1 * w_2 / total, 1e-14);
  EXPECT_NEAR(sum.probabilities.missed[0], (m_1 * w_2 + m_1 * m_2) / total, 1e-14);
  EXPECT_NEAR(sum.probabilities.missed[1], (w_1 * m_2 + m_1 * m_2) / total, 1e-14);
}

TEST(ExactMarginals, BeyondTheLargestNumberOfTermsNothingIsWritten) {
  const Sum sum = sumOver({{0, 0, 1.0}, {0, 1, 0.5}, {1, 0, 1.0}, {1, 1, 0.5}}, {0.1, 0.1}, 3);
  EXPECT_FALSE(sum.is_done);
  for (const double probability : sum.probabilities.paired) EXPECT_EQ(probability, -1.0);
  for (const double probability : sum.probabilities.missed) EXPECT_EQ(probability, -1.0);
}

TEST(ExactMarginals, RatiosThatOverflowAsNumbersAreSummed) {
  const Sum sum = sumOver({{0, 0, 5000.0}, {1, 0, 5000.0}}, {0.1, 0.1}, 1000);
  ASSERT_TRUE(sum.is_done);
  EXPECT_NEAR(sum.probabilities.paired[0], 0.5, 1e-12);
  EXPECT_NEAR(sum.probabilities.paired[1], 0.5, 1e-12);
}

}  // namespace
}  // namespace sightline::core
