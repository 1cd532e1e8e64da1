// The track fusion as node and as nodelet, seen from outside: topics in, topics and diagnostics out.
#include <algorithm>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <diagnostic_msgs/DiagnosticArray.h>
#include <ros/ros.h>
#include <sightline/FusionReport.h>
#include <sightline/TrackArray.h>
#include <sightline/TrackletArray.h>

#include "support/command.h"
#include "support/received.h"

namespace {

/// Keeps the last message of a topic.
template <typename Message>
class Latest {
 public:
  Latest(ros::NodeHandle& nh, const std::string& topic)
      : subscriber_(nh.subscribe(topic, 1000, &Latest::take, this)) {}

  const Message& operator*() const { return message_; }
  const Message* operator->() const { return &message_; }
  bool isConnected() const { return subscriber_.getNumPublishers() > 0; }

 private:
  void take(const boost::shared_ptr<const Message>& message) { message_ = *message; }

  Message message_;
  ros::Subscriber subscriber_;
};

sightline::TrackArray tracksOf(const std::string& tracker, const ros::Time& stamp) {
  sightline::TrackArray array;
  array.header.stamp = stamp;
  array.header.frame_id = "platform_enu";
  array.tracker = tracker;
  array.tracks.resize(1);
  sightline::Track& track = array.tracks[0];
  track.id = 3;
  track.status = sightline::Track::CONFIRMED;
  track.azimuth = 0.5;
  track.covariance[0] = track.covariance[5] = 1e-6;
  track.covariance[10] = track.covariance[15] = 1e-5;
  track.last_sighting = stamp;
  track.hits = 10;
  track.sources = {"sensor of " + tracker};
  return array;
}

class TrackFusionNode : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(eventually([this] {
      return a_.getNumSubscribers() == 2 && b_.getNumSubscribers() == 2 && tracks_.isConnected() &&
             report_.isConnected() && nodelet_tracks_.isConnected();
    })) << "the nodes did not come up";
  }

  /// At a pace at which what is said meanwhile looks like a tracker's reports.
  static bool eventually(
      const std::function<bool()>& condition, const std::function<void()>& meanwhile = [] {}) {
    return ::eventually(condition, meanwhile, ros::WallDuration(0.02));
  }

  void speakBoth() {
    const ros::Time now = ros::Time::now();
    a_.publish(tracksOf("a", now));
    b_.publish(tracksOf("b", now));
  }

  static std::vector<std::string> sourcesIn(const sightline::TrackArray& tracks) {
    return tracks.tracks.size() == 1 ? tracks.tracks[0].sources : std::vector<std::string>{"(not one track)"};
  }

  ros::NodeHandle nh_;
  ros::Publisher a_ = nh_.advertise<sightline::TrackArray>("/a/tracks", 1000);
  ros::Publisher b_ = nh_.advertise<sightline::TrackArray>("/b/tracks", 1000);
  Latest<sightline::TrackArray> tracks_{nh_, "/fusion/tracks"};
  Latest<sightline::FusionReport> report_{nh_, "/fusion/report"};
  Latest<sightline::TrackArray> nodelet_tracks_{nh_, "/nodelet/fusion/tracks"};
};

const std::vector<std::string> kBoth{"a", "b"};

TEST_F(TrackFusionNode, TwoTrackersBecomeOneSurerTrackAndTheReportNamesBoth) {
  const auto are_both_there = [this] {  // tracks and report are two topics, which come in any order
    return sourcesIn(*tracks_) == kBoth && report_->tracks.size() == 1 &&
           report_->tracks[0].sources.size() == 2;
  };
  ASSERT_TRUE(eventually(are_both_there, [this] { speakBoth(); }));
  EXPECT_EQ(tracks_->header.frame_id, "platform_enu");
  EXPECT_EQ(tracks_->tracker, "track_fusion");
  EXPECT_EQ(tracks_->estimator, "best");
  EXPECT_EQ(report_->tracks[0].rule, "cross_covariance");
  EXPECT_EQ(report_->tracks[0].why_not_tracklets, "no tracklets from a");
  EXPECT_LT(tracks_->tracks[0].covariance[0], 1e-6);
  EXPECT_NEAR(tracks_->tracks[0].azimuth, 0.5, 1e-9);
  EXPECT_EQ(report_->tracks[0].id, tracks_->tracks[0].id);
  EXPECT_EQ(report_->tracks[0].sources[0].tracker, "a");
  EXPECT_EQ(report_->tracks[0].sources[1].tracker, "b");
}

/// A tracker's only tracklet since `since`.
sightline::TrackletArray trackletsOf(const std::string& tracker, const ros::Time& stamp,
                                     const ros::Time& since) {
  sightline::TrackletArray array;
  array.header.stamp = stamp;
  array.header.frame_id = "platform_enu";
  array.tracker = tracker;
  array.since = since;
  array.tracklets.resize(1);
  sightline::Tracklet& tracklet = array.tracklets[0];
  tracklet.track = 3;
  tracklet.sensor = "sensor of " + tracker;
  tracklet.stamp = stamp;
  tracklet.azimuth = 0.5;
  tracklet.covariance[0] = tracklet.covariance[3] = 1e-6;
  tracklet.sightings = 1.0;
  tracklet.ifov = std::numeric_limits<double>::quiet_NaN();
  return array;
}

TEST_F(TrackFusionNode, TrackletsBesideTheTracksAreFusedAndTheReportSaysWhenTheyEnd) {
  const ros::Publisher a = nh_.advertise<sightline::TrackletArray>("/a/tracklets", 1000);
  const ros::Publisher b = nh_.advertise<sightline::TrackletArray>("/b/tracklets", 1000);
  ASSERT_TRUE(eventually([&] { return a.getNumSubscribers() == 1 && b.getNumSubscribers() == 1; }))
      << "the nodelet's rule has no use for them";
  const auto rule = [this] { return report_->tracks.size() == 1 ? report_->tracks[0].rule : ""; };
  ros::Time since;
  EXPECT_TRUE(eventually([&] { return rule() == "tracklets" && sourcesIn(*tracks_) == kBoth; },
                         [&] {
                           const ros::Time now = ros::Time::now();
                           a.publish(trackletsOf("a", now, since));
                           b.publish(trackletsOf("b", now, since));
                           since = now;
                           a_.publish(tracksOf("a", now));
                           b_.publish(tracksOf("b", now));
                         }));
  EXPECT_NEAR(tracks_->tracks.at(0).azimuth, 0.5, 1e-6);
  EXPECT_TRUE(eventually([&] { return rule() == "cross_covariance"; }, [this] { speakBoth(); }));
  EXPECT_NE(report_->tracks[0].why_not_tracklets.find("behind its tracks"), std::string::npos)
      << report_->tracks[0].why_not_tracklets;
}

TEST_F(TrackFusionNode, NodeletDoesTheSame) {
  ASSERT_TRUE(eventually([this] { return sourcesIn(*nodelet_tracks_) == kBoth; }, [this] { speakBoth(); }));
  EXPECT_EQ(nodelet_tracks_->estimator, "weighted_covariance");
  EXPECT_EQ(nodelet_tracks_->tracker, "nodelet/track_fusion");
}

TEST_F(TrackFusionNode, FusionGoesOnWhenASourceDiesAndTakesItBack) {
  ASSERT_TRUE(eventually([this] { return sourcesIn(*tracks_) == kBoth; }, [this] { speakBoth(); }));
  const std::uint32_t id = tracks_->tracks[0].id;
  ASSERT_TRUE(eventually([this] { return sourcesIn(*tracks_) == std::vector<std::string>{"a"}; },
                         [this] { a_.publish(tracksOf("a", ros::Time::now())); }));
  EXPECT_TRUE(
      eventually([this] { return report_->tracks.size() == 1 && report_->tracks[0].left_out.size() == 1; }));
  EXPECT_EQ(report_->tracks[0].left_out[0].tracker, "b");
  EXPECT_EQ(report_->tracks[0].left_out[0].reason.substr(0, 6), "stale:");
  ASSERT_TRUE(eventually([this] { return sourcesIn(*tracks_) == kBoth; }, [this] { speakBoth(); }));
  EXPECT_EQ(tracks_->tracks[0].id, id);
}

TEST_F(TrackFusionNode, TheLastReportComesOutThoughNoOtherFollows) {
  for (int round = 0; round < 5; ++round) {
    ASSERT_TRUE(eventually([this] { return sourcesIn(*tracks_) == kBoth; }, [this] { speakBoth(); }));
    const ros::Time stamp = ros::Time::now();
    a_.publish(tracksOf("a", stamp));  // about when b's is expected
    EXPECT_TRUE(eventually([this, stamp] { return tracks_->header.stamp == stamp; })) << round;
  }
}

TEST_F(TrackFusionNode, GarbageCovarianceIsLeftOutWithItsReason) {
  ASSERT_TRUE(eventually([this] { return sourcesIn(*tracks_) == kBoth; }, [this] { speakBoth(); }));
  ASSERT_TRUE(eventually([this] { return sourcesIn(*tracks_) == std::vector<std::string>{"a"}; },
                         [this] {
                           a_.publish(tracksOf("a", ros::Time::now()));
                           sightline::TrackArray garbage = tracksOf("b", ros::Time::now());
                           garbage.tracks[0].covariance[2] = std::numeric_limits<double>::infinity();
                           b_.publish(garbage);
                         }));
  EXPECT_TRUE(
      eventually([this] { return report_->tracks.size() == 1 && report_->tracks[0].left_out.size() == 1; }));
  EXPECT_EQ(report_->tracks[0].left_out[0].reason, "invalid: state or covariance is not finite");
}

TEST_F(TrackFusionNode, TracksFromAnotherFrameAreRefusedAndTheReportSaysWhy) {
  const auto refusal = [this] {
    return report_->left_out.empty() ? std::string() : report_->left_out[0].reason;
  };
  EXPECT_TRUE(eventually([&] { return refusal().find("other_ship") != std::string::npos; },
                         [this] {
                           sightline::TrackArray elsewhere = tracksOf("b", ros::Time::now());
                           elsewhere.header.frame_id = "other_ship";
                           b_.publish(elsewhere);
                         }));
}

TEST_F(TrackFusionNode, DiagnosticsShowEverySource) {
  std::string rate;
  const ros::Subscriber diagnostics = nh_.subscribe<diagnostic_msgs::DiagnosticArray>(
      "/diagnostics", 100, [&rate](const diagnostic_msgs::DiagnosticArray::ConstPtr& array) {
        for (const auto& status : array->status) {
          if (status.name.find("track_fusion: fusion") == std::string::npos) continue;
          for (const auto& value : status.values) {
            if (value.key == "/b/tracks: rate [Hz]") rate = value.value;
          }
        }
      });
  EXPECT_TRUE(
      eventually([&rate] { return !rate.empty() && std::stod(rate) > 0.0; }, [this] { speakBoth(); }));
}

/// Expects that the node /wrong, whose parameters are set, ends with this complaint, one line and exit
/// code 1.
void expectRefusal(const std::string& complaint) {
  const auto [code, said] = outcomeOf("rosrun sightline track_fusion __name:=wrong");
  EXPECT_EQ(code, 1);
  EXPECT_NE(said.find(complaint), std::string::npos) << said;
  EXPECT_NE(said.find("FATAL"), std::string::npos) << said;
  EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 1) << said;
}

TEST_F(TrackFusionNode, WrongConfigurationEndsTheNodeWithOneLineAndExitCodeOne) {
  expectRefusal("/wrong/track_topics: expected a list of strings, but it is not set (it is required)");
  nh_.setParam("/wrong/track_topics", std::vector<std::string>{"/a/tracks"});
  expectRefusal("/wrong/track_topics: expected two topics of sightline/TrackArray or more, got one");
  nh_.setParam("/wrong/track_topics", std::vector<std::string>{"/a/tracks", "a/tracks"});
  expectRefusal("/wrong/track_topics: expected different topics, got /a/tracks twice");
  nh_.setParam("/wrong/track_topics", std::vector<std::string>{"/a/tracks", "/b/tracks"});
  nh_.setParam("/wrong/rule", "magic");
  expectRefusal(
      "/wrong/rule: expected one of best, tracklets, cross_covariance, weighted_covariance, "
      "covariance_intersection, inverse_covariance_intersection, got the string \"magic\"");
  nh_.setParam("/wrong/rule", "weighted_covariance");
  nh_.setParam("/wrong/max_agee", 1.0);
  expectRefusal("/wrong/max_agee: nobody reads this parameter (did you mean /wrong/max_age?)");
  nh_.deleteParam("/wrong");
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "track_fusion_node_test");
  return RUN_ALL_TESTS();
}
