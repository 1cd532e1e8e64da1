#include <functional>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include <ros/ros.h>
#include <sightline/SightingArray.h>
#include <sightline/TrackArray.h>
#include <tf2_msgs/TFMessage.h>
#include <visualization_msgs/MarkerArray.h>

#include "support/waiting.h"

namespace {

using visualization_msgs::Marker;
using visualization_msgs::MarkerArray;

constexpr double kPace = 0.02;  // of what is published meanwhile [s]

/// A topic of the display, and what was published on it.
class Channel {
 public:
  Channel(ros::NodeHandle& nh, const std::string& topic)
      : subscriber_(nh.subscribe<MarkerArray>(
            topic, 100, [this](const MarkerArray::ConstPtr& array) { take(*array); })) {}

  bool shows(const std::string& name) const { return shown_.count(name) > 0; }
  const Marker& marker(const std::string& name) const { return markers_.at(name); }
  int arrays() const { return arrays_; }

 private:
  void take(const MarkerArray& array) {
    ++arrays_;
    for (const Marker& marker : array.markers) {
      if (marker.action == Marker::ADD) {
        shown_.insert(marker.ns);
        markers_[marker.ns] = marker;
      } else {
        shown_.erase(marker.ns);
      }
    }
  }

  std::set<std::string> shown_;
  std::map<std::string, Marker> markers_;
  int arrays_ = 0;
  ros::Subscriber subscriber_;
};

class TrackDisplay : public testing::Test {
 protected:
  static bool eventually(
      const std::function<bool()>& condition, const std::function<void()>& meanwhile = [] {}) {
    return ::eventually(condition, meanwhile, ros::WallDuration(kPace));
  }

  TrackDisplay() {
    transforms_ = nh_.advertise<tf2_msgs::TFMessage>("/tf_static", 1, true);
    sightings_ = nh_.advertise<sightline::SightingArray>("/sensors/acquisition_1/sightings", 10);
    tracks_ = nh_.advertise<sightline::TrackArray>("/fusion/tracks", 10);
    truth_ = nh_.advertise<sightline::TrackArray>("/truth", 10);
  }

  /// acquisition_1 looks along +y of the tracking frame.
  void publishTransform() {
    tf2_msgs::TFMessage message;
    message.transforms.resize(1);
    message.transforms[0].header.frame_id = "platform_enu";
    message.transforms[0].child_frame_id = "acquisition_1";
    message.transforms[0].transform.rotation.z = message.transforms[0].transform.rotation.w = std::sqrt(0.5);
    transforms_.publish(message);
  }

  void publishScan() {
    sightline::SightingArray scan;
    scan.header.stamp = ros::Time::now();
    scan.header.frame_id = scan.sensor = "acquisition_1";
    scan.ifov = 0.01;
    scan.detection_probability = 0.9;
    scan.sightings.resize(1);
    scan.sightings[0].covariance[0] = scan.sightings[0].covariance[3] = 1e-4;
    sightings_.publish(scan);
  }

  void publishTracks(const ros::Publisher& publisher, const std::string& frame) {
    sightline::TrackArray report;
    report.header.stamp = ros::Time::now();
    report.header.frame_id = frame;
    report.tracks.resize(1);
    sightline::Track& track = report.tracks[0];
    track.id = 1;
    track.status = sightline::Track::CONFIRMED;
    track.covariance[0] = track.covariance[5] = 1e-2;
    track.covariance[10] = track.covariance[15] = 1e-4;
    publisher.publish(report);
  }

  ros::NodeHandle nh_;
  ros::Publisher transforms_, sightings_, tracks_, truth_;
};

TEST_F(TrackDisplay, ShowsSightingsInTheTrackingFrame) {
  Channel channel(nh_, "/display/acquisition_1");
  publishTransform();
  ASSERT_TRUE(eventually([&] { return channel.shows("sightings"); }, [this] { publishScan(); }));
  const Marker& dots = channel.marker("sightings");
  EXPECT_EQ(dots.header.frame_id, "platform_enu");
  EXPECT_NEAR(dots.points.at(0).x, 0.0, 1e-6);
  EXPECT_GT(dots.points.at(0).y, 9.0);  // along the boresight, on the sphere of 10 m
}

TEST_F(TrackDisplay, ShowsTheMainTrackWithItsLabelAndTheTruth) {
  Channel fusion(nh_, "/display/fusion"), truth(nh_, "/display/truth");
  const auto publish = [this] {
    publishTracks(tracks_, "platform_enu");
    publishTracks(truth_, "platform_enu");
  };
  ASSERT_TRUE(eventually([&] { return fusion.shows("labels") && truth.shows("targets"); }, publish));
  EXPECT_NE(fusion.marker("labels").text.find("track 1"), std::string::npos);
  EXPECT_GT(fusion.marker("tracks").lifetime.toSec(), 0.0);
}

TEST_F(TrackDisplay, ShowsEverythingOnOneTopicToo) {
  Channel all(nh_, "/display/all");
  const auto publish = [this] {
    publishTracks(tracks_, "platform_enu");
    publishTracks(truth_, "platform_enu");
  };
  EXPECT_TRUE(
      eventually([&] { return all.shows("fusion: tracks") && all.shows("truth: targets"); }, publish));
}

TEST_F(TrackDisplay, TurnsTheViewFrameTowardsTheTrack) {
  std::string child;
  const auto take = [&](const tf2_msgs::TFMessage::ConstPtr& message) {
    for (const auto& transform : message->transforms) {
      if (transform.child_frame_id == "display_view") child = transform.header.frame_id;
    }
  };
  const ros::Subscriber subscriber = nh_.subscribe<tf2_msgs::TFMessage>(
      "/tf_static", 10, boost::function<void(const tf2_msgs::TFMessage::ConstPtr&)>(take));
  EXPECT_TRUE(eventually([&] { return !child.empty(); }, [this] { publishTracks(tracks_, "platform_enu"); }));
  EXPECT_EQ(child, "platform_enu");
}

TEST_F(TrackDisplay, ClearsWhatIsNotReportedAnyMore) {
  Channel fusion(nh_, "/display/fusion");
  ASSERT_TRUE(
      eventually([&] { return fusion.shows("tracks"); }, [this] { publishTracks(tracks_, "platform_enu"); }));
  EXPECT_TRUE(eventually([&] { return !fusion.shows("tracks"); }));
}

TEST_F(TrackDisplay, PublishesNotFasterThanItsRateWhateverComesIn) {
  Channel fusion(nh_, "/display/fusion");
  ASSERT_TRUE(
      eventually([&] { return fusion.shows("tracks"); }, [this] { publishTracks(tracks_, "platform_enu"); }));
  const int before = fusion.arrays();
  int reports = 0;
  ASSERT_TRUE(eventually([&] { return fusion.arrays() >= before + 5; },
                         [&] {
                           for (int i = 0; i < 40; ++i, ++reports) publishTracks(tracks_, "platform_enu");
                         }));
  EXPECT_LT(5 * (fusion.arrays() - before), reports);
}

TEST_F(TrackDisplay, LeavesTracksOfAnotherFrameOut) {
  Channel local(nh_, "/display/tracking_1"), truth(nh_, "/display/truth");
  const ros::Publisher tracks = nh_.advertise<sightline::TrackArray>("/sensors/tracking_1/tracks", 10);
  ASSERT_TRUE(eventually([&] { return tracks.getNumSubscribers() > 0; }));
  const auto publish = [&] {
    publishTracks(tracks, "elsewhere");
    publishTracks(truth_, "platform_enu");
  };
  const int before = truth.arrays();
  ASSERT_TRUE(eventually([&] { return truth.arrays() >= before + 20; }, publish));
  EXPECT_FALSE(local.shows("tracks"));
  // The same in the right frame is shown.
  EXPECT_TRUE(
      eventually([&] { return local.shows("tracks"); }, [&] { publishTracks(tracks, "platform_enu"); }));
}

TEST_F(TrackDisplay, ShowsTheGridAndTheFieldsOfViewToLatecomers) {
  Channel grid(nh_, "/display/grid"), sensor(nh_, "/display/acquisition_1"), absent(nh_, "/display/absent");
  publishTransform();
  ASSERT_TRUE(eventually([&] { return grid.shows("lines") && sensor.shows("field of view"); }));
  EXPECT_FALSE(absent.shows("field of view")) << "a sensor without a frame is not running";
  EXPECT_EQ(sensor.marker("field of view").header.frame_id, "acquisition_1");
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "track_display_test");
  return RUN_ALL_TESTS();
}
