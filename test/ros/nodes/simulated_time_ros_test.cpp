// Truth publisher and sensor under a simulated clock that the test drives.
#include <cmath>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include <ros/ros.h>
#include <rosgraph_msgs/Clock.h>
#include <sightline/SightingArray.h>
#include <sightline/TrackArray.h>
#include <std_msgs/Time.h>
#include <tf2_msgs/TFMessage.h>
#include <tf2_ros/buffer.h>

#include "sightline/core/simulation/sensor_simulator.h"
#include "sightline/ros/messages/conversions.h"
#include "sightline/ros/nodes/pacer.h"
#include "sightline/ros/params/scenario_params.h"

#include "support/waiting.h"

namespace {

namespace core = sightline::core;
using sightline_ros::toCore;
using sightline_ros::toRos;

class SimulatedTime : public testing::Test {
 protected:
  SimulatedTime()
      : scenario_(sightline_ros::loadScenario(sightline_ros::ParamReader(ros::NodeHandle("/scenario")))),
        clock_(nh_.advertise<rosgraph_msgs::Clock>("/clock", 100)),
        sightings_(nh_.subscribe<sightline::SightingArray>(
            "sightings", 10000,
            [this](const sightline::SightingArray::ConstPtr& scan) { scans_.push_back(scan); })),
        truth_(nh_.subscribe<sightline::TrackArray>(
            "/truth", 10000,
            [this](const sightline::TrackArray::ConstPtr& tracks) { truths_.push_back(tracks); })),
        start_subscriber_(nh_.subscribe<std_msgs::Time>(
            "/scenario/start", 1, [this](const std_msgs::Time::ConstPtr& start) { start_ = start->data; })) {}

  void setClock(const ros::Time& now) {
    rosgraph_msgs::Clock message;
    message.clock = now;
    clock_.publish(message);
  }

  /// How many scans and truths are due at `now`.
  std::size_t scansDue(const ros::Time& now) const {
    core::SensorSimulator simulator(scenario_, "eye", toCore(start_));
    std::size_t due = 0;
    while (toRos(simulator.next()->publish_time) <= now) ++due;
    return due;
  }
  std::size_t truthsDue(const ros::Time& now) const {
    return now < start_
               ? 0
               : static_cast<std::size_t>((toCore(now) - toCore(start_)) / std::chrono::milliseconds(10)) + 1;
  }

  ros::NodeHandle nh_;
  core::Scenario scenario_;
  std::vector<sightline::SightingArray::ConstPtr> scans_;
  std::vector<sightline::TrackArray::ConstPtr> truths_;
  ros::Time start_;
  ros::Publisher clock_;
  ros::Subscriber sightings_, truth_, start_subscriber_;
};

TEST_F(SimulatedTime, EverythingComesAtItsTimeAndNothingIsLeftOut) {
  ASSERT_TRUE(eventually([&] {
    return clock_.getNumSubscribers() >= 3 && sightings_.getNumPublishers() > 0 &&
           truth_.getNumPublishers() > 0;
  })) << "a node is missing";

  const ros::Time begin(1000.0);
  ASSERT_TRUE(eventually([&] {
    setClock(begin);
    return !start_.isZero();
  })) << "no start under simulated time";
  EXPECT_EQ(start_, begin + ros::Duration(0.5));

  // Through the start in small steps, then on in jumps of 200 ms, many scans each.
  for (int step = 1; step <= 40; ++step) {
    const ros::Time now = begin + ros::Duration(step <= 20 ? 0.03 * step : 0.6 + 0.2 * (step - 20));
    setClock(now);
    const std::size_t scans = scansDue(now), truths = truthsDue(now);
    // Said again while waiting: a node whose subscription comes up now would miss it.
    ASSERT_TRUE(eventually([&] {
      setClock(now);
      return scans_.size() >= scans && truths_.size() >= truths;
    })) << scans_.size()
        << " of " << scans << " scans, " << truths_.size() << " of " << truths << " truths";
    ASSERT_EQ(scans_.size(), scans) << "a scan came before its time";
    ASSERT_EQ(truths_.size(), truths) << "a truth came before its time";
  }
  EXPECT_GT(scans_.size(), 100U);

  core::SensorSimulator simulator(scenario_, "eye", toCore(start_));
  for (const auto& scan : scans_) EXPECT_EQ(scan->header.stamp, toRos(simulator.next()->scan.time));
}

TEST_F(SimulatedTime, WorkIsDoneAtItsTimeThoughTheClockJumpsPastItAndStandsStillThere) {
  const ros::Time begin(5000.0);
  const auto jumpTo = [&](const ros::Time& now) {
    return eventually([&] {
      setClock(now);
      return ros::Time::now() == now;
    });
  };
  ASSERT_TRUE(jumpTo(begin));
  std::vector<ros::Time> runs;
  sightline_ros::Pacer pacer(nh_, [&](const ros::Time& now) -> std::optional<ros::Time> {
    runs.push_back(now);
    if (runs.size() == 1) {  // while the work is done, the clock goes past the time that it asks for
      setClock(begin + ros::Duration(0.3));
      while (ros::Time::now() == begin && ros::ok())
        ros::WallDuration(0.001).sleep();  // a callback: none can be served here
      return begin + ros::Duration(0.1);
    }
    if (runs.size() == 2) return begin + ros::Duration(0.4);
    return std::nullopt;
  });
  pacer.wake();
  ASSERT_TRUE(eventually([&] { return runs.size() == 2; })) << "asked for a time that has passed";
  ASSERT_TRUE(jumpTo(begin + ros::Duration(0.4)));
  ASSERT_TRUE(eventually([&] { return runs.size() == 3; })) << "the clock stands at the time asked for";
  EXPECT_EQ(runs, (std::vector<ros::Time>{begin, begin + ros::Duration(0.3), begin + ros::Duration(0.4)}));
}

TEST_F(SimulatedTime, FixedPlatformIsKnownAtEveryTime) {
  tf2_ros::Buffer transforms;
  const ros::Subscriber subscriber = nh_.subscribe<tf2_msgs::TFMessage>(
      "/tf_static", 100, [&](const tf2_msgs::TFMessage::ConstPtr& message) {
        for (const auto& transform : message->transforms) transforms.setTransform(transform, "test", true);
      });
  const ros::Time any(123.0);
  ASSERT_TRUE(eventually([&] {
    return transforms.canTransform("world", "eye", any) &&
           transforms.canTransform("world", "platform_enu", any);
  }));
  EXPECT_EQ(transforms.lookupTransform("world", "platform", any).transform.translation.y, 2.0);
  EXPECT_EQ(transforms.lookupTransform("world", "platform_enu", any).transform.rotation.w, 1.0);
  EXPECT_NEAR(transforms.lookupTransform("platform_enu", "eye", any).transform.rotation.z, std::sin(0.25),
              1e-12);
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "simulated_time_ros_test");
  ros::NodeHandle keep_alive;
  return RUN_ALL_TESTS();
}
