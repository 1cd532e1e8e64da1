#include "sightline/core/estimators/mode_chain.h"

#include <array>
#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

#include "support/covariances.h"
#include "support/simulated.h"

namespace sightline::core {
namespace {

ModeArray array(std::initializer_list<double> values) {
  ModeArray result(static_cast<Eigen::Index>(values.size()));
  std::copy(values.begin(), values.end(), result.begin());
  return result;
}

ModeChain uneven() {
  ModeChain chain(ModeArray::Ones(3), 2.0);
  chain.update(0.0, array({0.0, -1.0, -3.0}));
  return chain;
}

/// Probability of being in mode j 0.5 s after mode i, by the attractions, with a dwell of 2 s.
double transition(const ModeArray& attraction, int i, int j) {
  const double drawn = (1.0 - std::exp(-0.5 / 2.0)) * 3.0 / 2.0;
  return (i == j ? 1.0 - drawn : 0.0) + drawn * attraction(j) / attraction.sum();
}

TEST(ModeChain, TakesSightingsByBayesRule) {
  const ModeChain chain = uneven();
  const ModeArray expected = array({1.0, std::exp(-1.0), std::exp(-3.0)});
  EXPECT_TRUE(chain.probabilities().isApprox(expected / expected.sum(), 1e-12));
}

TEST(ModeChain, StaysWithProbabilityExpAndLeavesForAllAlike) {
  const ModeChain chain = uneven();
  const double stay = std::exp(-0.5 / 2.0), leave = (1.0 - stay) / 2.0;
  const ModeArray p = chain.probabilities(), next = chain.predicted(0.5);
  for (int j = 0; j < 3; ++j) EXPECT_NEAR(next(j), stay * p(j) + leave * (1.0 - p(j)), 1e-14);
  EXPECT_NEAR(next.sum(), 1.0, 1e-14);
  EXPECT_TRUE(chain.predicted(0.0).isApprox(p));
}

TEST(ModeChain, IsDrawnInProportionToTheAttraction) {
  const ModeArray attraction = array({1.0, 4.0, 0.1});
  ModeChain chain(attraction, 2.0);
  EXPECT_TRUE(chain.probabilities().isApprox(attraction / 5.1, 1e-14));
  chain.update(0.0, array({0.0, -1.0, -3.0}));
  const ModeArray p = chain.probabilities(), next = chain.predicted(0.5);
  for (int j = 0; j < 3; ++j) {
    double expected = 0.0;
    for (int i = 0; i < 3; ++i) expected += p(i) * transition(attraction, i, j);
    EXPECT_NEAR(next(j), expected, 1e-14);
  }
  EXPECT_NEAR(next.sum(), 1.0, 1e-14);
}

TEST(ModeChain, InteractsByBayesRule) {
  const ModeArray attraction = array({1.0, 4.0, 0.1});
  ModeChain chain(attraction, 2.0);
  chain.update(0.0, array({0.0, -1.0, -3.0}));
  const ModeArray own = chain.ownShares(0.5);
  for (int j = 0; j < 3; ++j) {
    for (int i = 0; i < 3; ++i) {
      const double from_i = (i == j ? own(j) : 0.0) + (1.0 - own(j)) * chain.probabilities()(i);
      EXPECT_NEAR(from_i, transition(attraction, i, j) * chain.probabilities()(i) / chain.predicted(0.5)(j),
                  1e-14);
    }
  }
  EXPECT_TRUE(chain.ownShares(0.0).isApprox(ModeArray::Ones(3)));
}

TEST(ModeChain, NeverGivesUpAMode) {
  ModeChain chain(ModeArray::Ones(2), 1e9);
  for (int i = 0; i < 50; ++i) chain.update(0.01, array({0.0, -1e6}));
  EXPECT_GT(chain.probabilities()(1), 0.5e-12);
  for (int i = 0; i < 2; ++i) chain.update(0.01, array({-1e6, 0.0}));
  EXPECT_GT(chain.probabilities()(1), 0.99);
}

TEST(ModeChain, OfOneModeIsCertain) {
  ModeChain chain(ModeArray::Ones(1), 1.0);
  chain.update(0.5, array({-1e5}));
  EXPECT_EQ(chain.probabilities()(0), 1.0);
  EXPECT_EQ(chain.predicted(3.0)(0), 1.0);
  EXPECT_EQ(chain.ownShares(3.0)(0), 1.0);
}

TEST(ModeChain, ImprobableChangesDoNotMix) {
  ModeChain all(ModeArray::Ones(3), 60.0), likely(ModeArray::Ones(3), 60.0, 1e-3);
  for (ModeChain* chain : {&all, &likely}) chain->update(0.0, array({0.0, -2.0, -6.0}));
  const ModeArray mixes = all.ownShares(0.03), kept = likely.ownShares(0.03);
  ASSERT_LT(1.0 - mixes(0), 1e-3);
  ASSERT_GT(1.0 - mixes(2), 1e-3);
  EXPECT_LT(mixes(0), 1.0);
  EXPECT_EQ(kept(0), 1.0);
  EXPECT_EQ(kept(2), mixes(2));
  EXPECT_TRUE((likely.predicted(0.03) == all.predicted(0.03)).all()) << "probabilities are the same";
}

TEST(ModeChain, LeavesOutTheLeastProbableModesThatSumToNoMore) {
  const ModeArray probabilities = array({0.004, 0.98, 0.003, 0.009, 0.004});
  const ModeArray likely = likelyShares(probabilities, 0.01);
  EXPECT_EQ(likely(2), 0.0);
  EXPECT_EQ((likely == 0.0).count(), 1) << "of two of 0.004, for which there is no room, none";
  EXPECT_NEAR(likely.sum(), 1.0, 1e-15);
  EXPECT_NEAR(likely(1) / likely(3), 0.98 / 0.009, 1e-9);
  EXPECT_TRUE((likelyShares(probabilities, 0.0) == probabilities).all());
  EXPECT_EQ(likelyShares(array({1.0}), 0.5)(0), 1.0);
}

TEST(ModeChain, RefusesNoModesNoAttractionAndNoDwell) {
  EXPECT_THROW(ModeChain(ModeArray(0), 1.0), std::invalid_argument);
  EXPECT_THROW(ModeChain(array({1.0, 0.0}), 1.0), std::invalid_argument);
  EXPECT_THROW(ModeChain(ModeArray::Ones(2), 0.0), std::invalid_argument);
  EXPECT_THROW(ModeChain(ModeArray::Ones(2), 1.0, 1.0), std::invalid_argument);
}

TEST(Mixture, OfTwoIsThatOfMany) {
  std::array<Motion<4>, 2> motions;
  motions[0].mean << 1.0, 0.0, 2.0, 0.0;
  motions[1].mean << 3.0, 0.0, 0.0, 1.0;
  motions[0].covariance.setIdentity();
  motions[1].covariance = 2.0 * Eigen::Matrix4d::Identity();
  const Motion<4> many = mixture(array({0.3, 0.7}), motions.data()),
                  two = mixture(0.3, motions[0], motions[1]);
  EXPECT_TRUE(two.mean.isApprox(many.mean, 1e-14));
  EXPECT_TRUE(two.covariance.isApprox(many.covariance, 1e-14));
}

TEST(Mixture, HasTheSpreadOfTheMeansInItsCovariance) {
  std::array<Motion<4>, 2> motions;
  motions[0].mean << 1.0, 0.0, 0.0, 0.0;
  motions[1].mean << 3.0, 0.0, 0.0, 1.0;
  motions[0].covariance.setIdentity();
  motions[1].covariance = 2.0 * Eigen::Matrix4d::Identity();
  const Motion<4> mixed = mixture(array({0.75, 0.25}), motions.data());
  EXPECT_TRUE(mixed.mean.isApprox(Eigen::Vector4d(1.5, 0.0, 0.0, 0.25)));
  EXPECT_NEAR(mixed.covariance(0, 0), 0.75 * (1.0 + 0.25) + 0.25 * (2.0 + 2.25), 1e-14);
  EXPECT_NEAR(mixed.covariance(0, 3), 0.75 * 0.5 * 0.25 + 0.25 * 1.5 * 0.75, 1e-14);
  EXPECT_TRUE(test::isCovariance(mixed.covariance));
}

}  // namespace
}  // namespace sightline::core
