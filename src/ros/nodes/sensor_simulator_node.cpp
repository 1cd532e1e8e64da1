#include "sightline/ros/nodes/sensor_simulator_node.h"

#include <algorithm>

#include <ros/console.h>
#include <sightline/SightingArray.h>

#include "sightline/ros/messages/clock.h"
#include "sightline/ros/messages/conversions.h"
#include "sightline/ros/messages/scenario_messages.h"
#include "sightline/ros/messages/transform_messages.h"
#include "sightline/ros/nodes/this_node.h"
#include "sightline/ros/params/scenario_params.h"

namespace sightline_ros {
namespace {

namespace core = sightline::core;

constexpr auto kLongestBacklog = std::chrono::seconds(1);  // published late rather than left out

const core::SimulatedSensor& sensorNamed(const core::Scenario& scenario, const ParamReader& reader) {
  const std::string name = reader.requiredText("sensor");
  std::string known;
  for (const core::SimulatedSensor& sensor : scenario.sensors) {
    if (sensor.name == name) return sensor;
    known += (known.empty() ? "" : ", ") + sensor.name;
  }
  throw reader.error("sensor", "expected a sensor of /scenario/sensors (" +
                                   (known.empty() ? "there is none" : known) + "), got the string \"" + name +
                                   "\"");
}

}  // namespace

SensorSimulatorNode::SensorSimulatorNode(const ros::NodeHandle& nh, const ros::NodeHandle& pnh)
    : SensorSimulatorNode(nh, pnh, ParamReader(pnh)) {}

SensorSimulatorNode::SensorSimulatorNode(ros::NodeHandle nh, const ros::NodeHandle& pnh,
                                         const ParamReader& reader)
    : scenario_(loadScenario(ParamReader(ros::NodeHandle("/scenario")))),
      sensor_(sensorNamed(scenario_, reader).name),
      pacer_(pnh, [this](const ros::Time& now) { return publishDue(now); }) {
  const std::optional<ros::Time> start = loadStartTime(reader);
  reader.finish();

  sightings_ = nh.advertise<sightline::SightingArray>("sightings", kQueue);
  broadcastMount();
  repetition_ = nh.createWallTimer(ros::WallDuration(kSecondsBetweenStaticTransforms),
                                   [this](const ros::WallTimerEvent&) { broadcastMount(); });
  if (start)
    startAt(*start);
  else
    start_subscriber_ = nh.subscribe("/scenario/start", 1, &SensorSimulatorNode::onStart, this);
}

void SensorSimulatorNode::onStart(const std_msgs::Time& start) {
  if (start_ != start.data) startAt(start.data);
}

void SensorSimulatorNode::startAt(const ros::Time& start) {
  ROS_INFO_STREAM(sensor_ << ": time zero of the scenario is " << start);
  start_ = start;
  simulator_.emplace(scenario_, sensor_, toCore(start));
  upcoming_ = simulator_->next();
  skipMissed();
  pacer_.wake();
}

/// A node that joins late does not make up for what it has missed.
void SensorSimulatorNode::skipMissed() {
  const core::Time now = clockNow();
  int missed = 0;
  for (; upcoming_ && upcoming_->publish_time + kLongestBacklog < now; ++missed)
    upcoming_ = simulator_->next();
  if (missed > 0) ROS_INFO_STREAM(sensor_ << ": joins late and leaves out " << missed << " scans");
}

std::optional<ros::Time> SensorSimulatorNode::publishDue(const ros::Time& now) {
  for (; upcoming_ && toRos(upcoming_->publish_time) <= now; upcoming_ = simulator_->next()) {
    sightings_.publish(toMessage(upcoming_->scan, sensor_));
  }
  if (upcoming_) return toRos(upcoming_->publish_time);
  if (simulator_) ROS_INFO_STREAM(sensor_ << ": the scenario is over");
  return std::nullopt;
}

void SensorSimulatorNode::broadcastMount() {
  const auto sensor =
      std::find_if(scenario_.sensors.begin(), scenario_.sensors.end(),
                   [this](const core::SimulatedSensor& other) { return other.name == sensor_; });
  static_transforms_.sendTransform(mountTransform(*sensor, ros::Time::now()));
}

}  // namespace sightline_ros
