#include "sightline/ros/outputs/track_outputs_component.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <diagnostic_msgs/DiagnosticStatus.h>

#include "sightline/ros/messages/conversions.h"
#include "sightline/ros/outputs/track_outputs_health.h"

#include "support/diagnostics.h"
#include "support/output_tracks.h"

namespace {

namespace core = sightline::core;
using diagnostic_msgs::DiagnosticStatus;
using sightline::PositionTrackArray;
using sightline::TrackArray;
using sightline::test::directionTrack;
using sightline::test::positionTrack;
using sightline::test::stamped;
using sightline::test::valueOf;
using sightline_ros::OutputResult;
using sightline_ros::TrackOutputsComponent;
using sightline_ros::TrackOutputsHealth;
using sightline_ros::TrackOutputsParams;

TrackArray directionAt(double t) {
  auto message = stamped<TrackArray>(ros::Time(t), "platform_enu");
  message.tracks = {directionTrack(1, 0.1, 0.2)};
  return message;
}

PositionTrackArray positionsAt(double t, const std::vector<std::uint32_t>& ids,
                               const std::string& frame = "world") {
  auto message = stamped<PositionTrackArray>(ros::Time(t), frame);
  for (const std::uint32_t id : ids)
    message.tracks.push_back(positionTrack(id, {t, 0.0, 1.0}, {1.0, 0.0, 0.0}));
  return message;
}

std::string kindsOf(const OutputResult& result) {
  std::string kinds;
  for (const core::Refusal& refusal : result.refusals) kinds += refusal.kind + " ";
  return kinds;
}

TEST(TrackOutputsComponent, TransformsAreDueOncePerStampAndInterval) {
  TrackOutputsParams params;
  params.tf_interval = 0.05;
  TrackOutputsComponent component(params);
  EXPECT_TRUE(component.onTracks(directionAt(100.0)).sends_transforms);
  EXPECT_FALSE(component.onTracks(directionAt(100.0)).sends_transforms);
  EXPECT_FALSE(component.onTracks(directionAt(100.04)).sends_transforms);
  EXPECT_TRUE(component.onTracks(directionAt(100.06)).sends_transforms);
  params.tf_interval = 0.0;
  TrackOutputsComponent always(params);
  EXPECT_TRUE(always.onTracks(directionAt(100.0)).sends_transforms);
  const OutputResult again = always.onTracks(directionAt(100.0));
  EXPECT_FALSE(again.sends_transforms) << "one stamp twice is a fault to tf";
  EXPECT_TRUE(again.tracks);
}

TEST(TrackOutputsComponent, MessagesThatAreLateOrHaveNoStampOrFrameAreRefused) {
  TrackOutputsComponent component{TrackOutputsParams()};
  EXPECT_EQ(kindsOf(component.onTracks(directionAt(100.0))), "");
  const OutputResult late = component.onTracks(directionAt(99.5));
  EXPECT_EQ(kindsOf(late), "late ");
  EXPECT_FALSE(late.tracks);
  EXPECT_EQ(kindsOf(component.onTracks(directionAt(0.0))), "invalid ");
  TrackArray without_frame = directionAt(101.0);
  without_frame.header.frame_id.clear();
  EXPECT_EQ(kindsOf(component.onTracks(without_frame)), "invalid ");
}

TEST(TrackOutputsComponent, PathsAreBoundedInTimeAndEndWithTheirTrack) {
  TrackOutputsParams params;
  params.path_seconds = 2.0;
  params.path_interval = 0.1;
  TrackOutputsComponent component(params);
  std::size_t grown = 0;
  for (int i = 0; i <= 1000; ++i)
    grown += component.onTracks(positionsAt(100.0 + 0.01 * i, {4, 7})).grown.size();
  EXPECT_NEAR(static_cast<double>(grown), 202.0, 10.0) << "ten a second of each";
  const auto path = component.pathOf(4);
  EXPECT_EQ(path.header.frame_id, "world");
  EXPECT_GE(path.poses.size(), 18u);
  EXPECT_LE(path.poses.size(), 21u);
  EXPECT_EQ(path.header.stamp, path.poses.back().header.stamp);
  EXPECT_LT((path.poses.back().header.stamp - path.poses.front().header.stamp).toSec(), 2.0 + 1e-6);
  EXPECT_EQ(path.poses.back().pose.position.x, path.poses.back().header.stamp.toSec());
  component.onTracks(positionsAt(110.5, {7}));
  EXPECT_TRUE(component.pathOf(4).poses.empty());
  EXPECT_FALSE(component.pathOf(7).poses.empty());
}

TEST(TrackOutputsComponent, PathsBeginAnewWithTimeAndFrame) {
  TrackOutputsComponent component{TrackOutputsParams()};
  component.onTracks(positionsAt(100.0, {4}));
  component.onTracks(positionsAt(101.0, {4}));
  EXPECT_EQ(component.pathOf(4).poses.size(), 2u);
  component.onTracks(positionsAt(102.0, {4}, "map"));
  EXPECT_EQ(component.pathOf(4).poses.size(), 1u);
  const OutputResult looped = component.onTracks(positionsAt(50.0, {4}, "map"));
  EXPECT_TRUE(looped.tracks);
  EXPECT_TRUE(looped.sends_transforms);
  EXPECT_EQ(looped.notice, "the stamps of the tracks went back by 52 s: begins anew");
  EXPECT_EQ(component.pathOf(4).poses.size(), 1u);
}

TEST(TrackOutputsHealth, SaysSilenceWhatIsLeftOutAndWhatTheHeadDoes) {
  TrackOutputsComponent component{TrackOutputsParams()};
  TrackOutputsHealth health("/fusion/tracks", 2.0);
  const auto at = [](double t) { return sightline_ros::toCore(ros::Time(t)); };
  diagnostic_updater::DiagnosticStatusWrapper before, after, silent;
  health.diagnose(at(100.0), nullptr, before);
  EXPECT_EQ(before.message, "nothing yet on /fusion/tracks");
  EXPECT_EQ(valueOf(before, "head"), "nobody listens");

  TrackArray message = directionAt(100.0);
  message.tracks.push_back(directionTrack(2, 40.0, 0.2));
  const auto lines = health.note(component.onTracks(message), at(100.0));
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_NE(lines[0].find("track 2: direction (40, 0.2) rad is off the sphere"), std::string::npos)
      << lines[0];
  EXPECT_TRUE(component.head().aim(at(100.0), Eigen::Isometry3d::Identity()));
  health.diagnose(at(100.1), &component.head(), after);
  EXPECT_EQ(after.level, DiagnosticStatus::WARN);
  EXPECT_EQ(valueOf(after, "refused, invalid"), "1");
  EXPECT_EQ(valueOf(after, "tracks"), "1");
  EXPECT_EQ(valueOf(after, "head"), "follows track 1");

  component.head().choose(9);
  EXPECT_FALSE(component.head().aim(at(103.0), Eigen::Isometry3d::Identity()));
  health.diagnose(at(103.0), &component.head(), silent);
  EXPECT_EQ(silent.level, DiagnosticStatus::WARN);
  EXPECT_NE(silent.message.find("no tracks on /fusion/tracks for 3 s"), std::string::npos) << silent.message;
  EXPECT_NE(silent.message.find("track 9, which is chosen, is not there"), std::string::npos)
      << silent.message;
}

}  // namespace
