#include "sightline/ros/messages/position_messages.h"

#include <cmath>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "support/times.h"

using sightline::test::at;

namespace {

namespace core = sightline::core;

core::PositionTrack track(std::uint32_t id, core::TrackStatus status) {
  core::PositionTrack it;
  it.id = id;
  it.status = status;
  it.position = {1.0, 2.0, 3.0};
  it.velocity = {0.0, -4.0, 0.0};
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) it.covariance(i, j) = 10.0 * i + j;  // to see the order
  it.existence = 0.75;
  it.last_sighting = at(9.5);
  it.parallax = 0.25;
  it.sources = {"a/1", "b/2"};
  return it;
}

core::PositionOutput output() {
  core::PositionOutput it;
  it.tracks.time = at(10.0);
  it.tracks.tracks = {track(4, core::TrackStatus::confirmed), track(7, core::TrackStatus::coasting)};
  it.report.time = at(9.75);
  it.report.refused.push_back({{"a/1", "b/3"}, {5.0, 6.0, 7.0}, 1.5, -2.5, {"ghost", "of others"}});
  it.report.unlocated.push_back({"c/9", {"one station only", "no partner"}});
  it.report.stations.push_back({"a", "eye", 1.25, 2.5, std::nullopt});
  it.report.stations.push_back(
      {"b", "ear", 1.0, 3.0, {{0.04, 0.002, {1e-3, 2e-3, 3e-3}, {1e-4, 2e-4, 3e-4}}}});
  it.report.is_complete = false;
  return it;
}

TEST(PositionMessages, TracksComeBackAsTheyWere) {
  const auto message = sightline_ros::toMessage(output().tracks, "positions", "map");
  EXPECT_EQ(message.header.frame_id, "map");
  EXPECT_EQ(message.header.stamp, ros::Time(10.0));
  EXPECT_EQ(message.tracker, "positions");
  ASSERT_EQ(message.tracks.size(), 2u);
  EXPECT_EQ(message.tracks[0].covariance[1], 1.0);   // of x and y: row-major
  EXPECT_EQ(message.tracks[0].covariance[6], 10.0);  // of y and x
  const auto back = sightline_ros::toCore(message);
  EXPECT_EQ(back.time, at(10.0));
  ASSERT_EQ(back.tracks.size(), 2u);
  const core::PositionTrack expected = track(7, core::TrackStatus::coasting);
  EXPECT_EQ(back.tracks[1].id, expected.id);
  EXPECT_EQ(back.tracks[1].status, expected.status);
  EXPECT_EQ(back.tracks[1].position, expected.position);
  EXPECT_EQ(back.tracks[1].velocity, expected.velocity);
  EXPECT_EQ(back.tracks[1].covariance, expected.covariance);
  EXPECT_EQ(back.tracks[1].existence, expected.existence);
  EXPECT_EQ(back.tracks[1].last_sighting, expected.last_sighting);
  EXPECT_EQ(back.tracks[1].parallax, expected.parallax);
  EXPECT_EQ(back.tracks[1].sources, expected.sources);
}

TEST(PositionMessages, ReportSaysWhoSupportsWhatAndWhatWasRefusedAndWhy) {
  const auto report = sightline_ros::toMessage(output(), "map");
  EXPECT_EQ(report.header.stamp, ros::Time(10.0));
  EXPECT_EQ(report.header.frame_id, "map");
  EXPECT_EQ(report.decided, ros::Time(9.75));
  EXPECT_FALSE(report.complete);
  ASSERT_EQ(report.positions.size(), 2u);
  EXPECT_EQ(report.positions[1].id, 7u);
  EXPECT_EQ(report.positions[1].sources, (std::vector<std::string>{"a/1", "b/2"}));
  ASSERT_EQ(report.refused.size(), 1u);
  EXPECT_EQ(report.refused[0].sources, (std::vector<std::string>{"a/1", "b/3"}));
  EXPECT_EQ(report.refused[0].position.z, 7.0);
  EXPECT_EQ(report.refused[0].score, 1.5);
  EXPECT_EQ(report.refused[0].margin, -2.5);
  EXPECT_EQ(report.refused[0].kind, "ghost");
  EXPECT_EQ(report.refused[0].reason, "ghost: of others");
  ASSERT_EQ(report.unlocated.size(), 1u);
  EXPECT_EQ(report.unlocated[0].source, "c/9");
  EXPECT_EQ(report.unlocated[0].kind, "one station only");
  ASSERT_EQ(report.stations.size(), 2u);
  EXPECT_EQ(report.stations[0].tracker, "a");
  EXPECT_EQ(report.stations[0].sensor, "eye");
  EXPECT_EQ(report.stations[0].slow_scale, 1.25);
  EXPECT_EQ(report.stations[0].time_constant, 2.5);
  EXPECT_TRUE(std::isnan(report.stations[0].clock_behind));
  EXPECT_TRUE(std::isnan(report.stations[0].rotation_sigma[2]));
  EXPECT_EQ(report.stations[1].clock_behind, -0.04) << "later stamps are of a clock that is ahead";
  EXPECT_EQ(report.stations[1].clock_sigma, 0.002);
  EXPECT_EQ(report.stations[1].rotation[1], 2e-3);
  EXPECT_EQ(report.stations[1].rotation_sigma[2], 3e-4);
}

TEST(PositionMessages, PosesAreThoseOfConfirmedTracksAndLookAlongTheVelocity) {
  auto tracks = sightline_ros::toMessage(output().tracks, "positions", "map");
  tracks.tracks[0].velocity.z = 4.0;
  const auto poses = sightline_ros::posesOf(tracks);
  EXPECT_EQ(poses.header.frame_id, "map");
  EXPECT_EQ(poses.header.stamp, ros::Time(10.0));
  ASSERT_EQ(poses.poses.size(), 1u);
  EXPECT_EQ(poses.poses[0].position.y, 2.0);
  const auto& q = poses.poses[0].orientation;
  const Eigen::Matrix3d turn = Eigen::Quaterniond(q.w, q.x, q.y, q.z).toRotationMatrix();
  EXPECT_LT((turn.col(0) - Eigen::Vector3d(0.0, -1.0, 1.0).normalized()).norm(), 1e-12);
  EXPECT_NEAR(turn.col(1).z(), 0.0, 1e-12);
  tracks.tracks[0].velocity = geometry_msgs::Vector3();
  EXPECT_EQ(sightline_ros::posesOf(tracks).poses[0].orientation.w, 1.0);
}

}  // namespace
