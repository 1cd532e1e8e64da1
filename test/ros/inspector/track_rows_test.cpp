#include "sightline/ros/inspector/track_rows.h"

#include <cmath>

#include <gtest/gtest.h>

#include "support/inspected.h"

namespace {

using namespace sightline_ros;
using sightline::test::positionTrack;
using sightline::test::stamped;
using sightline::test::tracksOf;

TEST(TrackRows, ADirectionHasItsLargestSigmaInRadians) {
  auto message = tracksOf("imm_1", 10.0, {7}, 1e-3);
  message->tracks[0].covariance[5] = 9e-6;  // elevation
  const TrackRow row = rowOf("/a/tracks", *message, 0);
  EXPECT_EQ(row.key, (TrackKey{"/a/tracks", 7}));
  EXPECT_EQ(row.tracker, "imm_1");
  EXPECT_NEAR(row.sigma, 3e-3, 1e-9);
  EXPECT_NEAR(row.unseen, 0.25, 1e-9);
  EXPECT_EQ(sigmaText(row.sigma, row.kind), "3 mrad");
  EXPECT_NEAR(row.place.norm(), 1.0, 1e-12);
}

TEST(TrackRows, APositionHasItsLargestSigmaInMetres) {
  auto message = stamped<sightline::PositionTrackArray>(ros::Time(5.0), "world");
  message.tracks.push_back(positionTrack(3, {1.0, 2.0, 3.0}, {0.0, 0.0, 0.0}, 0.5));
  message.tracks[0].covariance[7] = 4.0;  // y
  const TrackRow row = rowOf("/positions/tracks", message, 0);
  EXPECT_EQ(row.kind, TrackKind::position);
  EXPECT_EQ(sigmaText(row.sigma, row.kind), "2 m");
  EXPECT_EQ(row.place, Eigen::Vector3d(1.0, 2.0, 3.0));
  EXPECT_TRUE(std::isnan(row.unseen)) << "it has no last sighting";
}

TEST(TrackRows, WhatIsNotFiniteIsADash) {
  auto message = stamped<sightline::PositionTrackArray>(ros::Time(5.0), "world");
  message.tracks.push_back(positionTrack(3, {1.0, 2.0, 3.0}, {0.0, 0.0, 0.0}, std::nan("")));
  const TrackRow row = rowOf("/positions/tracks", message, 0);
  EXPECT_EQ(sigmaText(row.sigma, row.kind), "-");
}

TEST(TrackRows, EveryWordOfTheFilterMustBeInTheRow) {
  TrackRow row = rowOf("/a/tracks", *tracksOf("tracking", 10.0, {12}), 0);
  EXPECT_TRUE(matches(row, ""));
  EXPECT_TRUE(matches(row, "  CONFIRMED right "));
  EXPECT_TRUE(matches(row, "local track 12"));
  EXPECT_FALSE(matches(row, "confirmed global"));
  row.silence = 3.25;
  EXPECT_EQ(stateText(row), "silent 3.2 s");
  EXPECT_FALSE(matches(row, "confirmed"));
}

}  // namespace
