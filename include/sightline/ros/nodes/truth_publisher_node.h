#pragma once

#include <optional>

#include <ros/node_handle.h>
#include <ros/publisher.h>
#include <ros/time.h>
#include <ros/wall_timer.h>
#include <tf2_ros/static_transform_broadcaster.h>
#include <tf2_ros/transform_broadcaster.h>

#include "sightline/core/simulation/scenario.h"
#include "sightline/core/simulation/sighting_sequence.h"
#include "sightline/ros/nodes/pacer.h"
#include "sightline/ros/params/param_reader.h"

namespace sightline_ros {

/// Node and nodelet that owns the time of the scenario in /scenario. It announces the scenario's time zero
/// (/scenario/start, std_msgs/Time, latched), and publishes where the targets truly are (/truth, TrackArray
/// in platform_enu, covariance zero; with stations also /truth/positions, PositionTrackArray in world) and
/// the transforms of the platform and of the stations, world -> platform, platform_enu, <station> and
/// <station>_enu.
///
/// Private parameters: `~rate` (of truth and of moving transforms, default 100 Hz),
/// `~start_delay` (from construction to time zero, so that the other nodes are there, default 1 s),
/// `~start_time` (time zero itself [s since the epoch of ROS's clock], instead of the delay).
class TruthPublisherNode {
 public:
  /// Throws ParamError.
  TruthPublisherNode(const ros::NodeHandle& nh, const ros::NodeHandle& pnh);

 private:
  TruthPublisherNode(ros::NodeHandle nh, const ros::NodeHandle& pnh, const ParamReader& reader);

  std::optional<ros::Time> onPace(const ros::Time& now);
  void begin(const ros::Time& now);
  void publishTruth(double time, const ros::Time& stamp);
  void publishFixedTransforms();

  sightline::core::Scenario scenario_;
  double start_delay_;              // [s]
  std::optional<ros::Time> start_;  // time zero of the scenario, once it is known
  bool begun_ = false;
  sightline::core::SightingSequence instants_;
  sightline::core::Duration upcoming_{};  // since time zero
  ros::Publisher start_publisher_;
  ros::Publisher truth_;
  ros::Publisher position_truth_;  // of a scenario with stations
  tf2_ros::StaticTransformBroadcaster static_transforms_;
  ros::WallTimer repetition_;  // of the static transforms
  tf2_ros::TransformBroadcaster transforms_;
  Pacer pacer_;
};

}  // namespace sightline_ros
