#include "sightline/core/evaluation/gospa.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "sightline/core/model/sphere.h"

using namespace sightline::core;

namespace {

using Directions = std::vector<Eigen::Vector3d>;

/// On the equator, where angles add up.
Eigen::Vector3d at(double azimuth) {
  return directionOf({azimuth, 0.0});
}

TEST(Gospa, IsThatWorkedByHand) {
  // c = 10 mrad, p = 2. Pairs 3 and 4 mrad apart; one estimate 15 mrad off: false, and its target missed.
  const Directions truths = {at(0.0), at(0.1), at(0.2)};
  const Directions estimates = {at(0.215), at(0.003), at(0.104)};
  const Gospa result = gospa(estimates, truths, {0.01, 2.0});
  EXPECT_EQ(result.assigned, 2);
  EXPECT_EQ(result.missed, 1);
  EXPECT_EQ(result.extra, 1);
  EXPECT_NEAR(result.localisation, 5e-3, 1e-12);                 // sqrt(9 + 16)
  EXPECT_NEAR(result.distance, 1e-3 * std::sqrt(125.0), 1e-12);  // 25 + 2 * 100 / 2
}

TEST(Gospa, OfOrderOneAddsUp) {
  const Gospa result = gospa({at(0.003), at(0.1)}, {at(0.0)}, {0.01, 1.0});
  EXPECT_NEAR(result.localisation, 3e-3, 1e-12);
  EXPECT_NEAR(result.distance, 8e-3, 1e-12);  // 3 + 10 / 2
}

TEST(Gospa, TakesTheBestAssignmentNotTheGreedyOne) {
  // Greedy: 0.001 with 0.000 (1 mrad) leaves 0.008 too far from -0.004 (100 for two alone); the best pairs
  // have 5 and 8.
  const Gospa best = gospa({at(0.001), at(0.008)}, {at(0.0), at(-0.004)}, {0.01, 2.0});
  EXPECT_EQ(best.assigned, 2);
  EXPECT_NEAR(best.distance, 1e-3 * std::sqrt(25.0 + 64.0), 1e-12);
  // A little further off the two alone are cheaper.
  const Gospa alone = gospa({at(0.001), at(0.0095)}, {at(0.0), at(-0.004)}, {0.01, 2.0});
  EXPECT_EQ(alone.assigned, 1);
  EXPECT_NEAR(alone.distance, 1e-3 * std::sqrt(1.0 + 100.0), 1e-12);
}

TEST(Gospa, EmptySetsCostHalfACutoffPowerEach) {
  EXPECT_EQ(gospa({}, {}).distance, 0.0);
  EXPECT_NEAR(gospa({}, {at(0.0), at(1.0)}, {0.01, 2.0}).distance, 0.01, 1e-12);
  EXPECT_EQ(gospa({}, {at(0.0)}).missed, 1);
  EXPECT_NEAR(gospa({at(0.0)}, {}, {0.01, 2.0}).distance, 0.01 / std::sqrt(2.0), 1e-12);
  EXPECT_EQ(gospa({at(0.0)}, {}).extra, 1);
}

TEST(Gospa, IsSymmetricAndObeysTheTriangleInequality) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> angle(-0.01, 0.01);
  const auto randomSet = [&] {
    Directions set(random() % 4);
    for (auto& direction : set) direction = directionOf({angle(random), angle(random)});
    return set;
  };
  for (int trial = 0; trial < 300; ++trial) {
    const Directions a = randomSet(), b = randomSet(), c = randomSet();
    EXPECT_NEAR(gospa(a, b).distance, gospa(b, a).distance, 1e-12);
    EXPECT_LE(gospa(a, c).distance, gospa(a, b).distance + gospa(b, c).distance + 1e-12);
  }
}

TEST(GospaMeans, AreThoseWorkedByHand) {
  GospaMeans means(GospaParams{0.01, 2.0});
  EXPECT_TRUE(std::isnan(means.distance()));
  means.add(gospa({at(0.003), at(0.104)}, {at(0.0), at(0.1)}, means.params()));  // 5 mrad
  means.add(gospa({at(0.5)}, {at(0.0)}, means.params()));                        // 10 mrad
  EXPECT_EQ(means.instants(), 2u);
  EXPECT_NEAR(means.distance(), 7.5e-3, 1e-12);
  EXPECT_NEAR(means.localisation(), 1e-3 * std::sqrt(12.5), 1e-12);
  EXPECT_NEAR(means.missed(), 0.5, 1e-12);
  EXPECT_NEAR(means.extra(), 0.5, 1e-12);
}

TEST(GospaMeans, PartsAsCostsAreThoseWorkedByHand) {
  // c = 10 mrad, p = 2. First instant: pairs 3 and 4 mrad apart, two targets missed: 9 + 16 + 2 * 100 / 2.
  // Second: a pair 1 mrad apart and three false ones: 1 + 3 * 100 / 2. Means of the squares [mrad^2]:
  // localisation 13, missed 50, false 75, all 138.
  GospaMeans means(GospaParams{0.01, 2.0});
  EXPECT_TRUE(std::isnan(means.rms()) && std::isnan(means.missedCost()));
  means.add(gospa({at(0.003), at(0.104)}, {at(0.0), at(0.1), at(0.5), at(0.6)}, means.params()));
  means.add(gospa({at(0.001), at(0.1), at(0.2), at(0.3)}, {at(0.0)}, means.params()));
  EXPECT_NEAR(means.localisationCost(), 1e-3 * std::sqrt(13.0), 1e-12);
  EXPECT_NEAR(means.missedCost(), 1e-3 * std::sqrt(50.0), 1e-12);
  EXPECT_NEAR(means.extraCost(), 1e-3 * std::sqrt(75.0), 1e-12);
  EXPECT_NEAR(means.rms(), 1e-3 * std::sqrt(138.0), 1e-12);
  EXPECT_NEAR(means.localisation(), 1e-3 * std::sqrt(26.0 / 3.0), 1e-12);  // a pair
}

}  // namespace
