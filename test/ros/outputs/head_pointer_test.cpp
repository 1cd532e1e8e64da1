#include "sightline/ros/outputs/head_pointer.h"

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "sightline/ros/messages/conversions.h"

#include "support/output_tracks.h"

namespace {

namespace core = sightline::core;
using sightline::PositionTrackArray;
using sightline::TrackArray;
using sightline::test::directionTrack;
using sightline::test::positionTrack;
using sightline::test::stamped;
using sightline_ros::FollowRule;
using sightline_ros::HeadAim;
using sightline_ros::HeadParams;
using sightline_ros::HeadPointer;

const Eigen::Isometry3d kSameFrame = Eigen::Isometry3d::Identity();

core::Time at(double t) {
  return sightline_ros::toCore(ros::Time(t));
}

template <typename Message>
void give(HeadPointer& head, const Message& message) {
  std::vector<core::Refusal> refusals;
  head.onTracks(sightline_ros::outputTracksOf(message, {}, refusals));
}

/// Tracks of these ids at 100 s, whose sigmas are in [rad].
void giveTracks(HeadPointer& head, const std::vector<std::pair<std::uint32_t, double>>& tracks) {
  auto message = stamped<TrackArray>(ros::Time(100.0), "platform_enu");
  for (const auto& [id, sigma] : tracks) message.tracks.push_back(directionTrack(id, 0.1 * id, 0.0, sigma));
  give(head, message);
}

/// The id that it follows at 100 s; 0 = none.
std::uint32_t followedBy(HeadPointer& head) {
  const auto aim = head.aim(at(100.0), kSameFrame);
  return aim ? aim->id : 0;
}

HeadParams following(FollowRule rule, std::uint32_t chosen = 0) {
  HeadParams params;
  params.follow = rule;
  params.chosen = chosen;
  return params;
}

TEST(HeadPointer, BestStaysWithItsTrackUntilAnotherHasHalfItsSigma) {
  HeadPointer head(following(FollowRule::best));
  giveTracks(head, {{1, 3e-3}, {2, 2e-3}});
  EXPECT_EQ(followedBy(head), 2u);
  giveTracks(head, {{1, 1.2e-3}, {2, 2e-3}});
  EXPECT_EQ(followedBy(head), 2u) << "a little better is no reason to turn";
  giveTracks(head, {{1, 0.9e-3}, {2, 2e-3}});
  EXPECT_EQ(followedBy(head), 1u);
  giveTracks(head, {{2, 2e-3}});
  EXPECT_EQ(followedBy(head), 2u) << "when its track ends it takes the next";
}

TEST(HeadPointer, OldestIsTheLowestId) {
  HeadPointer head(following(FollowRule::oldest));
  giveTracks(head, {{7, 1e-3}, {4, 5e-3}});
  EXPECT_EQ(followedBy(head), 4u);
  giveTracks(head, {{7, 1e-3}, {9, 5e-3}});
  EXPECT_EQ(followedBy(head), 7u);
}

TEST(HeadPointer, AChosenTrackThatIsLostLeavesTheHeadWhereItWasAndIsFollowedWhenItIsBack) {
  HeadPointer head(following(FollowRule::best));
  giveTracks(head, {{1, 1e-3}, {2, 5e-3}});
  head.choose(2);
  EXPECT_EQ(followedBy(head), 2u);
  giveTracks(head, {{1, 1e-3}});
  EXPECT_EQ(followedBy(head), 0u);
  EXPECT_EQ(head.words(), "track 2 is lost: the head stays where it was");
  EXPECT_EQ(head.followed(), std::nullopt);
  giveTracks(head, {{1, 1e-3}, {2, 5e-3}});
  EXPECT_EQ(followedBy(head), 2u);
  head.choose(0);
  EXPECT_EQ(followedBy(head), 1u) << "by the rule again";
}

TEST(HeadPointer, ATrackThatIsNotThereIsSaid) {
  HeadPointer head(following(FollowRule::chosen, 5));
  EXPECT_EQ(followedBy(head), 0u);
  EXPECT_EQ(head.words(), "there is no track yet: the head stays where it was");
  giveTracks(head, {{1, 1e-3}});
  EXPECT_EQ(followedBy(head), 0u);
  EXPECT_EQ(head.words(), "track 5, which is chosen, is not there: the head stays where it was");
  giveTracks(head, {{5, 1e-3}});
  EXPECT_EQ(followedBy(head), 5u);
  EXPECT_EQ(head.words(), "follows track 5");

  HeadPointer without(following(FollowRule::chosen));
  giveTracks(without, {{5, 1e-3}});
  EXPECT_EQ(followedBy(without), 0u);
  EXPECT_NE(without.words().find("no track is chosen"), std::string::npos) << without.words();
}

TEST(HeadPointer, AimsWhereTheTrackWillBeAtNowAndTheLead) {
  HeadParams params;
  params.lead = 0.2;
  HeadPointer head(params);
  auto message = stamped<TrackArray>(ros::Time(100.0), "platform_enu");
  message.tracks = {directionTrack(1, 0.3, 0.1)};
  message.tracks[0].azimuth_rate = 0.5;
  message.tracks[0].elevation_rate = -0.1;
  give(head, message);
  const auto aim = head.aim(at(100.1), kSameFrame);
  ASSERT_TRUE(aim);
  EXPECT_EQ(aim->time, at(100.3));
  EXPECT_LT(core::angleBetween(aim->R_head_target.col(0), core::directionOf({0.45, 0.07})), 1e-9);
  EXPECT_NEAR(aim->R_head_target(2, 1), 0.0, 1e-12) << "y level: pan and tilt, no roll";
  EXPECT_GT(aim->sigma, 1e-3);
}

TEST(HeadPointer, ATrackThatIsNotToldAnyMoreIsFollowedForItsPredictionOnly) {
  HeadPointer head{HeadParams()};
  giveTracks(head, {{3, 1e-3}});
  EXPECT_TRUE(head.aim(at(100.9), kSameFrame));
  EXPECT_FALSE(head.aim(at(101.1), kSameFrame));
  EXPECT_EQ(head.words(), "track 3 was told 1.1 s ago (max_prediction 1 s): the head stays where it was");
  EXPECT_FALSE(head.aim(at(90.0), kSameFrame)) << "a stamp ahead of the clock";
}

TEST(HeadPointer, ADirectionThatIsHardlyKnownIsNotFollowed) {
  HeadPointer head{HeadParams()};
  giveTracks(head, {{3, 0.3}});
  EXPECT_EQ(followedBy(head), 0u);
  EXPECT_EQ(head.words(),
            "track 3 is known to 0.3 rad only (max_sigma 0.2 rad): the head stays where it was");
}

TEST(HeadPointer, WithoutTfItStaysAndSaysSo) {
  HeadPointer head{HeadParams()};
  giveTracks(head, {{3, 1e-3}});
  EXPECT_FALSE(head.aim(at(100.0), std::nullopt));
  EXPECT_NE(head.words().find("tf does not lead"), std::string::npos) << head.words();
}

TEST(HeadPointer, APositionIsSeenFromTheFootOfTheHead) {
  HeadPointer head{HeadParams()};
  auto message = stamped<PositionTrackArray>(ros::Time(100.0), "world");
  message.tracks = {positionTrack(1, {30.0, 40.0, 10.0}, {0.0, 10.0, 0.0})};
  give(head, message);
  Eigen::Isometry3d head_tracks = Eigen::Isometry3d::Identity();
  head_tracks.translation() = Eigen::Vector3d(-30.0, 0.0, -10.0);
  const auto aim = head.aim(at(100.5), head_tracks);
  ASSERT_TRUE(aim);
  EXPECT_LT((aim->R_head_target.col(0) - Eigen::Vector3d::UnitY()).norm(), 1e-9);
}

TEST(HeadPointer, ForgetsTracksButNotTheChoice) {
  HeadPointer head(following(FollowRule::best));
  giveTracks(head, {{1, 1e-3}, {2, 5e-3}});
  head.choose(2);
  head.reset();
  EXPECT_EQ(followedBy(head), 0u);
  giveTracks(head, {{1, 1e-3}, {2, 5e-3}});
  EXPECT_EQ(followedBy(head), 2u);
}

}  // namespace
