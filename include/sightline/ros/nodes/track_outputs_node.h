#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <topic_tools/shape_shifter.h>

#include <Eigen/Geometry>

#include <ros/node_handle.h>
#include <ros/publisher.h>
#include <ros/subscriber.h>
#include <ros/timer.h>
#include <std_msgs/UInt32.h>
#include <tf2/buffer_core.h>

#include "sightline/ros/diagnosis/callback_guard.h"
#include "sightline/ros/diagnosis/periodic_diagnostics.h"
#include "sightline/ros/diagnosis/transform_subscriber.h"
#include "sightline/ros/outputs/track_outputs_component.h"
#include "sightline/ros/outputs/track_outputs_health.h"
#include "sightline/ros/params/param_reader.h"

namespace sightline_ros {

/// Node and nodelet round a TrackOutputsComponent: one topic of tracks in, of directions or positions;
/// standard messages and tf out, each only while somebody listens. `~choose` (std_msgs/UInt32) tells the
/// pan-tilt head which track to follow.
class TrackOutputsNode {
 public:
  /// Throws ParamError.
  TrackOutputsNode(const ros::NodeHandle& nh, const ros::NodeHandle& pnh);

 private:
  TrackOutputsNode(const ros::NodeHandle& nh, const ros::NodeHandle& pnh, const ParamReader& reader);

  void onMessage(const topic_tools::ShapeShifter& message);
  void publish(const OutputResult& result);
  void publishOfEach(const OutputResult& result);
  void aimHead();
  std::optional<Eigen::Isometry3d> headFromTracks() const;

  ros::NodeHandle pnh_;
  std::string name_;
  CallbackGuard guard_;
  TrackOutputsComponent component_;
  std::string topic_;  // full name
  TrackOutputsHealth health_;
  std::string tracks_frame_;  // of the last message
  tf2::BufferCore transforms_;
  std::optional<TransformSubscriber> transform_subscriber_;  // where the head's frame is another one
  ros::Publisher tf_, poses_, points_, odometry_, head_;
  std::map<std::uint32_t, ros::Publisher> of_tracks_;  // a direction or a path for each track that there is
  std::optional<std::uint32_t> followed_;              // as last said in the log
  ros::Subscriber choose_, tracks_;
  ros::Timer head_timer_;
  std::optional<PeriodicDiagnostics> diagnostics_;
};

}  // namespace sightline_ros
