// The local tracker as node and as nodelet, seen from outside: topics in, topics and diagnostics out.
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <diagnostic_msgs/DiagnosticArray.h>
#include <ros/ros.h>
#include <sightline/AssociationArray.h>
#include <sightline/SightingArray.h>
#include <sightline/TrackArray.h>
#include <tf2_msgs/TFMessage.h>

#include "support/command.h"
#include "support/received.h"

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

sightline::Sighting sightingAt(double azimuth) {
  sightline::Sighting sighting;
  sighting.azimuth = azimuth;
  sighting.covariance = {1e-6, 0.0, 0.0, 1e-6};
  sighting.snr = kNaN;
  return sighting;
}

class LocalTrackerNode : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(eventually([this] {
      return a_.getNumSubscribers() == 2 && b_.getNumSubscribers() == 1 && tf_.getNumSubscribers() == 2 &&
             tracks_.isConnected() && associations_.isConnected() && nodelet_tracks_.isConnected();
    })) << "the nodes did not come up";
  }

  sightline::SightingArray scan(const ros::Time& stamp, const std::vector<double>& azimuths,
                                const std::string& frame = "platform_enu") {
    sightline::SightingArray scan;
    scan.header.stamp = stamp;
    scan.header.frame_id = frame;
    scan.sensor = "a";
    scan.ifov = scan.detection_probability = scan.clutter_density = kNaN;
    for (double azimuth : azimuths) scan.sightings.push_back(sightingAt(azimuth));
    return scan;
  }

  /// The association message of the scan with this stamp, when it has come.
  const sightline::AssociationArray* associationsOf(const ros::Time& stamp) {
    for (const auto& message : associations_.messages()) {
      if (message.header.stamp == stamp) return &message;
    }
    return nullptr;
  }

  /// The newest value under `key` in the node's diagnostics; empty when there is none.
  std::string diagnosticOf(const std::string& key) {
    std::string newest;
    for (const auto& array : diagnostics_.messages()) {
      for (const auto& status : array.status) {
        if (status.name.find("node/local_tracker") != 0) continue;
        for (const auto& value : status.values) {
          if (value.key == key) newest = value.value;
        }
      }
    }
    return newest;
  }

  /// Lets a target stay at `azimuth` for some scans; returns the stamp of the last one.
  ros::Time showTarget(double azimuth, const std::string& frame = "platform_enu", int scans = 8) {
    const ros::Time start = ros::Time::now() - ros::Duration(0.01 * (scans - 8));
    ros::Time stamp;
    for (int i = 0; i < scans; ++i) {
      stamp =
          start + ros::Duration(0.01 * i);  // the last ones are ahead of the clock by less than max_future
      a_.publish(scan(stamp, {azimuth}, frame));
    }
    return stamp;
  }

  /// The confirmed track near `azimuth` at `stamp` or later.
  static const sightline::Track* confirmed(const Received<sightline::TrackArray>& heard,
                                           const ros::Time& stamp, double azimuth) {
    for (const auto& message : heard.messages()) {
      if (message.header.stamp < stamp) continue;
      for (const auto& track : message.tracks) {
        if (track.status == sightline::Track::CONFIRMED && std::abs(track.azimuth - azimuth) < 0.01)
          return &track;
      }
    }
    return nullptr;
  }

  ros::NodeHandle nh_;
  ros::Publisher a_ = nh_.advertise<sightline::SightingArray>("/sightings/a", 100);
  ros::Publisher b_ = nh_.advertise<sightline::SightingArray>("/sightings/b", 100);
  ros::Publisher tf_ = nh_.advertise<tf2_msgs::TFMessage>("/tf", 100);
  Received<sightline::TrackArray> tracks_{nh_, "/node/tracks"};
  Received<sightline::TrackArray> nodelet_tracks_{nh_, "/nodelet/tracks"};
  Received<sightline::TrackArray> smoothed_{nh_, "/node/tracks_smoothed"};
  Received<sightline::TrackArray> nodelet_smoothed_{nh_, "/nodelet/tracks_smoothed"};
  Received<sightline::AssociationArray> associations_{nh_, "/node/associations"};
  Received<diagnostic_msgs::DiagnosticArray> diagnostics_{nh_, "/diagnostics"};
};

TEST_F(LocalTrackerNode, SightingsBecomeAConfirmedTrackInNodeAndNodeletAlike) {
  const ros::Time last = showTarget(0.3);
  EXPECT_TRUE(eventually([&] { return confirmed(tracks_, last, 0.3) != nullptr; }));
  EXPECT_TRUE(eventually([&] { return confirmed(nodelet_tracks_, last, 0.3) != nullptr; }));
  EXPECT_EQ(tracks_.messages().back().tracker, "under_test");
  EXPECT_EQ(nodelet_tracks_.messages().back().tracker, "nodelet/local_tracker");
}

TEST_F(LocalTrackerNode, SmoothedTracksFollowALagLaterAndTheLastOnesWhenNothingMoreComes) {
  ASSERT_TRUE(eventually([this] { return smoothed_.isConnected() && nodelet_smoothed_.isConnected(); }));
  const ros::Time last = showTarget(-1.2, "platform_enu", 60);
  for (auto* heard : {&smoothed_, &nodelet_smoothed_}) {
    ASSERT_TRUE(eventually([&] { return confirmed(*heard, last, -1.2) != nullptr; }));
    const auto& plain = heard == &smoothed_ ? tracks_ : nodelet_tracks_;
    ASSERT_NE(confirmed(plain, last, -1.2), nullptr);
    EXPECT_EQ(confirmed(*heard, last, -1.2)->id, confirmed(plain, last, -1.2)->id);
    // In the middle of its sightings the rate is known better than by those before alone.
    const ros::Time middle = last - ros::Duration(0.4);
    ASSERT_NE(confirmed(*heard, middle, -1.2), nullptr);
    EXPECT_LT(confirmed(*heard, middle, -1.2)->covariance[10],
              0.8 * confirmed(plain, middle, -1.2)->covariance[10]);
    for (std::size_t i = 1; i < heard->messages().size(); ++i)
      EXPECT_GE(heard->messages()[i].header.stamp, heard->messages()[i - 1].header.stamp);
  }
  EXPECT_TRUE(eventually([&] { return diagnosticOf("smoothing: lag [s]") == "0.2"; }));
}

TEST_F(LocalTrackerNode, ALagForAnEstimatorWithoutAModelEndsTheNodeWithOneLine) {
  nh_.setParam("/paper/sighting_topics", std::vector<std::string>{"/nothing"});
  nh_.setParam("/paper/smoothing_lag", 0.5);
  nh_.setParam("/paper/noga/form", "paper");
  const auto [code, said] = outcomeOf("rosrun sightline local_tracker __name:=paper");
  EXPECT_EQ(code, 1);
  EXPECT_NE(said.find("/paper/smoothing_lag: "), std::string::npos) << said;
  EXPECT_NE(said.find("noga of form paper"), std::string::npos) << said;
  EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 1) << said;
}

TEST_F(LocalTrackerNode, EveryTopicOfTheListIsHeard) {
  auto message = scan(ros::Time::now(), {1.0});
  message.sensor = "b";
  b_.publish(message);
  EXPECT_TRUE(eventually([&] { return associationsOf(message.header.stamp) != nullptr; }));
}

TEST_F(LocalTrackerNode, BadSightingsAreRejectedWithTheirReasonWhileTheOthersAreUsed) {
  showTarget(-0.5);
  const ros::Time stamp = ros::Time::now() + ros::Duration(0.09);
  a_.publish(scan(stamp, {kNaN, -0.5, 200.0}));
  ASSERT_TRUE(eventually([&] { return associationsOf(stamp) != nullptr; }));
  const auto& associations = associationsOf(stamp)->associations;
  ASSERT_EQ(associations.size(), 3u);
  EXPECT_EQ(associations[0].decision, sightline::Association::REJECTED_INPUT);
  EXPECT_NE(associations[0].reason, "");
  EXPECT_EQ(associations[1].decision, sightline::Association::ACCEPTED);
  EXPECT_EQ(associations[2].decision, sightline::Association::REJECTED_INPUT);
  EXPECT_TRUE(eventually([&] { return !diagnosticOf("sightings rejected").empty(); }));
}

TEST_F(LocalTrackerNode, UnknownFrameIsDroppedAfterTheTimeoutWithItsReasonInTheDiagnostics) {
  const ros::Time stamp = ros::Time::now();
  a_.publish(scan(stamp, {0.0}, "no_such_frame"));
  ASSERT_TRUE(eventually([&] { return associationsOf(stamp) != nullptr; }));
  EXPECT_NE(associationsOf(stamp)->associations.at(0).reason.find("no_such_frame"), std::string::npos);
  EXPECT_TRUE(eventually([&] { return !diagnosticOf("scans dropped, no transform").empty(); }));
}

TEST_F(LocalTrackerNode, ScanWaitsForTheTransformThatComesLate) {
  const ros::Time stamp = ros::Time::now();
  a_.publish(scan(stamp, {0.0}, "late_frame"));
  ASSERT_TRUE(eventually([&] { return diagnosticOf("scans waiting for a transform") == "1"; }));
  tf2_msgs::TFMessage message;
  for (double offset : {-0.1, 0.1}) {
    geometry_msgs::TransformStamped transform;
    transform.header.stamp = stamp + ros::Duration(offset);
    transform.header.frame_id = "platform_enu";
    transform.child_frame_id = "late_frame";
    transform.transform.rotation.z = std::sin(0.35);
    transform.transform.rotation.w = std::cos(0.35);
    message.transforms.push_back(transform);
  }
  tf_.publish(message);
  const auto started_at_the_turned_place = [&] {
    for (const auto& tracks : tracks_.messages()) {
      for (const auto& track : tracks.tracks) {
        if (track.last_sighting == stamp && std::abs(track.azimuth - 0.7) < 1e-3) return true;
      }
    }
    return false;
  };
  EXPECT_TRUE(eventually(started_at_the_turned_place));
}

TEST_F(LocalTrackerNode, StampsAheadOfTheClockAndRepeatedScansAreRefusedAndCounted) {
  const auto ahead = scan(ros::Time::now() + ros::Duration(60.0), {0.0});
  a_.publish(ahead);
  EXPECT_TRUE(eventually([&] { return associationsOf(ahead.header.stamp) != nullptr; }));
  EXPECT_TRUE(eventually([&] { return !diagnosticOf("scans dropped, from the future").empty(); }));
  const auto twice = scan(ros::Time::now(), {0.0});
  a_.publish(twice);
  a_.publish(twice);
  EXPECT_TRUE(eventually([&] { return !diagnosticOf("scans dropped, duplicate").empty(); }));
}

TEST_F(LocalTrackerNode, TargetOfASensorThatWasSilentIsFoundAgainUnderANewId) {
  const ros::Time before = showTarget(0.9, "platform_enu", 40);  // enough of them to know the sensor's pace
  ASSERT_TRUE(eventually([&] { return confirmed(tracks_, before, 0.9) != nullptr; }));
  const auto old_id = confirmed(tracks_, before, 0.9)->id;
  const ros::Time back = ros::Time::now() + ros::Duration(6.0);  // longer than a lost target is remembered
  ASSERT_TRUE(eventually([&] { return ros::Time::now() > back; }));
  const ros::Time after = showTarget(0.9);
  ASSERT_TRUE(eventually([&] { return confirmed(tracks_, after, 0.9) != nullptr; }));
  EXPECT_GT(confirmed(tracks_, after, 0.9)->id, old_id);
}

TEST_F(LocalTrackerNode, WrongConfigurationEndsTheNodeWithOneLineAndExitCodeOne) {
  nh_.setParam("/wrong/sighting_topics", std::vector<std::string>{"/nothing"});
  nh_.setParam("/wrong/gate/probability", "1e-3");
  const auto [code, said] = outcomeOf("rosrun sightline local_tracker __name:=wrong");
  EXPECT_EQ(code, 1);
  EXPECT_NE(said.find("/wrong/gate/probability: expected a number in (0, 1), got the string \"1e-3\""),
            std::string::npos)
      << said;
  EXPECT_NE(said.find("FATAL"), std::string::npos);
  EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 1) << said;
}

TEST_F(LocalTrackerNode, UnknownAndMissingParametersEndTheNodeToo) {
  nh_.setParam("/unknown/sighting_topics", std::vector<std::string>{"/nothing"});
  nh_.setParam("/unknown/gate/probabilty", 0.9);
  const auto unknown = outcomeOf("rosrun sightline local_tracker __name:=unknown");
  EXPECT_EQ(unknown.first, 1);
  EXPECT_NE(unknown.second.find("did you mean /unknown/gate/probability?"), std::string::npos)
      << unknown.second;
  const auto missing = outcomeOf("rosrun sightline local_tracker __name:=missing");
  EXPECT_EQ(missing.first, 1);
  EXPECT_NE(missing.second.find("/missing/sighting_topics"), std::string::npos) << missing.second;
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "local_tracker_node_test");
  ros::NodeHandle keeps_ros_running;
  return RUN_ALL_TESTS();
}
