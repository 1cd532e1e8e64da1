#include "sightline/core/fusion/association/tracker_misalignment.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace sightline::core {
namespace {

/// Reports of `targets` targets with errors of `sigma` [rad] in each angle, off by `bias` [rad] in one.
TrackerMisalignment after(int reports, int targets, double sigma, double bias, double share_of_strays = 0.0) {
  TrackerMisalignment registration(0.0);
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal(0.0, sigma);
  for (int k = 0; k < reports; ++k) {
    std::vector<Disagreement> disagreements;
    for (int i = 0; i < targets; ++i) {
      const bool strays = i < share_of_strays * targets;
      const double x = bias + normal(random) + (strays ? 1.0 : 0.0), y = normal(random);
      disagreements.push_back({x * x + y * y, sigma * sigma});
    }
    registration.take("a", disagreements);
  }
  return registration;
}

TEST(TrackerMisalignment, TrackersThatAgreeAreGivenNothing) {
  // The median of twenty varies by 0.3 of its value; a tenth is allowed for, and the rest fades.
  EXPECT_LT(after(500, 20, 1e-3, 0.0).sigma("a"), 0.4e-3);
}

TEST(TrackerMisalignment, BiasIsAllowedForInItsSize) {
  // |d|^2 is 9e-6 + noise of which the median is taken for 1.386 variances.
  EXPECT_NEAR(after(500, 20, 1e-3, 3e-3).sigma("a"), 3e-3 / std::sqrt(1.386), 0.6e-3);
  EXPECT_EQ(after(500, 20, 1e-3, 3e-3).sigma("b"), 0.0) << "of a tracker that nothing is known of";
}

TEST(TrackerMisalignment, FewTracksThatStrayChangeLittle) {
  EXPECT_LT(after(500, 20, 1e-3, 0.0, 0.2).sigma("a"), 1e-3);
}

TEST(TrackerMisalignment, TwoTargetsSayNothing) {
  EXPECT_EQ(after(500, 2, 1e-3, 3e-3).sigma("a"), 0.0);
}

TEST(TrackerMisalignment, RemembersNoMoreThanSoManyTrackersAndThoseThatAreOffMost) {
  TrackerMisalignment misalignment(0.0);
  const std::vector<Disagreement> off(5, {1e-4, 1e-8}), slightly(5, {1e-7, 1e-8});
  misalignment.take("off", off);
  for (int k = 0; k < 2000; ++k) misalignment.take("tracker " + std::to_string(k), slightly);
  EXPECT_GT(misalignment.sigma("off"), 1e-4);
  EXPECT_EQ(misalignment.sigma("tracker 0"), 0.0) << "forgotten";
}

TEST(TrackerMisalignment, LeastIsAllowedForInAnyCase) {
  EXPECT_EQ(TrackerMisalignment(2e-3).sigma("a"), 2e-3);
  EXPECT_EQ(TrackerMisalignment(2e-3).largestSigma(), 2e-3);
}

}  // namespace
}  // namespace sightline::core
