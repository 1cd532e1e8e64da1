#include "sightline/core/evaluation/appearances.h"

#include <cmath>

#include <gtest/gtest.h>

using namespace sightline::core;

namespace {

/// Ten reports a tenth of a second apart: the first `without` have no track, the others `track`.
void observe(Appearances& appearances, std::uint32_t target, int without, std::uint32_t track) {
  for (int i = 0; i < 10; ++i)
    appearances.observe(target, 0.1 * i, i < without ? std::nullopt : std::optional(track));
}

TEST(Appearances, DelaysAreThoseWorkedByHand) {
  Appearances appearances;
  observe(appearances, 1, 1, 11);   // first believed 0.1 s after its appearance
  observe(appearances, 2, 3, 12);   // 0.3 s
  observe(appearances, 3, 8, 13);   // 0.8 s
  observe(appearances, 4, 10, 14);  // never
  EXPECT_EQ(appearances.count(), 4u);
  EXPECT_EQ(appearances.neverConfirmed(), 1u);
  EXPECT_NEAR(appearances.medianDelay(), 0.3, 1e-12);
  EXPECT_NEAR(appearances.worstDelay(), 0.8, 1e-12);
  observe(appearances, 5, 5, 15);  // 0.5 s: the median of four is between 0.3 and 0.5
  EXPECT_NEAR(appearances.medianDelay(), 0.4, 1e-12);
}

TEST(Appearances, ATargetThatReturnsAppearsAnew) {
  Appearances appearances;
  observe(appearances, 1, 2, 11);
  appearances.endAll();
  observe(appearances, 1, 10, 12);  // is not found again
  EXPECT_EQ(appearances.count(), 2u);
  EXPECT_EQ(appearances.neverConfirmed(), 1u);
  EXPECT_NEAR(appearances.worstDelay(), 0.2, 1e-12);
}

TEST(Appearances, ALostTrackIsNoSecondDelay) {
  Appearances appearances;
  appearances.observe(1, 0.0, std::nullopt);
  appearances.observe(1, 0.1, 7);
  appearances.observe(1, 0.2, std::nullopt);
  appearances.observe(1, 0.9, 8);
  EXPECT_NEAR(appearances.worstDelay(), 0.1, 1e-12);
}

TEST(Appearances, CompletenessIsThatWorkedByHand) {
  Appearances appearances;
  for (int i = 0; i < 6; ++i) appearances.observe(1, 0.1 * i, 11);  // 6 of 10 reports with track 11,
  for (int i = 0; i < 3; ++i) appearances.observe(1, 0.6, 12);      // 3 with track 12,
  appearances.observe(1, 0.9, std::nullopt);                        // 1 with none
  for (int i = 0; i < 5; ++i) appearances.observe(2, 0.1 * i, std::nullopt);  // 0 of 5
  EXPECT_NEAR(appearances.completeness(), 6.0 / 15.0, 1e-12);
  appearances.endAllBut({2});
  EXPECT_NEAR(appearances.completeness(), 6.0 / 15.0, 1e-12);
  EXPECT_EQ(appearances.count(), 2u);
  // Target 1 comes back with another track for 5 reports: an appearance of its own, all of it held.
  for (int i = 0; i < 5; ++i) appearances.observe(1, 0.1 * i, 13);
  EXPECT_NEAR(appearances.completeness(), 11.0 / 20.0, 1e-12);
}

TEST(Appearances, WithoutAnyNothingIsKnown) {
  const Appearances none;
  EXPECT_TRUE(std::isnan(none.medianDelay()) && std::isnan(none.worstDelay()) &&
              std::isnan(none.completeness()));
  EXPECT_EQ(none.neverConfirmed(), 0u);
}

}  // namespace
