#include "sightline/ros/nodes/truth_publisher_node.h"

#include <ros/console.h>
#include <sightline/PositionTrackArray.h>
#include <sightline/TrackArray.h>
#include <std_msgs/Time.h>

#include "sightline/ros/messages/conversions.h"
#include "sightline/ros/messages/scenario_messages.h"
#include "sightline/ros/messages/transform_messages.h"
#include "sightline/ros/nodes/this_node.h"
#include "sightline/ros/params/scenario_params.h"

namespace sightline_ros {
namespace {

namespace core = sightline::core;

constexpr double kDefaultRate = 100.0;        // [Hz]
constexpr double kDefaultStartDelay = 1.0;    // [s]
constexpr double kLongestTruthBacklog = 1.0;  // [s]: truth further back than this is left out

core::SightingTiming everyPeriod(double rate) {
  core::SightingTiming timing;
  timing.kind = core::SightingTiming::Kind::fixed;
  timing.rate = rate;
  return timing;
}

}  // namespace

TruthPublisherNode::TruthPublisherNode(const ros::NodeHandle& nh, const ros::NodeHandle& pnh)
    : TruthPublisherNode(nh, pnh, ParamReader(pnh)) {}

TruthPublisherNode::TruthPublisherNode(ros::NodeHandle nh, const ros::NodeHandle& pnh,
                                       const ParamReader& reader)
    : scenario_(loadScenario(ParamReader(ros::NodeHandle("/scenario")))),
      start_delay_(reader.number("start_delay", kDefaultStartDelay, atLeast(0.0), "s")),
      start_(loadStartTime(reader)),
      instants_(everyPeriod(reader.number("rate", kDefaultRate, Range{0.0, 1e4, true, false}, "Hz")), 0),
      pacer_(pnh, [this](const ros::Time& now) { return onPace(now); }) {
  reader.finish();
  start_publisher_ = nh.advertise<std_msgs::Time>("/scenario/start", 1, true);
  truth_ = nh.advertise<sightline::TrackArray>("/truth", kQueue);
  if (!scenario_.stations.empty())
    position_truth_ = nh.advertise<sightline::PositionTrackArray>(kPositionTruthTopic, kQueue);
  publishFixedTransforms();
  repetition_ = nh.createWallTimer(ros::WallDuration(kSecondsBetweenStaticTransforms),
                                   [this](const ros::WallTimerEvent&) { publishFixedTransforms(); });
  pacer_.wake();
}

std::optional<ros::Time> TruthPublisherNode::onPace(const ros::Time& now) {
  if (!begun_) begin(now);
  for (; core::seconds(upcoming_) < scenario_.duration; upcoming_ = instants_.next()) {
    const ros::Time stamp = toRos(toCore(*start_) + upcoming_);
    if (stamp > now) return stamp;
    if ((now - stamp).toSec() > kLongestTruthBacklog) continue;
    publishTruth(core::seconds(upcoming_), stamp);
    const auto transforms = movingTransforms(scenario_, core::seconds(upcoming_), stamp);
    if (!transforms.empty()) transforms_.sendTransform(transforms);
  }
  ROS_INFO("the scenario is over");
  return std::nullopt;
}

/// Simulated time may not have started when the node does: the delay counts from the first time known.
void TruthPublisherNode::begin(const ros::Time& now) {
  begun_ = true;
  if (!start_) start_ = now + ros::Duration(start_delay_);
  std_msgs::Time start;
  start.data = *start_;
  start_publisher_.publish(start);
  upcoming_ = instants_.next();
  ROS_INFO_STREAM("time zero of the scenario is " << *start_);
}

void TruthPublisherNode::publishTruth(double time, const ros::Time& stamp) {
  truth_.publish(truthMessage(scenario_, time, stamp));
  if (position_truth_) position_truth_.publish(positionTruthMessage(scenario_, time, stamp));
}

void TruthPublisherNode::publishFixedTransforms() {
  const auto transforms = fixedTransforms(scenario_, ros::Time::now());
  if (!transforms.empty()) static_transforms_.sendTransform(transforms);
}

}  // namespace sightline_ros
