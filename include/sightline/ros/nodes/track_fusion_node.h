#pragma once

#include <optional>
#include <string>
#include <vector>

#include <ros/node_handle.h>
#include <ros/publisher.h>
#include <ros/subscriber.h>
#include <ros/timer.h>
#include <sightline/TrackArray.h>
#include <sightline/TrackletArray.h>
#include <tf2/buffer_core.h>

#include "sightline/ros/components/track_fusion_component.h"
#include "sightline/ros/components/track_fusion_health.h"
#include "sightline/ros/diagnosis/callback_guard.h"
#include "sightline/ros/diagnosis/periodic_diagnostics.h"
#include "sightline/ros/diagnosis/transform_subscriber.h"
#include "sightline/ros/nodes/parameter_topic.h"
#include "sightline/ros/nodes/reconfigure_server.h"

namespace sightline_ros {

/// Node and nodelet round a TrackFusionComponent: every topic of `~track_topics` in, with the tracklets
/// beside each; `fusion/tracks`, `fusion/report` and /diagnostics out; parameters change by
/// dynamic_reconfigure. Its callbacks run on one queue, one at a time.
class TrackFusionNode {
 public:
  /// Throws ParamError.
  TrackFusionNode(const ros::NodeHandle& nh, const ros::NodeHandle& pnh);

 private:
  TrackFusionNode(const ros::NodeHandle& nh, const ros::NodeHandle& pnh, const ParamReader& reader);

  void onTracks(const sightline::TrackArray::ConstPtr& local, const std::string& topic);
  void onTracklets(const sightline::TrackletArray::ConstPtr& local, const std::string& topic);
  void onEndOfWait();
  void timeWait();
  void publish(const FusionResult& result, sightline::core::Time now);
  std::optional<sightline::core::Refusal> reconfigure(const ParamReader& changed);
  void followRule();
  void noticeTimeJump(sightline::core::Time now);

  ros::NodeHandle nh_;
  CallbackGuard guard_;
  tf2::BufferCore transforms_;
  TransformSubscriber transform_subscriber_;
  TrackFusionComponent component_;
  std::vector<std::string> topics_;           // full names
  std::vector<std::string> tracklet_topics_;  // likewise
  TrackFusionHealth health_;
  ros::Publisher tracks_;
  ros::Publisher report_;
  std::vector<ros::Subscriber> subscribers_;
  ros::Timer end_of_wait_;                             // of reports for others
  bool is_wait_timed_ = false;                         // the timer runs
  std::vector<ros::Subscriber> tracklet_subscribers_;  // none while the rule makes no use of tracklets
  std::optional<ParameterTopic> parameters_;
  std::optional<ReconfigureServer> reconfigure_server_;
  std::optional<PeriodicDiagnostics> diagnostics_;
};

}  // namespace sightline_ros
