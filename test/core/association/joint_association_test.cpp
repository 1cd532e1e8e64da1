#include "sightline/core/association/joint_association.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <set>
#include <stdexcept>

#include <gtest/gtest.h>

namespace sightline::core {
namespace {

/// Marginals by going through every way to associate.
JointProbabilities byEnumeration(const std::vector<GatedPair>& pairs,
                                 const std::vector<double>& miss_weight) {
  JointProbabilities sums;
  sums.missed.assign(miss_weight.size(), 0.0);
  sums.paired.assign(pairs.size(), 0.0);
  std::vector<int> chosen(miss_weight.size(), -1);
  std::set<int> taken;
  double total = 0.0;
  std::function<void(std::size_t, double)> go = [&](std::size_t track, double weight) {
    if (track == miss_weight.size()) {
      total += weight;
      for (std::size_t i = 0; i < chosen.size(); ++i) {
        (chosen[i] < 0 ? sums.missed[i] : sums.paired[chosen[i]]) += weight;
      }
      return;
    }
    chosen[track] = -1;
    go(track + 1, weight * miss_weight[track]);
    for (std::size_t k = 0; k < pairs.size(); ++k) {
      if (pairs[k].track != static_cast<int>(track) || !taken.insert(pairs[k].sighting).second) continue;
      chosen[track] = static_cast<int>(k);
      go(track + 1, weight * std::exp(pairs[k].log_ratio));
      taken.erase(pairs[k].sighting);
    }
  };
  go(0, 1.0);
  for (double& sum : sums.missed) sum /= total;
  for (double& sum : sums.paired) sum /= total;
  return sums;
}

double largestDifference(const JointProbabilities& a, const JointProbabilities& b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < a.missed.size(); ++i)
    largest = std::max(largest, std::abs(a.missed[i] - b.missed[i]));
  for (std::size_t k = 0; k < a.paired.size(); ++k)
    largest = std::max(largest, std::abs(a.paired[k] - b.paired[k]));
  return largest;
}

struct Problem {
  std::vector<GatedPair> pairs;
  std::vector<double> miss_weight;
};

/// Tracks and sightings scattered over a square of side `width` [sigma of the innovation], gated at 4 sigma.
Problem scattered(int tracks, int sightings, double width, std::mt19937_64& random) {
  std::uniform_real_distribution<double> place(0.0, width);
  std::normal_distribution<double> noise;
  std::vector<std::array<double, 2>> track_at(tracks), sighting_at(sightings);
  for (auto& at : track_at) at = {place(random), place(random)};
  for (int j = 0; j < sightings; ++j) {
    if (j < tracks) {
      sighting_at[j] = {track_at[j][0] + noise(random), track_at[j][1] + noise(random)};
    } else {
      sighting_at[j] = {place(random), place(random)};
    }
  }
  const double P_D = 0.9, density = std::max(sightings - tracks, 1) / (width * width);  // of false ones
  Problem problem;
  problem.miss_weight.assign(tracks, 1.0 - P_D);
  for (int i = 0; i < tracks; ++i) {
    for (int j = 0; j < sightings; ++j) {
      const double distance_squared = std::pow(track_at[i][0] - sighting_at[j][0], 2.0) +
                                      std::pow(track_at[i][1] - sighting_at[j][1], 2.0);
      if (distance_squared > 16.0) continue;
      problem.pairs.push_back({i, j, std::log(P_D / (density * 2.0 * M_PI)) - 0.5 * distance_squared});
    }
  }
  return problem;
}

TEST(JointProbabilities, OfOneTrackAreTheTextbooks) {
  // beta_0 = b / (b + l1 + l2) with b = 0.2, l1 = 0.5, l2 = 0.3.
  const auto found = jointProbabilities({{0, 0, std::log(0.5)}, {0, 1, std::log(0.3)}}, {0.2});
  EXPECT_NEAR(found.missed[0], 0.2, 1e-15);
  EXPECT_NEAR(found.paired[0], 0.5, 1e-15);
  EXPECT_NEAR(found.paired[1], 0.3, 1e-15);
}

TEST(JointProbabilities, OfTwoTracksWithASightingInCommonAreThoseWorkedByHand) {
  // Ways: neither 0.1*0.2 = 0.02, first takes 3*0.2 = 0.6, second takes 0.1*4 = 0.4, both impossible.
  // Sum 1.02.
  const auto found = jointProbabilities({{0, 0, std::log(3.0)}, {1, 0, std::log(4.0)}}, {0.1, 0.2});
  EXPECT_TRUE(found.is_exact);
  EXPECT_NEAR(found.paired[0], 0.6 / 1.02, 1e-14);
  EXPECT_NEAR(found.paired[1], 0.4 / 1.02, 1e-14);
  EXPECT_NEAR(found.missed[0], 0.42 / 1.02, 1e-14);
  EXPECT_NEAR(found.missed[1], 0.62 / 1.02, 1e-14);
}

TEST(JointProbabilities, TrackWithoutSightingsIsMissed) {
  const auto found = jointProbabilities({{1, 0, 2.0}}, {0.1, 0.1});
  EXPECT_EQ(found.missed[0], 1.0);
  EXPECT_LT(found.missed[1], 0.1);
}

TEST(JointProbabilities, EqualEnumerationOnRandomProblems) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::uniform_int_distribution<int> number(1, 6);
  for (int trial = 0; trial < 500; ++trial) {
    const int tracks = number(random), sightings = number(random);
    Problem problem;
    for (int i = 0; i < tracks; ++i) {
      problem.miss_weight.push_back(0.05 + 0.9 * uniform(random));
      for (int j = 0; j < sightings; ++j) {
        if (uniform(random) < 0.6) problem.pairs.push_back({i, j, 8.0 * uniform(random) - 4.0});
      }
    }
    std::shuffle(problem.pairs.begin(), problem.pairs.end(), random);
    const auto found = jointProbabilities(problem.pairs, problem.miss_weight);
    ASSERT_TRUE(found.is_exact);
    ASSERT_LT(largestDifference(found, byEnumeration(problem.pairs, problem.miss_weight)), 1e-12);
  }
}

TEST(JointProbabilities, ExtremeRatiosNeitherOverflowNorVanish) {
  // Three tracks want one sighting, each e^800 : 1; the rest is decided by ratios of e^-900.
  const std::vector<GatedPair> pairs{
      {0, 0, 800.0}, {1, 0, 800.0}, {2, 0, 800.0 + std::log(2.0)}, {0, 1, -900.0}, {1, 1, -900.0}};
  const auto exact = jointProbabilities(pairs, {1.0, 1.0, 1.0});
  EXPECT_NEAR(exact.paired[0], 0.25, 1e-12);
  EXPECT_NEAR(exact.paired[1], 0.25, 1e-12);
  EXPECT_NEAR(exact.paired[2], 0.5, 1e-12);
  EXPECT_NEAR(exact.missed[2], 0.5, 1e-12);

  JointAssociationParams by_belief;
  by_belief.max_terms = 0;
  const auto belief = jointProbabilities(pairs, {1.0, 1.0, 1.0}, by_belief);
  for (const double probability : belief.paired) EXPECT_TRUE(probability >= 0.0 && probability <= 1.0);
}

TEST(JointProbabilities, ImpossiblePairsAndSureDetectionsAreWelcome) {
  const double impossible = -std::numeric_limits<double>::infinity();
  const auto found = jointProbabilities({{0, 0, impossible}, {1, 0, 0.0}, {1, 1, 0.0}}, {0.5, 0.0});
  EXPECT_EQ(found.missed[0], 1.0);
  EXPECT_EQ(found.paired[0], 0.0);
  EXPECT_NEAR(found.missed[1], 0.0, 1e-11);
  EXPECT_NEAR(found.paired[1], 0.5, 1e-11);
}

TEST(JointProbabilities, WhatCannotBeIsRefused) {
  EXPECT_THROW(jointProbabilities({{1, 0, 0.0}}, {0.1}), std::invalid_argument);
  EXPECT_THROW(jointProbabilities({{0, -1, 0.0}}, {0.1}), std::invalid_argument);
  EXPECT_THROW(jointProbabilities({{0, 0, std::nan("")}}, {0.1}), std::invalid_argument);
  EXPECT_THROW(jointProbabilities({{0, 0, std::numeric_limits<double>::infinity()}}, {0.1}),
               std::invalid_argument);
  EXPECT_THROW(jointProbabilities({{0, 0, 0.0}}, {1.1}), std::invalid_argument);
  EXPECT_THROW(jointProbabilities({{0, 0, 0.0}}, {std::nan("")}), std::invalid_argument);
}

TEST(JointProbabilities, LongChainOfTracksIsExact) {
  // Each of 500 tracks shares a sighting with the next one: 2^500 ways and more.
  Problem problem;
  for (int i = 0; i < 500; ++i) {
    problem.miss_weight.push_back(0.1);
    problem.pairs.push_back({i, i, 1.0});
    problem.pairs.push_back({i, i + 1, 0.5});
  }
  const auto found = jointProbabilities(problem.pairs, problem.miss_weight);
  EXPECT_TRUE(found.is_exact);
  for (int i = 0; i < 500; ++i)
    ASSERT_NEAR(found.missed[i] + found.paired[2 * i] + found.paired[2 * i + 1], 1.0, 1e-12);
}

TEST(JointProbabilities, ByBeliefPropagationAreNearTheExactOnes) {
  std::mt19937_64 random(5);
  JointAssociationParams by_sum, by_belief;
  by_sum.max_terms = 10'000'000;
  by_belief.max_terms = 0;
  double largest = 0.0, sum_of_largest = 0.0;
  constexpr int kTrials = 100;
  for (int trial = 0; trial < kTrials; ++trial) {
    const Problem problem = scattered(8, 14, 6.0, random);
    const auto exact = jointProbabilities(problem.pairs, problem.miss_weight, by_sum);
    const auto belief = jointProbabilities(problem.pairs, problem.miss_weight, by_belief);
    ASSERT_TRUE(exact.is_exact);
    ASSERT_TRUE(belief.has_converged);
    const double difference = largestDifference(exact, belief);
    largest = std::max(largest, difference);
    sum_of_largest += difference / kTrials;
  }
  RecordProperty("largest", std::to_string(largest));
  RecordProperty("mean_of_largest", std::to_string(sum_of_largest));
  EXPECT_LT(largest, 0.1) << "of all marginals of all problems";
  EXPECT_LT(sum_of_largest, 0.03) << "the worst marginal of a problem, in the mean";
}

TEST(JointProbabilities, HugeKnotEndsWithProbabilitiesThatSumToOne) {
  std::mt19937_64 random(3);
  const Problem problem = scattered(1000, 10'000, 60.0, random);
  ASSERT_EQ(clusters(problem.pairs).size(), 1U);
  const auto found = jointProbabilities(problem.pairs, problem.miss_weight);
  EXPECT_FALSE(found.is_exact);
  EXPECT_TRUE(found.has_converged);
  std::vector<double> of_track = found.missed, of_sighting(10'000, 0.0);
  for (std::size_t k = 0; k < problem.pairs.size(); ++k) {
    of_track[problem.pairs[k].track] += found.paired[k];
    of_sighting[problem.pairs[k].sighting] += found.paired[k];
  }
  for (const double sum : of_track) ASSERT_NEAR(sum, 1.0, 1e-9);
  for (const double sum : of_sighting) ASSERT_LE(sum, 1.0 + 1e-3);
}

TEST(JointProbabilities, OrderOfTracksAndSightingsChangesNothing) {
  std::mt19937_64 random(9);
  const Problem problem = scattered(7, 12, 5.0, random);
  Problem turned = problem;
  std::reverse(turned.pairs.begin(), turned.pairs.end());
  for (GatedPair& pair : turned.pairs) {
    pair.track = 6 - pair.track;
    pair.sighting = 11 - pair.sighting;
  }
  const auto a = jointProbabilities(problem.pairs, problem.miss_weight);
  const auto b = jointProbabilities(turned.pairs, turned.miss_weight);
  for (std::size_t k = 0; k < problem.pairs.size(); ++k)
    EXPECT_NEAR(a.paired[k], b.paired[problem.pairs.size() - 1 - k], 1e-12);
}

}  // namespace
}  // namespace sightline::core
