// Replay of recordings whose sensors stand apart.
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include <ros/serialization.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <sightline/PositionReport.h>
#include <sightline/PositionTrackArray.h>
#include <sightline/TrackArray.h>
#include <tf2_msgs/TFMessage.h>

#include "sightline/ros/messages/position_messages.h"
#include "sightline/ros/params/param_reader.h"
#include "sightline/ros/recordings/replay.h"

#include "support/bytes.h"
#include "support/scratch_folder.h"
#include "support/seen_stations.h"

namespace {

namespace core = sightline::core;
using sightline::PositionTrackArray;
using sightline::test::bytesOf;
using sightline::test::SeenStation;
using sightline::test::targetAt;
using sightline_ros::replay;
using sightline_ros::ReplaySettings;
using sightline_ros::ReplaySummary;

constexpr double kFieldStart = 100.0, kFieldDuration = 6.0;  // [s]

/// Two stations, and a third sensor a centimetre beside the first where `with_third`, which the target's
/// distance makes less than their sigma; scans come with a latency of up to `latency` [s]. A station in the
/// north that sees nothing where `with_north`: it looks a radian past the target.
void record(const std::string& file, bool with_third = false, double latency = 0.0, bool with_north = false) {
  std::vector<SeenStation> stations{{"west", {0.0, 0.0, 2.0}, 0.4, 1}, {"east", {80.0, 0.0, 1.0}, 2.5, 2}};
  if (with_third) stations.emplace_back("west_2", Eigen::Vector3d(0.01, 0.0, 2.0), 0.1, 3);
  if (with_north) stations.emplace_back("north", Eigen::Vector3d(40.0, 90.0, 0.0), -0.6, 4);
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> later(0.0, latency);
  rosbag::Bag bag(file, rosbag::bagmode::Write);
  tf2_msgs::TFMessage frames;
  for (const SeenStation& station : stations)
    frames.transforms.push_back(station.transform(ros::Time(kFieldStart), "world"));
  bag.write("/tf_static", ros::Time(kFieldStart), frames);
  for (int i = 0; 0.04 * i < kFieldDuration; ++i) {
    for (SeenStation& station : stations) {
      const ros::Time stamp(kFieldStart + 0.04 * i);
      sightline::SightingArray scan = station.scan(stamp, targetAt(0.04 * i));
      if (station.name() == "north") scan.sightings.clear();
      bag.write("/" + station.name(), stamp + ros::Duration(later(random)), scan);
    }
  }
}

/// Messages of a topic.
template <typename Message>
std::vector<Message> messagesOn(const std::string& topic, const std::string& file) {
  std::vector<Message> messages;
  const rosbag::Bag bag(file);
  rosbag::View view(bag, rosbag::TopicQuery(topic));
  for (const rosbag::MessageInstance& instance : view)
    messages.push_back(*instance.template instantiate<Message>());
  return messages;
}

TEST(PositionReplay, SensorsThatStandApartGivePositionsAndNoFusedDirections) {
  const ScratchFolder folder;
  record(folder.file("in.bag"));
  const ReplaySummary summary = replay(folder.file("in.bag"), folder.file("out.bag"), {});
  EXPECT_TRUE(summary.drops.empty()) << summary.drops.begin()->first;
  ASSERT_EQ(summary.notices.size(), 1u);
  EXPECT_NE(summary.notices[0].find("2 stations stand up to 80"), std::string::npos) << summary.notices[0];

  const auto arrays = messagesOn<PositionTrackArray>("/positions/tracks", folder.file("out.bag"));
  EXPECT_EQ(arrays.size(), 300u);  // one for each scan
  EXPECT_EQ(messagesOn<sightline::PositionReport>("/positions/report", folder.file("out.bag")).size(), 300u);
  EXPECT_TRUE(messagesOn<sightline::TrackArray>("/fusion/tracks", folder.file("out.bag")).empty());
  EXPECT_TRUE(messagesOn<sightline::TrackArray>("/sensor_fusion/tracks", folder.file("out.bag")).empty());
  const auto local = messagesOn<sightline::TrackArray>("/sensors/eye_of_west/tracks", folder.file("out.bag"));
  ASSERT_EQ(local.size(), 150u);
  EXPECT_EQ(local[0].header.frame_id, "west");

  ASSERT_EQ(arrays.back().tracks.size(), 1u);
  EXPECT_EQ(arrays.back().header.frame_id, "world");
  double worst = 0.0;
  int count = 0;
  for (const PositionTrackArray& array : arrays) {
    const double t = array.header.stamp.toSec() - kFieldStart;
    if (t < 2.0) continue;
    ASSERT_EQ(array.tracks.size(), 1u) << t;
    EXPECT_EQ(array.tracks[0].id, arrays.back().tracks[0].id);
    worst = std::max(worst, (sightline_ros::toCore(array.tracks[0]).position - targetAt(t)).norm());
    ++count;
  }
  EXPECT_GE(count, 190);
  EXPECT_LT(worst, 0.3);
}

TEST(PositionReplay, FieldsOfViewOfStationsAreUsed) {
  const ScratchFolder folder;
  record(folder.file("in.bag"), false, 0.0, true);
  const auto existenceWith = [&folder](const std::string& half_width) {
    ReplaySettings settings;
    settings.config = folder.write("config.yaml",
                                   "position_tracker: {fields_of_view: [{tracker: eye of north, "
                                   "azimuth_half_width: " +
                                       half_width + ", elevation_half_width: 0.5}]}\n");
    replay(folder.file("in.bag"), folder.file("out.bag"), settings);
    const auto arrays = messagesOn<PositionTrackArray>("/positions/tracks", folder.file("out.bag"));
    return arrays.empty() || arrays.back().tracks.size() != 1 ? -1.0 : arrays.back().tracks[0].existence;
  };
  const double outside = existenceWith("0.05"), inside = existenceWith("1.5");
  EXPECT_GT(inside, 0.0);
  EXPECT_GT(outside, inside);
}

TEST(PositionReplay, OrderOfArrivalChangesNoByte) {
  const ScratchFolder folder;
  record(folder.file("a.bag"));
  record(folder.file("b.bag"), false, 0.3);
  replay(folder.file("a.bag"), folder.file("a_out.bag"), {});
  replay(folder.file("b.bag"), folder.file("b_out.bag"), {});
  const auto a = messagesOn<PositionTrackArray>("/positions/tracks", folder.file("a_out.bag"));
  const auto b = messagesOn<PositionTrackArray>("/positions/tracks", folder.file("b_out.bag"));
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(bytesOf(a[i]), bytesOf(b[i])) << i;
}

TEST(PositionReplay, SensorsAtOnePlaceAreOneStation) {
  const ScratchFolder folder;
  record(folder.file("in.bag"), true);
  replay(folder.file("in.bag"), folder.file("out.bag"), {});
  const auto arrays = messagesOn<PositionTrackArray>("/positions/tracks", folder.file("out.bag"));
  ASSERT_FALSE(arrays.empty());
  ASSERT_EQ(arrays.back().tracks.size(), 1u);
  EXPECT_EQ(arrays.back().tracks[0].sources.size(), 2u);
  EXPECT_LT((sightline_ros::toCore(arrays.back().tracks[0]).position -
             targetAt(arrays.back().header.stamp.toSec() - kFieldStart))
                .norm(),
            0.3);
  const auto of_station =
      messagesOn<sightline::TrackArray>("/stations/eye_of_west/tracks", folder.file("out.bag"));
  ASSERT_FALSE(of_station.empty());
  EXPECT_EQ(of_station.back().tracker, "station eye of west");
  EXPECT_EQ(of_station.back().tracks.at(0).sources.size(), 2u);
}

TEST(PositionReplay, CanBeForbiddenAndItsParametersAreRead) {
  const ScratchFolder folder;
  record(folder.file("in.bag"));
  ReplaySettings settings;
  settings.positions = false;
  replay(folder.file("in.bag"), folder.file("out.bag"), settings);
  EXPECT_TRUE(messagesOn<PositionTrackArray>("/positions/tracks", folder.file("out.bag")).empty());

  settings.positions = std::nullopt;
  settings.config =
      folder.write("config.yaml", "position_tracker: {tracker_name: mine}\nsensor_fusion: {}\n");
  replay(folder.file("in.bag"), folder.file("out.bag"), settings);
  const auto arrays = messagesOn<PositionTrackArray>("/positions/tracks", folder.file("out.bag"));
  ASSERT_FALSE(arrays.empty());
  EXPECT_EQ(arrays.back().tracker, "mine");
  settings.config = folder.write("wrong.yaml", "position_tracker: {max_lagg: 1.0}\n");
  EXPECT_THROW(replay(folder.file("in.bag"), folder.file("out.bag"), settings), sightline_ros::ParamError);
}

TEST(PositionReplay, SmoothedPositionsAreTheSameTracksNearerToTheTarget) {
  const ScratchFolder folder;
  record(folder.file("in.bag"), false, 0.2);
  ReplaySettings settings;
  settings.smooth = true;
  replay(folder.file("in.bag"), folder.file("out.bag"), settings);
  replay(folder.file("in.bag"), folder.file("again.bag"), settings);
  const auto tracks = messagesOn<PositionTrackArray>("/positions/tracks", folder.file("out.bag"));
  const auto smoothed = messagesOn<PositionTrackArray>("/positions/tracks_smoothed", folder.file("out.bag"));
  const auto again = messagesOn<PositionTrackArray>("/positions/tracks_smoothed", folder.file("again.bag"));
  ASSERT_EQ(smoothed.size(), tracks.size());
  ASSERT_EQ(smoothed.size(), again.size());
  double of_filter = 0.0, of_smoother = 0.0;
  int count = 0;
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    EXPECT_EQ(bytesOf(smoothed[i]), bytesOf(again[i])) << i;
    EXPECT_EQ(smoothed[i].header.stamp, tracks[i].header.stamp);
    ASSERT_EQ(smoothed[i].tracks.size(), tracks[i].tracks.size());
    if (tracks[i].tracks.empty()) continue;
    EXPECT_EQ(smoothed[i].tracks[0].id, tracks[i].tracks[0].id);
    const Eigen::Vector3d truth = targetAt(tracks[i].header.stamp.toSec() - kFieldStart);
    of_filter += (sightline_ros::toCore(tracks[i].tracks[0]).position - truth).squaredNorm();
    of_smoother += (sightline_ros::toCore(smoothed[i].tracks[0]).position - truth).squaredNorm();
    ++count;
  }
  EXPECT_GT(count, 100);
  EXPECT_LT(std::sqrt(of_smoother), 0.8 * std::sqrt(of_filter));
}

}  // namespace
