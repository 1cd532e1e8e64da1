// The truth as it is published against the core's, and the platform's transforms with it.
#include <algorithm>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <ros/ros.h>
#include <rosgraph_msgs/Clock.h>
#include <sightline/TrackArray.h>
#include <std_msgs/Time.h>
#include <tf2_msgs/TFMessage.h>
#include <tf2_ros/buffer.h>

#include "sightline/core/simulation/scenario.h"
#include "sightline/ros/messages/conversions.h"
#include "sightline/ros/params/scenario_params.h"

#include "support/waiting.h"

namespace {

namespace core = sightline::core;
using sightline_ros::toCore;

/// Everything the node says in the scenario's three seconds.
class TruthPublisherNode : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    ros::NodeHandle nh;
    scenario_ = new core::Scenario(
        sightline_ros::loadScenario(sightline_ros::ParamReader(ros::NodeHandle("/scenario"))));
    transforms_ = new tf2_ros::Buffer();
    const ros::Subscriber truth = nh.subscribe<sightline::TrackArray>(
        "/truth", 1000, +[](const sightline::TrackArray::ConstPtr& message) { truth_.push_back(message); });
    const ros::Subscriber tf = nh.subscribe<tf2_msgs::TFMessage>(
        "/tf", 1000, +[](const tf2_msgs::TFMessage::ConstPtr& m) {
          for (const auto& transform : m->transforms) transforms_->setTransform(transform, "test", false);
        });
    const ros::Subscriber start = nh.subscribe<std_msgs::Time>(
        "/scenario/start", 1, +[](const std_msgs::Time::ConstPtr& message) { start_ = message->data; });
    const ros::Publisher clock = nh.advertise<rosgraph_msgs::Clock>("/clock", 100);
    eventually([&] {
      return truth.getNumPublishers() > 0 && tf.getNumPublishers() > 0 && clock.getNumSubscribers() > 1;
    });
    for (int step = 0; step <= 100 && truth_.size() < 300; ++step) {
      rosgraph_msgs::Clock now;
      now.clock = ros::Time(5000.0) + ros::Duration(0.04 * step);
      clock.publish(now);
      eventually([&] { return !start_.isZero() && truth_.size() >= due(now.clock); });
    }
  }

  static void TearDownTestSuite() {
    delete scenario_;
    delete transforms_;
    truth_.clear();
  }

  void SetUp() override {
    ASSERT_EQ(truth_.size(), 300U) << "the node has not published three seconds of truth";
  }

  /// How many truths there must be at `now`.
  static std::size_t due(const ros::Time& now) {
    if (now < start_) return 0;
    return std::min<std::size_t>(300, (toCore(now) - toCore(start_)) / std::chrono::milliseconds(10) + 1);
  }

  static double sinceStart(const ros::Time& stamp) { return core::seconds(toCore(stamp) - toCore(start_)); }

  static core::Scenario* scenario_;
  static tf2_ros::Buffer* transforms_;
  static std::vector<sightline::TrackArray::ConstPtr> truth_;
  static ros::Time start_;
};

core::Scenario* TruthPublisherNode::scenario_ = nullptr;
tf2_ros::Buffer* TruthPublisherNode::transforms_ = nullptr;
std::vector<sightline::TrackArray::ConstPtr> TruthPublisherNode::truth_;
ros::Time TruthPublisherNode::start_;

TEST_F(TruthPublisherNode, StampsCountFromTheLatchedStartWithoutDrift) {
  ASSERT_FALSE(start_.isZero()) << "/scenario/start is not latched";
  for (std::size_t i = 0; i < truth_.size(); ++i) {
    EXPECT_EQ((toCore(truth_[i]->header.stamp) - toCore(start_)).count(),
              static_cast<std::int64_t>(i) * 10000000);
  }
}

TEST_F(TruthPublisherNode, TracksAreTheTargetsThatAreThere) {
  std::size_t with_second = 0;
  for (const auto& message : truth_) {
    EXPECT_EQ(message->header.frame_id, "platform_enu");
    EXPECT_EQ(message->tracker, "truth");
    EXPECT_EQ(message->estimator, "truth");
    const double time = sinceStart(message->header.stamp);
    std::vector<std::uint32_t> expected{2, 4};  // ascending
    if (time < 0.5 || time >= 1.25) expected = {4};
    std::vector<std::uint32_t> ids;
    for (const sightline::Track& track : message->tracks) ids.push_back(track.id);
    EXPECT_EQ(ids, expected) << time;
    with_second += ids.size() == 2;
  }
  EXPECT_EQ(with_second, 75U);
}

TEST_F(TruthPublisherNode, StatesAreExactWithCovarianceZero) {
  for (const auto& message : truth_) {
    for (const sightline::Track& track : message->tracks) {
      const core::Target& target = scenario_->targets[track.id == 4 ? 1 : 0];
      const core::AngularState expected =
          *core::truthAt(*scenario_, target, sinceStart(message->header.stamp));
      EXPECT_EQ(track.azimuth, expected.mean(0));
      EXPECT_EQ(track.elevation, expected.mean(1));
      EXPECT_EQ(track.azimuth_rate, expected.mean(2));
      EXPECT_EQ(track.elevation_rate, expected.mean(3));
      EXPECT_EQ(track.status, sightline::Track::CONFIRMED);
      for (const double element : track.covariance) EXPECT_EQ(element, 0.0);
    }
  }
}

TEST_F(TruthPublisherNode, TransformsFollowThePlatformAtEachStamp) {
  const ros::Time last = truth_.back()->header.stamp;
  ASSERT_TRUE(eventually([&] { return transforms_->canTransform("world", "platform", last); }));
  for (const double time : {0.0, 0.5, 1.234, 2.99}) {
    const core::PlatformState platform = core::platformAt(scenario_->platform, time);
    for (const char* frame : {"platform", "platform_enu"}) {
      const auto pose = transforms_->lookupTransform("world", frame, start_ + ros::Duration(time)).transform;
      const Eigen::Vector3d position(pose.translation.x, pose.translation.y, pose.translation.z);
      const Eigen::Quaterniond turn(pose.rotation.w, pose.rotation.x, pose.rotation.y, pose.rotation.z);
      const bool turns = std::string(frame) == "platform";
      const Eigen::Matrix3d R = turns ? platform.R_world_platform : Eigen::Matrix3d::Identity();
      // Between two stamps, 10 ms apart, the way is a chord: off by less than r w^2 dt^2 / 8 = 2.4 mm.
      EXPECT_LT((position - platform.position).norm(), 0.003) << frame << " at " << time;
      EXPECT_LT((turn.toRotationMatrix() - R).norm(), 1e-5) << frame << " at " << time;
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "truth_publisher_ros_test");
  ros::NodeHandle keep_alive;
  return RUN_ALL_TESTS();
}
