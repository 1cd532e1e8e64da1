// Outputs as node and as nodelet, seen from outside by those who read them: sightings through a local tracker
// to tf2's buffer and listeners; positions to odometry, paths and a pan-tilt head; lines of JSON to python3.
#include <algorithm>
#include <cmath>
#include <future>
#include <nav_msgs/Odometry.h>
#include <nav_msgs/Path.h>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <diagnostic_msgs/DiagnosticArray.h>
#include <geometry_msgs/PoseArray.h>
#include <geometry_msgs/QuaternionStamped.h>
#include <geometry_msgs/Vector3Stamped.h>
#include <ros/ros.h>
#include <sensor_msgs/PointCloud2.h>
#include <sensor_msgs/point_cloud2_iterator.h>
#include <sightline/PositionTrackArray.h>
#include <sightline/SightingArray.h>
#include <std_msgs/UInt32.h>
#include <tf2_msgs/TFMessage.h>
#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_listener.h>

#include "sightline/core/model/sphere.h"
#include "sightline/ros/messages/transform_messages.h"

#include "support/command.h"
#include "support/output_tracks.h"
#include "support/received.h"
#include "support/seen_stations.h"

namespace {

namespace core = sightline::core;
using sightline::PositionTrackArray;
using sightline::test::positionTrack;
using sightline::test::SeenStation;
using sightline::test::stamped;
using sightline::test::targetAt;

constexpr double kNear = 0.02;  // [rad]: twenty sigmas of the track, for a target of about 5 deg/s

Eigen::Vector3d along(const geometry_msgs::Quaternion& q) {
  return Eigen::Quaterniond(q.w, q.x, q.y, q.z) * Eigen::Vector3d::UnitX();
}

/// The last word of a node's diagnostics on its head.
class HeadWords {
 public:
  HeadWords(ros::NodeHandle& nh, std::string node)
      : node_(std::move(node)), subscriber_(nh.subscribe("/diagnostics", 100, &HeadWords::take, this)) {}

  bool say(const std::string& words) const { return words_.find(words) != std::string::npos; }
  const std::string& words() const { return words_; }

 private:
  void take(const diagnostic_msgs::DiagnosticArray& array) {
    for (const auto& status : array.status) {
      if (status.name != node_ + ": outputs") continue;
      for (const auto& value : status.values) {
        if (value.key == "head") words_ = value.value;
      }
    }
  }

  std::string node_, words_;
  ros::Subscriber subscriber_;
};

bool isAdvertised(const std::string& topic) {
  ros::master::V_TopicInfo topics;
  ros::master::getTopics(topics);
  return std::any_of(topics.begin(), topics.end(), [&](const auto& info) { return info.name == topic; });
}

// ---- directions, from sightings through a local tracker, by the node
// ------------------------------------------

class OutputsOfDirections : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(eventually([this] { return eye_.getNumSubscribers() == 1; }))
        << "the tracker did not come up";
  }

  /// Of the target's path, for all tests alike.
  static ros::Time beginning() {
    static const ros::Time first = ros::Time::now();
    return first;
  }

  Eigen::Vector3d truthAt(const ros::Time& time) const {
    return core::directionOf(station_.anglesTo(targetAt((time - begin_).toSec())));
  }

  void look() {
    const ros::Time now = ros::Time::now();
    eye_.publish(station_.scan(now, targetAt((now - begin_).toSec())));
  }

  /// Looks at the pace of a camera until the condition holds.
  bool comesTrue(const std::function<bool()>& condition) {
    return eventually(
        condition, [this] { look(); }, ros::WallDuration(0.04));
  }

  /// The topic of the one track that there is; empty before.
  std::string topicOfTrack() const {
    ros::master::V_TopicInfo topics;
    ros::master::getTopics(topics);
    for (const auto& info : topics)
      if (info.name.rfind("/track_outputs/directions/track_", 0) == 0) return info.name;
    return "";
  }

  ros::NodeHandle nh_;
  ros::Time begin_ = beginning();
  SeenStation station_{"west", {0.0, 0.0, 2.0}, 0.4, 1};
  ros::Publisher eye_ = nh_.advertise<sightline::SightingArray>("/west/sightings", 100);
  ros::Publisher choose_ = nh_.advertise<std_msgs::UInt32>("/track_outputs/choose", 1);
};

TEST_F(OutputsOfDirections, Tf2FindsTheFrameOfATrackOnTheLineOfSight) {
  tf2_ros::Buffer buffer;
  const tf2_ros::TransformListener listener(buffer, nh_, false);
  std::string frame;
  ASSERT_TRUE(comesTrue([&] {
    const std::string topic = topicOfTrack();
    frame = topic.empty() ? "" : topic.substr(topic.rfind('/') + 1);
    return !frame.empty() && buffer.canTransform("west", frame, ros::Time(0));
  }));
  // A second later, when the track knows its rates.
  const ros::Time end = ros::Time::now() + ros::Duration(1.0);
  ASSERT_TRUE(comesTrue([&] { return buffer.canTransform("west", frame, end); }));
  const auto track = buffer.lookupTransform("west", frame, end);
  const auto& place = track.transform.translation;
  EXPECT_LT(core::angleBetween({place.x, place.y, place.z}, truthAt(end)), kNear);
  EXPECT_LT(core::angleBetween(along(track.transform.rotation), truthAt(end)), kNear);
}

TEST_F(OutputsOfDirections, PosesPointsAndVectorsShowTheTrackAtItsStamp) {
  Received<geometry_msgs::PoseArray> poses(nh_, "/track_outputs/poses");
  Received<sensor_msgs::PointCloud2> points(nh_, "/track_outputs/points");
  std::string topic;
  ASSERT_TRUE(comesTrue([&] { return !(topic = topicOfTrack()).empty(); }));
  Received<geometry_msgs::Vector3Stamped> directions(nh_, topic);
  ASSERT_TRUE(comesTrue([&] {
    return directions.messages().size() > 10 && !poses.messages().empty() && !points.messages().empty() &&
           poses.messages().back().header.stamp == directions.messages().back().header.stamp &&
           points.messages().back().header.stamp == directions.messages().back().header.stamp;
  }));
  const auto& vector = directions.messages().back().vector;
  const Eigen::Vector3d direction(vector.x, vector.y, vector.z);
  EXPECT_EQ(directions.messages().back().header.frame_id, "west");
  EXPECT_LT(core::angleBetween(direction, truthAt(directions.messages().back().header.stamp)), kNear);
  ASSERT_EQ(poses.messages().back().poses.size(), 1u);
  EXPECT_LT((along(poses.messages().back().poses[0].orientation) - direction).norm(), 1e-9);
  ASSERT_EQ(points.messages().back().width, 1u);
  sensor_msgs::PointCloud2ConstIterator<float> x(points.messages().back(), "x");
  EXPECT_LT((Eigen::Vector3f(x[0], x[1], x[2]).cast<double>() - 10.0 * direction).norm(), 1e-4);
}

TEST_F(OutputsOfDirections, TheHeadLooksAheadAndStaysWhenTheChosenTrackIsNotThere) {
  Received<geometry_msgs::QuaternionStamped> head(nh_, "/track_outputs/head");
  const HeadWords words(nh_, "track_outputs");
  ASSERT_TRUE(eventually([this] { return choose_.getNumSubscribers() == 1; }));
  ASSERT_TRUE(comesTrue([&] { return head.messages().size() > 50; }));
  const auto& last = head.messages().back();
  EXPECT_EQ(last.header.frame_id, "west");
  EXPECT_LT(core::angleBetween(along(last.quaternion), truthAt(last.header.stamp)), kNear);

  std_msgs::UInt32 id;
  id.data = 12345;
  choose_.publish(id);
  ASSERT_TRUE(comesTrue([&] { return words.say("track 12345, which is chosen, is not there"); }))
      << words.words();
  head.forget();
  Received<sightline::TrackArray> tracks(nh_, "/west/tracks");
  ASSERT_TRUE(comesTrue([&] { return tracks.messages().size() > 20; }));
  EXPECT_TRUE(head.messages().empty()) << "the head must stay where it was";

  id.data = 0;
  choose_.publish(id);
  EXPECT_TRUE(comesTrue([&] { return head.messages().size() > 5 && words.say("follows track"); }));
}

TEST_F(OutputsOfDirections, TrackStreamPrintsLinesThatPythonReads) {
  ASSERT_TRUE(comesTrue([&] { return !topicOfTrack().empty(); }));
  auto outcome = std::async(std::launch::async, [] {
    return outcomeOf(
        "rosrun sightline track_stream --count 20 /west/tracks | python3 -c 'import json, sys\n"
        "lines = [json.loads(line) for line in sys.stdin]\n"
        "stamps = [line[\"stamp\"] for line in lines]\n"
        "print(len(lines), lines[-1][\"frame\"], stamps == sorted(stamps), "
        "lines[-1][\"tracks\"][0][\"status\"])'");
  });
  ASSERT_TRUE(
      comesTrue([&] { return outcome.wait_for(std::chrono::seconds(0)) == std::future_status::ready; }));
  EXPECT_EQ(outcome.get().second, "20 west True confirmed\n");
}

TEST_F(OutputsOfDirections, TrackStreamSaysInOneLineWhatIsWrong) {
  const auto [code, said] = outcomeOf("ROS_MASTER_URI=http://localhost:1 rosrun sightline track_stream");
  EXPECT_EQ(code, 1);
  EXPECT_NE(said.find("there is no ROS master at http://localhost:1"), std::string::npos) << said;
}

// ---- positions, by the nodelet
// -----------------------------------------------------------------------------------

class OutputsOfPositions : public testing::Test {
 protected:
  void SetUp() override {
    geometry_msgs::TransformStamped mast = sightline_ros::transformMessage(
        ros::Time::now(), "world", "mast", Eigen::Vector3d(0.0, 0.0, 10.0), Eigen::Matrix3d::Identity());
    tf2_msgs::TFMessage fixed;
    fixed.transforms.push_back(mast);
    tf_.publish(fixed);
    ASSERT_TRUE(eventually([this] { return positions_.getNumSubscribers() == 1; }))
        << "the nodelet did not come up";
  }

  /// Targets that fly along x with 10 m/s, past the mast at 30 m; `sent_` is what was published.
  void report(const std::vector<std::uint32_t>& ids) {
    sent_ = stamped<PositionTrackArray>(ros::Time::now(), "world");
    const double x = 10.0 * (sent_.header.stamp - begin_).toSec();
    for (const std::uint32_t id : ids)
      sent_.tracks.push_back(positionTrack(id, {x, 30.0, 10.0 + id}, {10.0, 0.0, 0.0}));
    positions_.publish(sent_);
  }

  bool comesTrue(const std::vector<std::uint32_t>& ids, const std::function<bool()>& condition) {
    return eventually(
        condition, [&] { report(ids); }, ros::WallDuration(0.04));
  }

  ros::NodeHandle nh_;
  ros::Time begin_ = ros::Time::now();
  ros::Publisher tf_ = nh_.advertise<tf2_msgs::TFMessage>("/tf_static", 1, true);
  ros::Publisher positions_ = nh_.advertise<PositionTrackArray>("/positions/tracks", 100);
  PositionTrackArray sent_;
};

TEST_F(OutputsOfPositions, OdometryAndPathsFollowTheTargetsAndEndWithThem) {
  Received<nav_msgs::Odometry> odometry(nh_, "/position_outputs/odometry");
  Received<nav_msgs::Path> path(nh_, "/position_outputs/paths/target_3");
  tf2_ros::Buffer buffer;
  const tf2_ros::TransformListener listener(buffer, nh_, false);
  ASSERT_TRUE(comesTrue({3, 8}, [&] {
    return path.messages().size() > 5 && odometry.messages().size() > 20 &&
           buffer.canTransform("world", "target_3", ros::Time(0)) &&
           isAdvertised("/position_outputs/paths/target_8");
  }));
  const auto& poses = path.messages().back().poses;
  EXPECT_GE(poses.size(), 5u);
  for (const auto& pose : poses) {
    EXPECT_NEAR(pose.pose.position.x, 10.0 * (pose.header.stamp - begin_).toSec(), 1e-6);
    EXPECT_EQ(pose.pose.position.z, 13.0);
  }
  const auto& of_target = odometry.messages().back();
  EXPECT_TRUE(of_target.child_frame_id == "target_3" || of_target.child_frame_id == "target_8");
  EXPECT_NEAR(of_target.twist.twist.linear.x, 10.0, 1e-9);
  EXPECT_NEAR(of_target.pose.covariance[0], 0.01, 1e-12);
  const auto transform = buffer.lookupTransform("world", "target_3", ros::Time(0));
  EXPECT_NEAR(transform.transform.translation.x, 10.0 * (transform.header.stamp - begin_).toSec(), 1e-6);

  // Target 3 ends: no frame, no odometry, no path any more.
  Received<tf2_msgs::TFMessage> tf(nh_, "/tf");
  ASSERT_TRUE(comesTrue({8}, [&] { return !isAdvertised("/position_outputs/paths/target_3"); }));
  tf.forget();
  odometry.forget();
  ASSERT_TRUE(comesTrue({8}, [&] { return tf.messages().size() > 10 && odometry.messages().size() > 10; }));
  for (const auto& message : tf.messages())
    for (const auto& frame : message.transforms) EXPECT_NE(frame.child_frame_id, "target_3");
  for (const auto& message : odometry.messages()) EXPECT_EQ(message.child_frame_id, "target_8");
}

// roscpp counts in a header what has been published on its topic, listened to or not.
TEST_F(OutputsOfPositions, NothingIsSentWhileNobodyListens) {
  int reports = 0;
  ASSERT_TRUE(comesTrue({5}, [&] { return ++reports > 40; }));
  ASSERT_TRUE(comesTrue({5, 77}, [] { return isAdvertised("/position_outputs/paths/target_77"); }))
      << "the reports have not been taken";
  Received<sensor_msgs::PointCloud2> points(nh_, "/position_outputs/points");
  Received<geometry_msgs::PoseArray> poses(nh_, "/position_outputs/poses");
  Received<nav_msgs::Path> path(nh_, "/position_outputs/paths/target_77");
  ASSERT_TRUE(comesTrue({5, 77}, [&] {
    return points.messages().size() > 3 && poses.messages().size() > 3 && path.messages().size() > 3;
  }));
  EXPECT_LE(points.messages().front().header.seq, 1u);
  EXPECT_LE(poses.messages().front().header.seq, 1u);
  EXPECT_LE(path.messages().front().header.seq, 1u);
  EXPECT_EQ(points.messages()[3].header.seq, points.messages()[0].header.seq + 3u);  // it does count
}

TEST_F(OutputsOfPositions, TheHeadOnTheMastLooksAtTheOldest) {
  Received<geometry_msgs::QuaternionStamped> head(nh_, "/position_outputs/head");
  ASSERT_TRUE(comesTrue({3, 8}, [&] { return head.messages().size() > 50; }));
  const auto& last = head.messages().back();
  EXPECT_EQ(last.header.frame_id, "mast");
  const Eigen::Vector3d ray(10.0 * (last.header.stamp - begin_).toSec(), 30.0, 3.0);
  EXPECT_LT(core::angleBetween(along(last.quaternion), ray), 1e-6) << "predicted to the stamp";
}

TEST_F(OutputsOfPositions, WhatIsAbsurdIsLeftOutAndTheRestIsSent) {
  Received<geometry_msgs::PoseArray> poses(nh_, "/position_outputs/poses");
  ASSERT_TRUE(comesTrue({3, 8}, [&] { return !poses.messages().empty(); }));
  ASSERT_TRUE(eventually([&] { return poses.messages().back().poses.size() == 1; },
                         [&] {
                           auto message = stamped<PositionTrackArray>(ros::Time::now(), "world");
                           message.tracks = {positionTrack(3, {std::nan(""), 0.0, 0.0}, {0.0, 0.0, 0.0}),
                                             positionTrack(8, {5.0, 0.0, 0.0}, {0.0, 0.0, 0.0})};
                           positions_.publish(message);
                         },
                         ros::WallDuration(0.04)));
  EXPECT_EQ(poses.messages().back().poses[0].position.x, 5.0);
}

TEST(Outputs, WrongConfigurationEndsTheNodeWithOneLineAndExitCodeOne) {
  ros::NodeHandle nh;
  nh.setParam("/wrong/follow", "fastest");
  const auto [code, said] = outcomeOf("rosrun sightline track_outputs __name:=wrong");
  nh.deleteParam("/wrong");
  EXPECT_EQ(code, 1);
  EXPECT_NE(said.find("/wrong/follow: expected one of best, oldest, chosen"), std::string::npos) << said;
  EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 1) << said;
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "track_outputs_test");
  ros::NodeHandle keeps_ros_running;
  return RUN_ALL_TESTS();
}
