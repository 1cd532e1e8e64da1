#pragma once

#include <optional>
#include <string>

#include <ros/node_handle.h>
#include <ros/publisher.h>
#include <ros/subscriber.h>
#include <ros/time.h>
#include <ros/wall_timer.h>
#include <std_msgs/Time.h>
#include <tf2_ros/static_transform_broadcaster.h>

#include "sightline/core/simulation/scenario.h"
#include "sightline/core/simulation/sensor_simulator.h"
#include "sightline/ros/nodes/pacer.h"
#include "sightline/ros/params/param_reader.h"

namespace sightline_ros {

/// Node and nodelet that plays one sensor of the scenario in /scenario: `sightings` (SightingArray), stamped
/// with the time of exposure and published after the sensor's latency, and the sensor's static transform.
///
/// Private parameters: `~sensor` (which one; required) and `~start_time` (the scenario's time zero [s since
/// the epoch of ROS's clock]; without it the node waits for /scenario/start).
class SensorSimulatorNode {
 public:
  /// Throws ParamError.
  SensorSimulatorNode(const ros::NodeHandle& nh, const ros::NodeHandle& pnh);

 private:
  SensorSimulatorNode(ros::NodeHandle nh, const ros::NodeHandle& pnh, const ParamReader& reader);

  void onStart(const std_msgs::Time& start);
  void startAt(const ros::Time& start);
  void skipMissed();
  std::optional<ros::Time> publishDue(const ros::Time& now);
  void broadcastMount();

  sightline::core::Scenario scenario_;
  std::string sensor_;
  std::optional<ros::Time> start_;
  std::optional<sightline::core::SensorSimulator> simulator_;
  std::optional<sightline::core::SimulatedScan> upcoming_;
  ros::Publisher sightings_;
  ros::Subscriber start_subscriber_;
  tf2_ros::StaticTransformBroadcaster static_transforms_;
  ros::WallTimer repetition_;  // of the static transforms
  Pacer pacer_;
};

}  // namespace sightline_ros
