#include "sightline/ros/inspector/inspector_feed.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <std_srvs/Trigger.h>
#include <string>

#include <gtest/gtest.h>

#include <ros/ros.h>
#include <sightline/TrackSelection.h>

#include "support/inspected.h"
#include "support/received.h"
#include "support/waiting.h"

namespace {

using sightline::test::tracksOf;
using sightline_ros::InspectorFeed;
using sightline_ros::InspectorModel;
using sightline_ros::TrackKey;

std::size_t silentRowsOf(InspectorFeed& feed) {
  return feed.with([](const InspectorModel& model) {
    const auto rows = model.rows();
    return static_cast<std::size_t>(
        std::count_if(rows.begin(), rows.end(), [](const auto& row) { return row.silence > 0.0; }));
  });
}

std::size_t rowsOf(InspectorFeed& feed) {
  return feed.with([](const InspectorModel& model) { return model.rows().size(); });
}

TEST(InspectorFeed, FindsTopicsThatComeGoAndComeAgain) {
  ros::NodeHandle nh;
  InspectorFeed feed;
  for (int life = 0; life < 2; ++life) {
    ros::Publisher tracks = nh.advertise<sightline::TrackArray>("/a/tracks", 10);
    ASSERT_TRUE(eventually([&] { return rowsOf(feed) == 2u && silentRowsOf(feed) == 0u; },
                           [&] {
                             tracks.publish(*tracksOf("a", ros::Time::now().toSec(), {1, 2}));
                           }))
        << "in life " << life;
    tracks.shutdown();
    ASSERT_TRUE(eventually([&] { return silentRowsOf(feed) == 2u; }));
  }
}

TEST(InspectorFeed, TheTruthIsNoTrack) {
  ros::NodeHandle nh;
  InspectorFeed feed;
  ros::Publisher truth = nh.advertise<sightline::TrackArray>("/truth", 10);
  ros::Publisher tracks = nh.advertise<sightline::TrackArray>("/b/tracks", 10);
  auto true_ones = tracksOf("truth", 1.0, {7, 8, 9});
  true_ones->estimator = "truth";
  ASSERT_TRUE(eventually([&] { return rowsOf(feed) > 0u && truth.getNumSubscribers() > 0; },
                         [&] {
                           truth.publish(*true_ones);
                           tracks.publish(*tracksOf("b", ros::Time::now().toSec(), {1}));
                         }));
  EXPECT_EQ(rowsOf(feed), 1u);
}

TEST(InspectorFeed, TellsDisplaysWhichTrackIsLookedAt) {
  ros::NodeHandle nh;
  InspectorFeed feed;
  feed.announce(TrackKey{"/a/tracks", 3}, true);
  std::optional<sightline::TrackSelection> heard;
  const ros::Subscriber listener = nh.subscribe<sightline::TrackSelection>(
      "/display/selection", 1, [&](const sightline::TrackSelection::ConstPtr& message) { heard = *message; });
  ASSERT_TRUE(eventually([&] { return heard.has_value(); })) << "it is latched";
  EXPECT_EQ(heard->topic, "/a/tracks");
  EXPECT_EQ(heard->track, 3u);
  EXPECT_TRUE(heard->alone);
  heard.reset();
  feed.announce(std::nullopt, true);
  ASSERT_TRUE(eventually([&] { return heard.has_value(); }));
  EXPECT_EQ(heard->track, 0u);
  EXPECT_FALSE(heard->alone);
}

TEST(InspectorFeed, SavingSaysWhereTheBagIsOrWhyThereIsNone) {
  ros::NodeHandle nh;
  InspectorFeed feed("/recorder/save");
  feed.recorder().start();
  ASSERT_TRUE(eventually([&] { return !feed.recorder().isUnderWay(); }));
  EXPECT_EQ(feed.recorder().words(),
            "not saved: no flight recorder at /recorder/save (roslaunch sightline flight_recorder.launch)");

  bool can_save = true;
  const auto save = [&can_save](std_srvs::Trigger::Request&, std_srvs::Trigger::Response& answer) {
    answer.success = static_cast<std::uint8_t>(can_save);
    answer.message = can_save ? "/tmp/saved.bag" : "the disk is full";
    return true;
  };
  const ros::ServiceServer server =
      nh.advertiseService<std_srvs::Trigger::Request, std_srvs::Trigger::Response>("/recorder/save", save);
  feed.recorder().start();
  ASSERT_TRUE(eventually([&] { return !feed.recorder().isUnderWay(); }));
  EXPECT_EQ(feed.recorder().words(), "saved /tmp/saved.bag");
  can_save = false;
  feed.recorder().start();
  ASSERT_TRUE(eventually([&] { return !feed.recorder().isUnderWay(); }));
  EXPECT_EQ(feed.recorder().words(), "not saved: the disk is full");
}

// Nobody serves the service here: this thread does, and it destroys the feed instead.
TEST(InspectorFeed, ARecorderThatDoesNotAnswerHoldsNothingUpAtTheEnd) {
  ros::NodeHandle nh;
  bool was_called = false;
  const auto save = [&was_called](std_srvs::Trigger::Request&, std_srvs::Trigger::Response&) {
    was_called = true;
    return true;
  };
  const ros::ServiceServer server =
      nh.advertiseService<std_srvs::Trigger::Request, std_srvs::Trigger::Response>("/deaf/save", save);
  auto feed = std::make_unique<InspectorFeed>("/deaf/save");
  feed->recorder().start();
  EXPECT_EQ(feed->recorder().words(), "saving ...");
  feed.reset();
  EXPECT_FALSE(was_called);
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "inspector_feed_test");
  const ros::NodeHandle keeps_ros_running;
  return RUN_ALL_TESTS();
}
