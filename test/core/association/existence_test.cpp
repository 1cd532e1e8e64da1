#include "sightline/core/association/existence.h"

#include <cmath>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>

namespace sightline::core {
namespace {

PresenceParams nothingHappens() {
  return {1e30, 1e30, 1e30, 1e30};
}

TEST(Existence, GrowsByTheEvidenceOfEachScan) {
  // Odds 0.01 of a target; evidence 50, then 4: odds 2, so 2/3.
  Existence existence(0.01);
  EXPECT_NEAR(existence.probability(), 0.01 / 1.01, 1e-12);
  existence.weigh(50.0);
  existence.weigh(4.0);
  EXPECT_NEAR(existence.probability(), 2.0 / 3.0, 1e-9);
  EXPECT_NEAR(existence.gain(), 200.0, 1e-6);
}

TEST(Existence, FallsByEveryMissWithNothingHidden) {
  Existence existence(1.0);
  existence.pass(0.1, nothingHappens());
  existence.weigh(0.1);
  existence.weigh(0.1);
  EXPECT_NEAR(existence.probability(), 0.01 / 1.01, 1e-9);
}

TEST(Existence, TargetsLeaveAtTheirRate) {
  PresenceParams presence = nothingHappens();
  presence.mean_life = 100.0;
  Existence existence(1e12);
  for (int k = 0; k < 1000; ++k) existence.pass(0.1, presence);
  EXPECT_NEAR(existence.probability(), std::exp(-1.0), 1e-9);
}

TEST(Existence, TakesSteadyWatchingForTheSameAtEveryRate) {
  // Nothing seen, time goes by in other steps: the same in the end.
  PresenceParams presence;
  Existence coarse(1e6), fine(1e6);
  for (int k = 0; k < 10; ++k) coarse.pass(0.01, presence);
  for (int k = 0; k < 1000; ++k) fine.pass(0.0001, presence);
  EXPECT_NEAR(coarse.probability(), fine.probability(), 1e-6);
}

TEST(Existence, AHiddenTargetIsHalfForgottenAndKnownAgainAtOnce) {
  const PresenceParams presence;
  Existence existence(1.0);
  for (int k = 0; k < 100; ++k) {
    existence.pass(0.033, presence);
    existence.weigh(500.0);
  }
  int misses = 0;
  for (; existence.probability() > 0.5; ++misses) {
    existence.pass(0.033, presence);
    existence.weigh(0.1);
  }
  EXPECT_GE(misses, 3);
  EXPECT_LE(misses, 6);
  for (int k = 0; k < 10; ++k) {
    existence.pass(0.033, presence);
    existence.weigh(0.1);
  }
  EXPECT_GT(existence.probability(), 0.15);  // it may be hidden
  existence.pass(0.033, presence);
  existence.weigh(500.0);
  EXPECT_GT(existence.probability(), 0.8);
}

TEST(Existence, OneScanIsNeverEverything) {
  Existence existence(1e-6);
  existence.weigh(1e300);
  EXPECT_LT(existence.probability(), 0.02);
  Existence sure(1e6);
  sure.weigh(0.0);
  EXPECT_GT(sure.probability(), 0.9);
}

TEST(Existence, ClutterIsBelievedNoMoreOftenThanTheOddsAllow) {
  // Tracks of clutter alone: evidence x of a scan with the mean 1, here 0.1 + exp(g - 1/2) - 0.1 ... drawn as
  // exp(s g - s^2/2) of a standard Gaussian g. Of many, at most start odds / asked odds reach those: Ville.
  const double start = 0.05, asked = 1.0;
  std::mt19937_64 random(3);
  std::normal_distribution<double> gauss;
  const int tracks = 20000;
  int believed = 0;
  for (int n = 0; n < tracks; ++n) {
    Existence existence(start);
    for (int k = 0; k < 200; ++k) {
      existence.weigh(std::exp(gauss(random) - 0.5));
      if (existence.probability() < asked / (1.0 + asked)) continue;
      ++believed;
      break;
    }
  }
  const double share = static_cast<double>(believed) / tracks;
  const double band = 3.0 * std::sqrt(start / tracks);
  EXPECT_LE(share, start / asked + band);
  EXPECT_GE(share, 0.3 * start / asked);  // and it is a test, not a wall
}

TEST(Existence, RefusesOddsThatAreNone) {
  EXPECT_THROW(Existence(0.0), std::invalid_argument);
  EXPECT_THROW(Existence(-1.0), std::invalid_argument);
  EXPECT_THROW(Existence(std::nan("")), std::invalid_argument);
}

}  // namespace
}  // namespace sightline::core
