// The sensors' nodes against the core: the same sightings, with the stamps of exposure, not before their
// time.
#include <functional>
#include <map>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <ros/ros.h>
#include <sightline/SightingArray.h>
#include <std_msgs/Time.h>
#include <tf2_msgs/TFMessage.h>
#include <tf2_ros/buffer.h>

#include "sightline/core/model/sphere.h"
#include "sightline/core/simulation/sensor_simulator.h"
#include "sightline/ros/messages/conversions.h"
#include "sightline/ros/params/scenario_params.h"

#include "support/waiting.h"

namespace {

namespace core = sightline::core;
using sightline_ros::toCore;
using sightline_ros::toRos;

constexpr std::size_t kScans = 40;

core::Scenario scenario() {
  return sightline_ros::loadScenario(sightline_ros::ParamReader(ros::NodeHandle("/scenario")));
}

/// The scans of one topic, and when they came.
class Listener {
 public:
  Listener(ros::NodeHandle& nh, const std::string& topic)
      : subscriber_(nh.subscribe(topic, 1000, &Listener::onScan, this)) {}

  bool connected() const { return subscriber_.getNumPublishers() > 0; }
  std::size_t count() const { return scans_.size(); }

  /// Forgets everything, and ignores what is stamped before `start`: the rest of an earlier run.
  void listenFrom(const ros::Time& start) {
    start_ = start;
    scans_.clear();
    arrivals_.clear();
  }

  /// Compares the first scans with those of the core.
  void expectScansOf(const std::string& sensor, const ros::Time& start) const {
    core::SensorSimulator simulator(scenario(), sensor, toCore(start));
    ASSERT_GE(scans_.size(), kScans);
    for (std::size_t i = 0; i < kScans; ++i) {
      const core::SimulatedScan expected = *simulator.next();
      expectSame(*scans_[i], expected.scan);
      EXPECT_GE(arrivals_[i], toRos(expected.publish_time)) << sensor << ", scan " << i;
    }
  }

 private:
  void onScan(const sightline::SightingArray::ConstPtr& scan) {
    if (scan->header.stamp < start_) return;
    arrivals_.push_back(ros::Time::now());
    scans_.push_back(scan);
  }

  static void expectSame(const sightline::SightingArray& got, const core::Scan& expected) {
    EXPECT_EQ(got.header.stamp, toRos(expected.time));
    EXPECT_EQ(got.header.frame_id, expected.sensor);
    EXPECT_EQ(got.sensor, expected.sensor);
    EXPECT_EQ(got.ifov, 0.004);
    EXPECT_EQ(got.detection_probability, 0.9);
    EXPECT_EQ(got.clutter_density, 0.3);
    ASSERT_EQ(got.sightings.size(), expected.sightings.size());
    for (std::size_t i = 0; i < got.sightings.size(); ++i) {
      const Eigen::Vector2d angles = core::anglesOf(expected.sightings[i].direction);
      EXPECT_EQ(got.sightings[i].azimuth, angles.x());
      EXPECT_EQ(got.sightings[i].elevation, angles.y());
      EXPECT_NEAR(got.sightings[i].covariance[0], 4e-4, 1e-12);
      EXPECT_NEAR(got.sightings[i].covariance[3], 1e-4, 1e-12);
    }
  }

  ros::Time start_;
  ros::Subscriber subscriber_;
  std::vector<sightline::SightingArray::ConstPtr> scans_;
  std::vector<ros::Time> arrivals_;
};

TEST(SensorSimulatorNode, PlaysTheScansOfTheCoreAsNodeAndAsNodelet) {
  ros::NodeHandle nh;
  std::map<std::string, Listener> listeners;
  for (const std::string sensor : {"eye", "ear"}) {
    for (const std::string kind : {"nodes", "nodelets"}) {
      const std::string topic = "/" + kind + "/" + sensor + "/sightings";
      listeners.emplace(std::piecewise_construct, std::forward_as_tuple(topic),
                        std::forward_as_tuple(nh, topic));
    }
  }
  const auto all = [&](const std::function<bool(Listener&)>& holds) {
    for (auto& listener : listeners) {
      if (!holds(listener.second)) return false;
    }
    return true;
  };
  ros::Publisher starter = nh.advertise<std_msgs::Time>("/scenario/start", 1, true);
  ASSERT_TRUE(eventually([&] { return all([](Listener& l) { return l.connected(); }); }))
      << "a node is missing";
  ASSERT_TRUE(eventually([&] { return starter.getNumSubscribers() >= 3; }));  // two nodes and the manager
  EXPECT_TRUE(all([](Listener& l) { return l.count() == 0; })) << "a sensor did not wait for the start";

  // A second start, as of a truth publisher that was started again, begins everything anew.
  for (int run = 0; run < 2; ++run) {
    std_msgs::Time start;
    start.data = ros::Time::now() + ros::Duration(2.0);
    for (auto& listener : listeners) listener.second.listenFrom(start.data);
    starter.publish(start);
    ASSERT_TRUE(eventually([&] { return all([](Listener& l) { return l.count() >= kScans; }); }));
    for (const auto& listener : listeners) {
      SCOPED_TRACE(listener.first);
      listener.second.expectScansOf(listener.first.find("eye") != std::string::npos ? "eye" : "ear",
                                    start.data);
    }
  }
}

TEST(SensorSimulatorNode, MountsOfAllSensorsAreKnownToLateListeners) {
  ros::NodeHandle nh;
  tf2_ros::Buffer transforms;
  const ros::Subscriber subscriber =
      nh.subscribe<tf2_msgs::TFMessage>("/tf_static", 100, [&](const tf2_msgs::TFMessage::ConstPtr& message) {
        for (const auto& transform : message->transforms) transforms.setTransform(transform, "test", true);
      });
  const auto known = scenario();
  for (const core::SimulatedSensor& sensor : known.sensors) {
    ASSERT_TRUE(eventually([&] { return transforms.canTransform("platform", sensor.name, ros::Time(0)); }))
        << sensor.name;
    const auto transform = transforms.lookupTransform("platform", sensor.name, ros::Time(0)).transform;
    const Eigen::Quaterniond turn(transform.rotation.w, transform.rotation.x, transform.rotation.y,
                                  transform.rotation.z);
    EXPECT_LT((turn.toRotationMatrix() - core::R_platform_sensor(sensor)).norm(), 1e-12);
    const Eigen::Vector3d position(transform.translation.x, transform.translation.y, transform.translation.z);
    EXPECT_EQ(position, sensor.mount_position);
  }
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "sensor_simulator_ros_test");
  ros::NodeHandle keep_alive;
  return RUN_ALL_TESTS();
}
