#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <ros/node_handle.h>
#include <ros/publisher.h>
#include <ros/subscriber.h>
#include <ros/wall_timer.h>
#include <sightline/TrackArray.h>
#include <sightline/TrackletArray.h>
#include <tf2/buffer_core.h>

#include "sightline/ros/components/position_tracker_component.h"
#include "sightline/ros/components/position_tracker_health.h"
#include "sightline/ros/diagnosis/callback_guard.h"
#include "sightline/ros/diagnosis/periodic_diagnostics.h"
#include "sightline/ros/diagnosis/transform_subscriber.h"
#include "sightline/ros/nodes/parameter_topic.h"

namespace sightline_ros {

/// Node and nodelet round a PositionTrackerComponent: every topic of `~track_topics` in, with the tracklets
/// beside each, and tf; `positions/tracks`, `positions/report`, `positions/poses` and /diagnostics out. Its
/// callbacks run on one queue, one at a time.
class PositionTrackerNode {
 public:
  /// Throws ParamError.
  PositionTrackerNode(const ros::NodeHandle& nh, const ros::NodeHandle& pnh);

 private:
  PositionTrackerNode(const ros::NodeHandle& nh, const ros::NodeHandle& pnh, const ParamReader& reader);

  void subscribe();
  void onTransforms();
  void publish(const std::vector<PositionResult>& results);
  void noticeTimeJump(sightline::core::Time now);

  ros::NodeHandle nh_;
  CallbackGuard guard_;
  tf2::BufferCore transforms_;
  PositionTrackerComponent component_;
  std::vector<std::string> topics_;           // full names
  std::vector<std::string> tracklet_topics_;  // likewise
  PositionTrackerHealth health_;
  ros::Publisher tracks_;
  ros::Publisher report_;
  ros::Publisher poses_;
  std::vector<ros::Subscriber> subscribers_;
  std::unique_ptr<TransformSubscriber> transform_subscriber_;
  ros::WallTimer timeout_timer_;
  std::optional<ParameterTopic> parameters_;
  std::optional<PeriodicDiagnostics> diagnostics_;
};

}  // namespace sightline_ros
