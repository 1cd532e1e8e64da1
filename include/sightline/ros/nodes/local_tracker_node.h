#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <ros/node_handle.h>
#include <ros/publisher.h>
#include <ros/subscriber.h>
#include <ros/wall_timer.h>
#include <sightline/SightingArray.h>
#include <tf2/buffer_core.h>

#include "sightline/ros/components/live_smoothing.h"
#include "sightline/ros/components/local_tracker_component.h"
#include "sightline/ros/components/local_tracker_health.h"
#include "sightline/ros/diagnosis/callback_guard.h"
#include "sightline/ros/diagnosis/periodic_diagnostics.h"
#include "sightline/ros/diagnosis/transform_subscriber.h"
#include "sightline/ros/nodes/parameter_topic.h"
#include "sightline/ros/nodes/reconfigure_server.h"

namespace sightline_ros {

/// Node and nodelet round a LocalTrackerComponent: every topic of `~sighting_topics` in; `tracks`,
/// `tracklets`, `associations`, `tracks_smoothed` (with a `smoothing_lag`) and /diagnostics out; parameters
/// change by dynamic_reconfigure. Its callbacks run on one queue, one at a time.
class LocalTrackerNode {
 public:
  /// Throws ParamError.
  LocalTrackerNode(const ros::NodeHandle& nh, const ros::NodeHandle& pnh);

 private:
  LocalTrackerNode(const ros::NodeHandle& nh, const ros::NodeHandle& pnh, const ParamReader& reader);

  void subscribe(const std::vector<std::string>& topics);
  void onScan(const sightline::SightingArray::ConstPtr& scan);
  void onTransforms();
  void onTimer();
  void publish(const std::vector<TrackerReport>& reports);
  void publishSmoothed(const LiveSmoothing::Messages& messages);
  void warnOf(const TrackerReport& report);
  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status);

  ros::NodeHandle nh_;
  CallbackGuard guard_;
  tf2::BufferCore transforms_;
  LocalTrackerComponent component_;
  LocalTrackerHealth health_;
  std::optional<LiveSmoothing> smoothing_;  // where a lag is given
  ros::Publisher tracks_;
  ros::Publisher tracklets_;
  ros::Publisher associations_;
  ros::Publisher smoothed_;
  std::vector<ros::Subscriber> sightings_;
  std::unique_ptr<TransformSubscriber> transform_subscriber_;
  ros::WallTimer timeout_timer_;
  std::optional<ParameterTopic> parameters_;
  std::optional<ReconfigureServer> reconfigure_server_;
  std::optional<PeriodicDiagnostics> diagnostics_;
};

}  // namespace sightline_ros
