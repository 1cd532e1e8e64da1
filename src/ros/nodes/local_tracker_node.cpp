#include "sightline/ros/nodes/local_tracker_node.h"

#include <set>
#include <stdexcept>

#include <ros/console.h>
#include <sightline/AssociationArray.h>
#include <sightline/TrackArray.h>
#include <sightline/TrackletArray.h>

#include "sightline/ros/components/component_params.h"
#include "sightline/ros/messages/clock.h"
#include "sightline/ros/messages/conversions.h"
#include "sightline/ros/nodes/this_node.h"

namespace sightline_ros {
namespace {

/// Full names. A topic that is listened to twice would bring each scan twice.
std::vector<std::string> topicsFrom(const ParamReader& reader, const ros::NodeHandle& nh) {
  std::set<std::string> seen;
  std::vector<std::string> topics;
  for (const std::string& topic : reader.requiredTexts("sighting_topics")) {
    topics.push_back(nh.resolveName(topic));
    if (!seen.insert(topics.back()).second)
      throw reader.error("sighting_topics", "expected different topics, got " + topics.back() + " twice");
  }
  return topics;
}

std::optional<LiveSmoothing> smoothingOf(const LocalTrackerComponent& component, const ParamReader& reader) {
  if (!(component.smoothingLag() > 0.0)) return std::nullopt;
  try {
    return LiveSmoothing(component.estimatorParams(), component.smoothingLag());
  } catch (const std::invalid_argument& problem) {
    throw reader.error("smoothing_lag", problem.what());
  }
}

}  // namespace

LocalTrackerNode::LocalTrackerNode(const ros::NodeHandle& nh, const ros::NodeHandle& pnh)
    : LocalTrackerNode(nh, pnh, ParamReader(pnh)) {}

LocalTrackerNode::LocalTrackerNode(const ros::NodeHandle& nh, const ros::NodeHandle& pnh,
                                   const ParamReader& reader)
    : nh_(nh),
      guard_(nameOfNode(pnh)),
      component_(reader, nameOfNode(pnh), transforms_),
      health_(silenceFrom(reader), {component_.maxLag(), component_.maxFuture()}),
      smoothing_(smoothingOf(component_, reader)) {
  const std::vector<std::string> topics = topicsFrom(reader, nh);
  reader.finish();

  tracks_ = nh_.advertise<sightline::TrackArray>("tracks", kQueue);
  tracklets_ = nh_.advertise<sightline::TrackletArray>("tracklets", kQueue);
  associations_ = nh_.advertise<sightline::AssociationArray>("associations", kQueue);
  if (smoothing_) {
    component_.keepSightings();
    smoothed_ = nh_.advertise<sightline::TrackArray>("tracks_smoothed", kQueue);
  }
  transform_subscriber_ =
      std::make_unique<TransformSubscriber>(nh_, transforms_, guard_("/tf", [this] { onTransforms(); }));
  timeout_timer_ = nh_.createWallTimer(ros::WallDuration(kSecondsBetweenTimeoutChecks),
                                       guard_("a timer", [this](const ros::WallTimerEvent&) { onTimer(); }));
  parameters_.emplace(pnh, reader);
  reconfigure_server_.emplace(pnh,
                              Reconfiguration(reader, changeableTrackerParams(), [this](const auto& changed) {
                                auto refusal = component_.reconfigure(changed);
                                if (!refusal) parameters_->publish(changed);
                                return refusal;
                              }));
  diagnostics_.emplace(nh, pnh, "tracking", [this](auto& status, double) { diagnose(status); });
  subscribe(topics);
}

void LocalTrackerNode::subscribe(const std::vector<std::string>& topics) {
  std::string all;
  for (const std::string& topic : topics) {
    sightings_.push_back(nh_.subscribe<sightline::SightingArray>(
        topic, kQueue,
        guard_(topic, [this](const sightline::SightingArray::ConstPtr& scan) { onScan(scan); }),
        ros::VoidConstPtr(), ros::TransportHints().tcpNoDelay()));
    all += " " + topic;
  }
  ROS_INFO_STREAM(component_.name() << ": " << component_.estimator() << " in frame "
                                    << component_.trackingFrame() << ", listens to" << all);
}

void LocalTrackerNode::onScan(const sightline::SightingArray::ConstPtr& scan) {
  const sightline::core::Time now = clockNow();
  health_.noteArrival(*scan, now);
  publish(component_.onScan(scan, now));
}

void LocalTrackerNode::onTransforms() {
  if (component_.waiting() > 0) publish(component_.onTransforms(clockNow()));
}

void LocalTrackerNode::onTimer() {
  onTransforms();
  if (const auto overdue = component_.overdueTracklets(clockNow())) tracklets_.publish(overdue);
  if (smoothing_) publishSmoothed(smoothing_->overdue(clockNow()));
}

void LocalTrackerNode::publishSmoothed(const LiveSmoothing::Messages& messages) {
  for (const sightline::TrackArray::Ptr& message : messages) smoothed_.publish(message);
}

void LocalTrackerNode::publish(const std::vector<TrackerReport>& reports) {
  for (const TrackerReport& report : reports) {
    if (report.tracklets) tracklets_.publish(report.tracklets);
    if (report.tracks) tracks_.publish(report.tracks);
    associations_.publish(report.associations);
    if (smoothing_) publishSmoothed(smoothing_->onReport(report));
    health_.note(report);
    warnOf(report);
  }
}

void LocalTrackerNode::warnOf(const TrackerReport& report) {
  if (!report.notice.empty()) ROS_WARN_STREAM(component_.name() << ": " << report.notice);
  for (const std::string& line : health_.sensorLines(report, clockNow()))
    ROS_WARN_STREAM(component_.name() << ": " << line);
  if (const auto warning = health_.warningAbout(report, clockNow())) {
    ROS_WARN_STREAM(component_.name() << ": " << *warning);
  }
}

void LocalTrackerNode::diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) {
  const std::vector<sightline::core::WatchedSensor> watched = component_.sensors();
  for (const std::string& line : health_.clockLines(watched))
    ROS_WARN_STREAM(component_.name() << ": " << line);
  health_.diagnose(clockNow(), component_.waiting(), status, watched, component_.calibratedSensors(),
                   component_.stamps(), component_.detection());
  if (smoothing_) {
    status.add("smoothing: lag [s]", smoothing_->lag());
    status.add("smoothing: messages that wait", smoothing_->waiting());
    status.add("smoothing: sightings too late", smoothing_->late());
  }
  reconfigure_server_->diagnose(status);
  guard_.diagnose(status);
}

}  // namespace sightline_ros
