#include "sightline/ros/nodes/track_outputs_node.h"

#include <boost/make_shared.hpp>
#include <utility>

#include <geometry_msgs/QuaternionStamped.h>
#include <ros/console.h>

#include "sightline/ros/components/component_params.h"
#include "sightline/ros/messages/clock.h"
#include "sightline/ros/messages/conversions.h"
#include "sightline/ros/messages/transform_messages.h"
#include "sightline/ros/nodes/this_node.h"
#include "sightline/ros/outputs/any_tracks.h"
#include "sightline/ros/outputs/output_messages.h"

namespace sightline_ros {
namespace {

constexpr std::uint32_t kOutputQueue = 100;  // messages of a topic

bool isHeard(const ros::Publisher& publisher) {
  return publisher.getNumSubscribers() > 0;
}

}  // namespace

TrackOutputsNode::TrackOutputsNode(const ros::NodeHandle& nh, const ros::NodeHandle& pnh)
    : TrackOutputsNode(nh, pnh, ParamReader(pnh)) {}

TrackOutputsNode::TrackOutputsNode(const ros::NodeHandle& nh, const ros::NodeHandle& pnh,
                                   const ParamReader& reader)
    : pnh_(pnh),
      name_(nameOfNode(pnh)),
      guard_(name_),
      component_(loadTrackOutputsParams(reader)),
      topic_(nh.resolveName(component_.params().topic)),
      health_(topic_, silenceFrom(reader)) {
  reader.finish();
  const TrackOutputsParams& params = component_.params();
  ros::NodeHandle node(nh);
  if (params.tf) tf_ = node.advertise<tf2_msgs::TFMessage>("/tf", kOutputQueue);
  poses_ = pnh_.advertise<geometry_msgs::PoseArray>("poses", kOutputQueue);
  points_ = pnh_.advertise<sensor_msgs::PointCloud2>("points", kOutputQueue);
  odometry_ = pnh_.advertise<nav_msgs::Odometry>("odometry", kOutputQueue);
  head_ = pnh_.advertise<geometry_msgs::QuaternionStamped>("head", kOutputQueue);
  if (!params.head_frame.empty()) transform_subscriber_.emplace(node, transforms_, [] {});

  const auto choose = [this](const std_msgs::UInt32::ConstPtr& id) { component_.head().choose(id->data); };
  choose_ = pnh_.subscribe<std_msgs::UInt32>(
      "choose", 1, boost::function<void(const std_msgs::UInt32::ConstPtr&)>(guard_("~choose", choose)));
  using Any = topic_tools::ShapeShifter;
  const auto take = [this](const Any::ConstPtr& message) { onMessage(*message); };
  tracks_ =
      node.subscribe<Any>(topic_, kQueue, boost::function<void(const Any::ConstPtr&)>(guard_(topic_, take)),
                          ros::VoidConstPtr(), ros::TransportHints().tcpNoDelay());
  head_timer_ = node.createTimer(ros::Duration(1.0 / params.head_rate),
                                 guard_("a timer", [this](const ros::TimerEvent&) { aimHead(); }));
  diagnostics_.emplace(nh, pnh, "outputs", [this](auto& status, double) {
    health_.diagnose(clockNow(), isHeard(head_) ? &component_.head() : nullptr, status);
    guard_.diagnose(status);
  });
  ROS_INFO_STREAM(name_ << ": puts out the tracks of " << topic_);
}

void TrackOutputsNode::onMessage(const topic_tools::ShapeShifter& message) {
  OutputResult result;
  const auto refusal =
      takeTracks(message, topic_, [&](const auto& tracks) { result = component_.onTracks(tracks); });
  const auto lines = refusal ? health_.note(*refusal, clockNow()) : health_.note(result, clockNow());
  for (const std::string& line : lines) ROS_WARN_STREAM(name_ << ": " << line);
  if (result.tracks) publish(result);
}

void TrackOutputsNode::publish(const OutputResult& result) {
  const OutputTracks& tracks = *result.tracks;
  const TrackOutputsParams& params = component_.params();
  tracks_frame_ = tracks.header.frame_id;
  if (params.tf && result.sends_transforms && !tracks.tracks.empty() && isHeard(tf_))
    tf_.publish(transformsOf(tracks, params.frame_prefix, params.distance));
  if (isHeard(poses_)) poses_.publish(poseArrayOf(tracks));
  if (isHeard(points_)) points_.publish(pointsOf(tracks, params.distance));
  if (tracks.are_positions && isHeard(odometry_)) {
    for (const OutputTrack& track : tracks.tracks)
      odometry_.publish(odometryOf(tracks.header, track, params.frame_prefix));
  }
  publishOfEach(result);
}

/// What has no room for an id has a topic for each track, as long as there is the track.
void TrackOutputsNode::publishOfEach(const OutputResult& result) {
  const OutputTracks& tracks = *result.tracks;
  auto old = std::exchange(of_tracks_, {});
  for (const OutputTrack& track : tracks.tracks) {
    ros::Publisher& publisher = of_tracks_[track.id] = old[track.id];
    if (publisher) continue;
    const std::string name = nameOf(component_.params().frame_prefix, track);
    publisher = tracks.are_positions
                    ? pnh_.advertise<nav_msgs::Path>("paths/" + name, kOutputQueue)
                    : pnh_.advertise<geometry_msgs::Vector3Stamped>("directions/" + name, kOutputQueue);
  }
  if (!tracks.are_positions) {
    for (const OutputTrack& track : tracks.tracks) {
      if (isHeard(of_tracks_[track.id])) of_tracks_[track.id].publish(directionMessage(tracks.header, track));
    }
  }
  for (const std::uint32_t id : result.grown) {
    if (isHeard(of_tracks_[id])) of_tracks_[id].publish(component_.pathOf(id));
  }
}

/// From the frame of the tracks to that of the head's foot, by the newest transforms.
std::optional<Eigen::Isometry3d> TrackOutputsNode::headFromTracks() const {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  const std::string& frame = component_.params().head_frame;
  if (frame.empty() || tracks_frame_.empty() || frame == tracks_frame_) return pose;
  if (!transforms_.canTransform(frame, tracks_frame_, ros::Time(0))) return std::nullopt;
  const auto transform = transforms_.lookupTransform(frame, tracks_frame_, ros::Time(0));
  const auto& origin = transform.transform.translation;
  pose.linear() = rotationOf(transform);
  pose.translation() = Eigen::Vector3d(origin.x, origin.y, origin.z);
  return pose;
}

void TrackOutputsNode::aimHead() {
  if (!isHeard(head_)) return;
  const auto aim = component_.head().aim(clockNow(), headFromTracks());
  if (aim) {
    geometry_msgs::QuaternionStamped message;
    message.header.stamp = toRos(aim->time);
    const std::string& frame = component_.params().head_frame;
    message.header.frame_id = frame.empty() ? tracks_frame_ : frame;
    message.quaternion = quaternionOf(aim->R_head_target);
    head_.publish(message);
  }
  if (followed_ == component_.head().followed()) return;
  followed_ = component_.head().followed();
  if (followed_)
    ROS_INFO_STREAM_THROTTLE(1.0, name_ << ": the head " << component_.head().words());
  else
    ROS_WARN_STREAM_THROTTLE(1.0, name_ << ": " << component_.head().words());
}

}  // namespace sightline_ros
