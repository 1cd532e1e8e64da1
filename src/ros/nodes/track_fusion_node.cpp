#include "sightline/ros/nodes/track_fusion_node.h"

#include <ros/console.h>
#include <sightline/FusionReport.h>

#include "sightline/ros/components/component_params.h"
#include "sightline/ros/messages/clock.h"
#include "sightline/ros/messages/conversions.h"
#include "sightline/ros/nodes/this_node.h"
#include "sightline/ros/nodes/track_topics.h"

namespace sightline_ros {
TrackFusionNode::TrackFusionNode(const ros::NodeHandle& nh, const ros::NodeHandle& pnh)
    : TrackFusionNode(nh, pnh, ParamReader(pnh)) {}

TrackFusionNode::TrackFusionNode(const ros::NodeHandle& nh, const ros::NodeHandle& pnh,
                                 const ParamReader& reader)
    : nh_(nh),
      guard_(nameOfNode(pnh)),
      transform_subscriber_(nh_, transforms_, [] {}),
      component_(reader, nameOfNode(pnh), &transforms_),
      topics_(trackTopicsFrom(reader, nh)),
      tracklet_topics_(trackletTopicsFrom(reader, nh, topics_)),
      health_(topics_, silenceFrom(reader)) {
  reader.finish();

  parameters_.emplace(pnh, reader);
  reconfigure_server_.emplace(pnh,
                              Reconfiguration(reader, changeableFusionParams(),
                                              [this](const auto& changed) { return reconfigure(changed); }));
  diagnostics_.emplace(nh, pnh, "fusion", [this](auto& status, double) {
    health_.diagnose(clockNow(), status);
    status.addf("largest distance of sensors [m]", "%.1f", component_.places()->spread());
    reconfigure_server_->diagnose(status);
    guard_.diagnose(status);
  });
  end_of_wait_ =
      nh_.createTimer(ros::Duration(component_.maxWait()),
                      guard_("a timer", [this](const ros::TimerEvent&) { onEndOfWait(); }), true, false);
  tracks_ = nh_.advertise<sightline::TrackArray>("fusion/tracks", kQueue);
  report_ = nh_.advertise<sightline::FusionReport>("fusion/report", kQueue);

  std::string all;
  for (const std::string& topic : topics_) {
    subscribers_.push_back(nh_.subscribe<sightline::TrackArray>(
        topic, kQueue,
        guard_(topic,
               [this, topic](const sightline::TrackArray::ConstPtr& local) { onTracks(local, topic); }),
        ros::VoidConstPtr(), ros::TransportHints().tcpNoDelay()));
    all += " " + topic;
  }
  followRule();
  ROS_INFO_STREAM(component_.name() << ": " << component_.rule() << " in frame " << component_.trackingFrame()
                                    << ", listens to" << all);
}

std::optional<sightline::core::Refusal> TrackFusionNode::reconfigure(const ParamReader& changed) {
  auto refusal = component_.reconfigure(changed);
  if (!refusal) {
    followRule();
    parameters_->publish(changed);
  }
  return refusal;
}

/// Listens to tracklets while the rule makes use of them.
void TrackFusionNode::followRule() {
  if (component_.wantsTracklets() == !tracklet_subscribers_.empty()) return;
  tracklet_subscribers_.clear();
  if (!component_.wantsTracklets()) return;
  for (const std::string& topic : tracklet_topics_) {
    tracklet_subscribers_.push_back(nh_.subscribe<sightline::TrackletArray>(
        topic, kQueue,
        guard_(topic,
               [this, topic](const sightline::TrackletArray::ConstPtr& local) { onTracklets(local, topic); }),
        ros::VoidConstPtr(), ros::TransportHints().tcpNoDelay()));
  }
}

void TrackFusionNode::onTracks(const sightline::TrackArray::ConstPtr& local, const std::string& topic) {
  const sightline::core::Time now = clockNow();
  noticeTimeJump(now);
  const FusionResult result = component_.onTracks(*local, topic, now);
  health_.note(*local, topic, result);
  publish(result, now);
  timeWait();
}

/// Others were expected and did not come.
void TrackFusionNode::onEndOfWait() {
  const auto result = component_.fuseWaiting();
  if (!result) return timeWait();
  health_.noteFusion(*result);
  publish(*result, clockNow());
  timeWait();
}

/// The timer runs while something waits.
void TrackFusionNode::timeWait() {
  if (component_.isWaiting() == is_wait_timed_) return;
  is_wait_timed_ = component_.isWaiting();
  end_of_wait_.stop();
  if (is_wait_timed_) end_of_wait_.start();
}

void TrackFusionNode::publish(const FusionResult& result, sightline::core::Time now) {
  if (result.tracks) tracks_.publish(result.tracks);
  if (result.report) report_.publish(result.report);
  health_.noteFailures(component_.failedTracklets());
  for (const std::string& line : health_.sensorLines(result, now))
    ROS_WARN_STREAM(component_.name() << ": " << line);
  for (const std::string& warning : health_.warnings(now))
    ROS_WARN_STREAM(component_.name() << ": " << warning);
}

void TrackFusionNode::onTracklets(const sightline::TrackletArray::ConstPtr& local, const std::string& topic) {
  const sightline::core::Time now = clockNow();
  noticeTimeJump(now);
  const auto refusal = component_.onTracklets(*local, topic, now);
  health_.noteTracklets(*local, refusal, component_.lateTracklets());
}

void TrackFusionNode::noticeTimeJump(sightline::core::Time now) {
  if (!ros::Time::isSimTime()) return;
  if (const auto back = component_.onSimulatedTime(now)) {
    ROS_WARN_STREAM(component_.name() << ": time stepped back by " << *back << " s (tracklets/max_lag "
                                      << component_.maxLag() << " s); forgets all tracks");
  }
}

}  // namespace sightline_ros
