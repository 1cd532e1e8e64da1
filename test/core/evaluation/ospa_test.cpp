#include "sightline/core/evaluation/ospa.h"

#include <algorithm>
#include <cmath>
#include <numeric>
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

/// By the definition: the smaller set's members take different ones of the larger in every way there is.
double byTrial(Directions a, Directions b, const GospaParams& params) {
  if (a.size() > b.size()) std::swap(a, b);
  if (b.empty()) return 0.0;
  std::vector<std::size_t> order(b.size());
  std::iota(order.begin(), order.end(), 0);
  double best = std::numeric_limits<double>::infinity();
  do {
    double sum = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i)
      sum += std::pow(std::min(params.cutoff, angleBetween(a[i], b[order[i]])), params.order);
    best = std::min(best, sum);
  } while (std::next_permutation(order.begin(), order.end()));
  best += std::pow(params.cutoff, params.order) * static_cast<double>(b.size() - a.size());
  return std::pow(best / static_cast<double>(b.size()), 1.0 / params.order);
}

TEST(Ospa, IsThatWorkedByHand) {
  // c = 10 mrad, p = 2. Pairs 3 and 4 mrad apart, one pair 15 mrad apart counts as 10, a fourth estimate has
  // no partner: localisation^2 = (9 + 16 + 100) / 4, cardinality^2 = 100 / 4 [mrad^2].
  const Directions truths = {at(0.0), at(0.1), at(0.2)};
  const Directions estimates = {at(0.215), at(0.003), at(0.104), at(0.5)};
  const Ospa result = ospa(estimates, truths, {0.01, 2.0});
  EXPECT_NEAR(result.localisation, 1e-3 * std::sqrt(125.0 / 4.0), 1e-12);
  EXPECT_NEAR(result.cardinality, 5e-3, 1e-12);
  EXPECT_NEAR(result.distance, 7.5e-3, 1e-12);  // sqrt(225 / 4)
}

TEST(Ospa, OfOrderOneIsAMean) {
  // (3 + 10) / 2
  EXPECT_NEAR(ospa({at(0.003), at(0.1)}, {at(0.0)}, {0.01, 1.0}).distance, 6.5e-3, 1e-12);
}

TEST(Ospa, OfAnEmptySetIsTheCutoff) {
  EXPECT_EQ(ospa(Directions{}, Directions{}, GospaParams{}).distance, 0.0);
  EXPECT_NEAR(ospa({}, {at(0.0), at(1.0)}, {0.01, 2.0}).distance, 0.01, 1e-12);
  EXPECT_NEAR(ospa({at(0.0)}, {}, {0.01, 2.0}).cardinality, 0.01, 1e-12);
}

TEST(Ospa, IsThatOfTheDefinitionByTrialOfAllAssignments) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> angle(-0.012, 0.012);
  const auto randomSet = [&] {
    Directions set(random() % 6);
    for (auto& direction : set) direction = directionOf({angle(random), angle(random)});
    return set;
  };
  for (const double order : {1.0, 2.0, 3.0}) {
    for (int trial = 0; trial < 200; ++trial) {
      const Directions a = randomSet(), b = randomSet();
      const GospaParams params{0.01, order};
      EXPECT_NEAR(ospa(a, b, params).distance, byTrial(a, b, params), 1e-10);
      const Ospa parts = ospa(a, b, params);
      EXPECT_NEAR(std::pow(parts.distance, order),
                  std::pow(parts.localisation, order) + std::pow(parts.cardinality, order), 1e-12);
    }
  }
}

TEST(Ospa, IsSymmetricAndObeysTheTriangleInequality) {
  std::mt19937 random(17);
  std::uniform_real_distribution<double> angle(-0.01, 0.01);
  const auto randomSet = [&] {
    Directions set(random() % 4);
    for (auto& direction : set) direction = directionOf({angle(random), angle(random)});
    return set;
  };
  for (int trial = 0; trial < 300; ++trial) {
    const Directions a = randomSet(), b = randomSet(), c = randomSet();
    EXPECT_NEAR(ospa(a, b).distance, ospa(b, a).distance, 1e-12);
    EXPECT_LE(ospa(a, c).distance, ospa(a, b).distance + ospa(b, c).distance + 1e-12);
  }
}

}  // namespace
