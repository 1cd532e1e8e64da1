#include "sightline/core/evaluation/track_lives.h"

#include <cmath>

#include <gtest/gtest.h>

using namespace sightline::core;

namespace {

void observe(TrackLives& lives, std::uint32_t track, std::optional<std::uint32_t> target, int times) {
  for (int i = 0; i < times; ++i) lives.observe(track, target);
}

TEST(TrackLives, AreThoseWorkedByHand) {
  TrackLives lives;
  observe(lives, 1, 10, 8);  // 8 of 10 reports on target 10: the most; 1 on 11, 1 on none
  observe(lives, 1, 11, 1);
  observe(lives, 1, std::nullopt, 1);
  observe(lives, 2, 11, 3);  // 3 of 6 on a target, which is half: not false
  observe(lives, 2, std::nullopt, 3);
  observe(lives, 3, 10, 1);  // 1 of 4: false
  observe(lives, 3, std::nullopt, 3);
  observe(lives, 4, std::nullopt, 5);  // never on one: false
  EXPECT_EQ(lives.tracks(), 4u);
  EXPECT_EQ(lives.falseTracks(), 2u);
  EXPECT_NEAR(lives.purity(), (8.0 + 3.0 + 1.0 + 0.0) / (10.0 + 6.0 + 4.0 + 5.0), 1e-12);  // 12 / 25
}

TEST(TrackLives, ATrackOnSeveralTargetsIsNotFalseButImpure) {
  TrackLives lives;
  for (const std::uint32_t target : {1u, 2u, 3u}) observe(lives, 7, target, 2);
  EXPECT_EQ(lives.falseTracks(), 0u);
  EXPECT_NEAR(lives.purity(), 2.0 / 6.0, 1e-12);
}

TEST(TrackLives, AfterARestartTheSameIdIsAnotherTrack) {
  TrackLives lives;
  observe(lives, 1, 5, 9);
  lives.restart();
  observe(lives, 1, std::nullopt, 3);
  EXPECT_EQ(lives.tracks(), 2u);
  EXPECT_EQ(lives.falseTracks(), 1u);
}

TEST(TrackLives, WithoutTracksPurityIsNotKnown) {
  EXPECT_TRUE(std::isnan(TrackLives().purity()));
  EXPECT_EQ(TrackLives().falseTracks(), 0u);
}

}  // namespace
