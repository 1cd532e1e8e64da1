#include "sightline/core/evaluation/continuity.h"

#include <cmath>

#include <gtest/gtest.h>

using namespace sightline::core;

namespace {

TEST(Continuity, CountsABreakWhenTheTargetGoesOnWithoutItsTrack) {
  Continuity continuity;
  continuity.observe(1, 7);
  continuity.observe(1, std::nullopt);
  continuity.observe(1, std::nullopt);
  EXPECT_EQ(continuity.breaks(), 1u);
  EXPECT_EQ(continuity.idSwitches(), 0u);
  EXPECT_FALSE(continuity.trackOf(1));
  continuity.observe(1, 7);  // found again by the same track
  EXPECT_EQ(continuity.breaks(), 1u);
  EXPECT_EQ(continuity.idSwitches(), 0u);
  EXPECT_NEAR(continuity.coverage(), 0.5, 1e-12);
}

TEST(Continuity, SaysWhatChanged) {
  Continuity continuity;
  EXPECT_FALSE(continuity.observe(1, 7).switched);
  EXPECT_TRUE(continuity.observe(1, std::nullopt).lost);
  EXPECT_FALSE(continuity.observe(1, std::nullopt).lost);  // said once
  EXPECT_TRUE(continuity.observe(1, 8).switched);
  EXPECT_FALSE(continuity.observe(1, 8).switched);
}

TEST(Continuity, CountsASwitchAtOnceAndAfterABreak) {
  Continuity continuity;
  continuity.observe(1, 7);
  continuity.observe(1, 8);
  EXPECT_EQ(continuity.idSwitches(), 1u);
  EXPECT_EQ(continuity.breaks(), 0u);
  continuity.observe(1, std::nullopt);
  continuity.observe(1, 9);
  EXPECT_EQ(continuity.idSwitches(), 2u);
  EXPECT_EQ(continuity.breaks(), 1u);
}

TEST(Continuity, ATargetNotYetFoundIsNoBreak) {
  Continuity continuity;
  continuity.observe(1, std::nullopt);
  continuity.observe(1, 3);
  EXPECT_EQ(continuity.breaks(), 0u);
  EXPECT_EQ(continuity.idSwitches(), 0u);
  EXPECT_EQ(continuity.trackOf(1), 3u);
}

TEST(Continuity, ATargetThatLeavesTakesItsTrackWithIt) {
  Continuity continuity;
  continuity.observe(1, 3);
  continuity.observe(2, 4);
  continuity.forgetAllBut({2});
  continuity.observe(1, std::nullopt);
  continuity.observe(1, 5);
  EXPECT_EQ(continuity.breaks(), 0u);
  EXPECT_EQ(continuity.idSwitches(), 0u);
  EXPECT_EQ(continuity.trackOf(2), 4u);
}

TEST(Continuity, TwoTargetsThatExchangeTheirTracksAreTwoSwitches) {
  Continuity continuity;
  continuity.observe(1, 3);
  continuity.observe(2, 4);
  continuity.observe(1, 4);
  continuity.observe(2, 3);
  EXPECT_EQ(continuity.idSwitches(), 2u);
}

TEST(Continuity, WithoutObservationsCoverageIsNotKnown) {
  EXPECT_TRUE(std::isnan(Continuity().coverage()));
}

}  // namespace
