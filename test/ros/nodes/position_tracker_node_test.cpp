// The position tracker as node and as nodelet, seen from outside: sightings of stations that stand apart
// through their local trackers, static tf; positions and diagnostics out.
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include <diagnostic_msgs/DiagnosticArray.h>
#include <geometry_msgs/PoseArray.h>
#include <ros/ros.h>
#include <sightline/PositionReport.h>
#include <sightline/PositionTrackArray.h>
#include <sightline/SightingArray.h>
#include <tf2_msgs/TFMessage.h>

#include "sightline/ros/messages/position_messages.h"

#include "support/command.h"
#include "support/received.h"
#include "support/seen_stations.h"

namespace {

namespace core = sightline::core;
using sightline::test::SeenStation;
using sightline::test::targetAt;

class PositionTrackerNode : public testing::Test {
 protected:
  void SetUp() override {
    tf2_msgs::TFMessage places;
    for (const SeenStation& station : stations_) {
      places.transforms.push_back(station.transform(ros::Time::now(), "world"));
      eyes_.push_back(nh_.advertise<sightline::SightingArray>("/" + station.name() + "/sightings", 100));
    }
    ASSERT_TRUE(eventually([this] {
      const bool are_heard = std::all_of(eyes_.begin(), eyes_.end(),
                                         [](const auto& eye) { return eye.getNumSubscribers() == 1; });
      return are_heard && tf_.getNumSubscribers() == 5 && positions_.isConnected() && report_.isConnected() &&
             poses_.isConnected() && of_nodelet_.isConnected();
    })) << "the nodes did not come up";
    tf_.publish(places);
  }

  /// Of the target's path, for all tests alike.
  static ros::Time beginning() {
    static const ros::Time first = ros::Time::now();
    return first;
  }

  /// Each station sees the target now.
  void look() {
    const ros::Time now = ros::Time::now();
    for (std::size_t i = 0; i < eyes_.size(); ++i)
      eyes_[i].publish(stations_[i].scan(now, targetAt((now - begin_).toSec())));
  }

  /// Looks at a pace of cameras until the condition holds.
  bool comesTrue(const std::function<bool()>& condition) {
    return eventually(
        condition, [this] { look(); }, ros::WallDuration(0.04));
  }

  /// Of what has been seen for a second in this test: the trackers live through all of them.
  bool isConfirmed(const Received<sightline::PositionTrackArray>& received, std::size_t sources) const {
    if (received.messages().empty() || received.messages().back().tracks.size() != 1) return false;
    const auto& track = received.messages().back().tracks[0];
    return track.status == sightline::PositionTrack::CONFIRMED && track.sources.size() == sources &&
           track.last_sighting > started_ + ros::Duration(1.0);
  }

  void expectTruth(const sightline::PositionTrackArray& message) const {
    const core::PositionTrack track = sightline_ros::toCore(message.tracks.at(0));
    const Eigen::Vector3d error = track.position - targetAt((message.header.stamp - begin_).toSec());
    const double distance = error.dot(track.covariance.topLeftCorner<3, 3>().llt().solve(error));
    EXPECT_LT(std::sqrt(distance), 3.0) << error.transpose();
    EXPECT_LT(error.norm(), 1.0);
  }

  ros::NodeHandle nh_;
  std::vector<SeenStation> stations_{{"west", {0.0, 0.0, 2.0}, 0.4, 1},
                                     {"east", {80.0, 0.0, 1.0}, 2.5, 2},
                                     {"north", {40.0, 90.0, 0.0}, -1.5, 3}};
  ros::Time started_ = ros::Time::now();
  ros::Time begin_ = beginning();
  ros::Publisher tf_ = nh_.advertise<tf2_msgs::TFMessage>("/tf_static", 10, true);
  std::vector<ros::Publisher> eyes_;
  Received<sightline::PositionTrackArray> positions_{nh_, "/positions/tracks"};
  Received<sightline::PositionReport> report_{nh_, "/positions/report"};
  Received<geometry_msgs::PoseArray> poses_{nh_, "/positions/poses"};
  Received<sightline::PositionTrackArray> of_nodelet_{nh_, "/nodelet/positions/tracks"};
};

TEST_F(PositionTrackerNode, ThreeStationsGiveAConfirmedPositionWithinThreeSigmaOfTheTruth) {
  ASSERT_TRUE(comesTrue([this] { return isConfirmed(positions_, 3); }));
  expectTruth(positions_.messages().back());
  EXPECT_EQ(positions_.messages().back().header.frame_id, "world");
  EXPECT_EQ(positions_.messages().back().tracker, "positions");
  ASSERT_TRUE(
      comesTrue([this] { return !poses_.messages().empty() && poses_.messages().back().poses.size() == 1; }));
  EXPECT_EQ(poses_.messages().back().header.frame_id, "world");
  ASSERT_TRUE(comesTrue([this] {
    return !report_.messages().empty() && report_.messages().back().positions.size() == 1 &&
           report_.messages().back().stations.size() == 3;
  }));
  EXPECT_EQ(report_.messages().back().stations[0].tracker, "east");
}

TEST_F(PositionTrackerNode, NodeletDoesTheSameWithTwo) {
  ASSERT_TRUE(comesTrue([this] { return isConfirmed(of_nodelet_, 2); }));
  expectTruth(of_nodelet_.messages().back());
}

TEST_F(PositionTrackerNode, DiagnosticsShowPositionsAndStations) {
  std::string confirmed, slow;
  const ros::Subscriber diagnostics = nh_.subscribe<diagnostic_msgs::DiagnosticArray>(
      "/diagnostics", 100, [&](const diagnostic_msgs::DiagnosticArray::ConstPtr& array) {
        for (const auto& status : array->status) {
          if (status.name != "position_tracker: positions") continue;
          for (const auto& value : status.values) {
            if (value.key == "positions confirmed") confirmed = value.value;
            if (value.key == "slow error of east/eye of east") slow = value.value;
          }
        }
      });
  EXPECT_TRUE(comesTrue([&] { return confirmed == "1" && !slow.empty(); })) << confirmed << ", " << slow;
}

/// Expects that the node /wrong, whose parameters are set, ends with this complaint, one line and exit
/// code 1.
void expectRefusal(const std::string& complaint) {
  const auto [code, said] = outcomeOf("rosrun sightline position_tracker __name:=wrong");
  EXPECT_EQ(code, 1);
  EXPECT_NE(said.find(complaint), std::string::npos) << said;
  EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 1) << said;
}

TEST_F(PositionTrackerNode, WrongConfigurationEndsTheNodeWithOneLineAndExitCodeOne) {
  expectRefusal("/wrong/track_topics: expected a list of strings, but it is not set (it is required)");
  nh_.setParam("/wrong/track_topics", std::vector<std::string>{"/a/tracks", "/b/tracks"});
  nh_.setParam("/wrong/max_relative_sigma", 1.5);
  expectRefusal("/wrong/max_relative_sigma: expected a number in (0, 1)");
  nh_.deleteParam("/wrong");
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "position_tracker_node_test");
  return RUN_ALL_TESTS();
}
