#include "sightline/ros/nodes/position_tracker_node.h"

#include <geometry_msgs/PoseArray.h>
#include <ros/console.h>
#include <sightline/PositionReport.h>
#include <sightline/PositionTrackArray.h>

#include "sightline/ros/components/component_params.h"
#include "sightline/ros/messages/clock.h"
#include "sightline/ros/nodes/this_node.h"
#include "sightline/ros/nodes/track_topics.h"

namespace sightline_ros {
PositionTrackerNode::PositionTrackerNode(const ros::NodeHandle& nh, const ros::NodeHandle& pnh)
    : PositionTrackerNode(nh, pnh, ParamReader(pnh)) {}

PositionTrackerNode::PositionTrackerNode(const ros::NodeHandle& nh, const ros::NodeHandle& pnh,
                                         const ParamReader& reader)
    : nh_(nh),
      guard_(nameOfNode(pnh)),
      component_(reader, nameOfNode(pnh), transforms_),
      topics_(trackTopicsFrom(reader, nh)),
      tracklet_topics_(trackletTopicsFrom(reader, nh, topics_)),
      health_(topics_, silenceFrom(reader)) {
  reader.finish();
  parameters_.emplace(pnh, reader);

  tracks_ = nh_.advertise<sightline::PositionTrackArray>("positions/tracks", kQueue);
  report_ = nh_.advertise<sightline::PositionReport>("positions/report", kQueue);
  poses_ = nh_.advertise<geometry_msgs::PoseArray>("positions/poses", kQueue);
  transform_subscriber_ =
      std::make_unique<TransformSubscriber>(nh_, transforms_, guard_("/tf", [this] { onTransforms(); }));
  timeout_timer_ =
      nh_.createWallTimer(ros::WallDuration(kSecondsBetweenTimeoutChecks),
                          guard_("a timer", [this](const ros::WallTimerEvent&) { onTransforms(); }));
  diagnostics_.emplace(nh, pnh, "positions", [this](auto& status, double) {
    health_.diagnose(clockNow(), component_.stations(), component_.waiting(), status);
    guard_.diagnose(status);
  });
  subscribe();
}

void PositionTrackerNode::subscribe() {
  std::string all;
  for (const std::string& topic : topics_) {
    subscribers_.push_back(nh_.subscribe<sightline::TrackArray>(
        topic, kQueue,
        guard_(topic,
               [this, topic](const sightline::TrackArray::ConstPtr& local) {
                 noticeTimeJump(clockNow());
                 publish(component_.onTracks(local, topic, clockNow()));
               }),
        ros::VoidConstPtr(), ros::TransportHints().tcpNoDelay()));
    all += " " + topic;
  }
  for (const std::string& topic : tracklet_topics_) {
    subscribers_.push_back(nh_.subscribe<sightline::TrackletArray>(
        topic, kQueue,
        guard_(topic,
               [this, topic](const sightline::TrackletArray::ConstPtr& local) {
                 noticeTimeJump(clockNow());
                 publish(component_.onTracklets(local, topic, clockNow()));
               }),
        ros::VoidConstPtr(), ros::TransportHints().tcpNoDelay()));
  }
  ROS_INFO_STREAM(component_.name() << ": positions in frame " << component_.trackingFrame() << ", listens to"
                                    << all);
}

void PositionTrackerNode::onTransforms() {
  if (component_.waiting() > 0) publish(component_.onTransforms(clockNow()));
}

void PositionTrackerNode::publish(const std::vector<PositionResult>& results) {
  for (const PositionResult& result : results) {
    if (result.tracks) {
      tracks_.publish(result.tracks);
      report_.publish(result.report);
      poses_.publish(result.poses);
    }
    for (const std::string& line : health_.note(result, clockNow()))
      ROS_WARN_STREAM(component_.name() << ": " << line);
  }
}

void PositionTrackerNode::noticeTimeJump(sightline::core::Time now) {
  if (!ros::Time::isSimTime()) return;
  if (const auto back = component_.onSimulatedTime(now)) {
    ROS_WARN_STREAM(component_.name() << ": time stepped back by " << *back << " s (max_lag "
                                      << component_.maxLag() << " s); forgets all positions");
  }
}

}  // namespace sightline_ros
