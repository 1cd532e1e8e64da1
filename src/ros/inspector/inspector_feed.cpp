#include "sightline/ros/inspector/inspector_feed.h"

#include <sightline/TrackSelection.h>

#include "sightline/ros/messages/clock.h"

namespace sightline_ros {
namespace {

constexpr std::uint32_t kInspectorQueue = 200;  // messages of a topic
constexpr double kLookPeriod = 0.5;             // for new topics [s of the wall's clock]
const char* const kSelectionTopic = "/display/selection";
const char* const kTruth = "truth";  // the estimator's name in a truth's TrackArray

}  // namespace

InspectorFeed::InspectorFeed(const std::string& save_service) : recorder_(save_service) {
  nh_.setCallbackQueue(&queue_);
  selection_ = nh_.advertise<sightline::TrackSelection>(kSelectionTopic, 1, true);
  subscribe<diagnostic_msgs::DiagnosticArray>("/diagnostics", [this](const auto& message) {
    model_.take(*message, clockNow());
    knobs_.take(*message);
  });
  discovery_ = nh_.createWallTimer(ros::WallDuration(kLookPeriod),
                                   guard_("a timer", [this](const ros::WallTimerEvent&) { findTopics(); }));
  spinner_.start();
}

InspectorFeed::~InspectorFeed() {
  spinner_.stop();
}

sightline::core::Time InspectorFeed::toCoreNow() {
  return clockNow();
}

template <typename Message, typename Take>
void InspectorFeed::subscribe(const std::string& topic, Take take) {
  using Pointer = typename Message::ConstPtr;
  const auto locked = [this, take](const Pointer& message) {
    const std::lock_guard<std::mutex> lock(mutex_);
    take(message);
  };
  subscribers_[topic] = nh_.subscribe<Message>(topic, kInspectorQueue,
                                               boost::function<void(const Pointer&)>(guard_(topic, locked)),
                                               ros::VoidConstPtr(), ros::TransportHints().tcpNoDelay());
}

void InspectorFeed::findTopics() {
  ros::master::V_TopicInfo topics;
  if (!ros::master::getTopics(topics)) return;
  for (const ros::master::TopicInfo& topic : topics) {
    if (subscribers_.count(topic.name) == 0 && subscribers_.size() < kMostSubscriptions) listen(topic);
  }
}

void InspectorFeed::listen(const ros::master::TopicInfo& topic) {
  const std::string name = topic.name;
  if (topic.datatype == "sightline/TrackArray") {
    subscribe<sightline::TrackArray>(name, [this, name](const sightline::TrackArray::ConstPtr& message) {
      if (message->estimator != kTruth) model_.take(name, message, clockNow());
    });
  } else if (topic.datatype == "sightline/PositionTrackArray") {
    subscribe<sightline::PositionTrackArray>(
        name, [this, name](const sightline::PositionTrackArray::ConstPtr& message) {
          if (message->tracker != kTruth) model_.take(name, message, clockNow());
        });
  } else if (topic.datatype == "sightline/AssociationArray") {
    subscribe<sightline::AssociationArray>(
        name, [this, name](const auto& message) { model_.take(name, *message, clockNow()); });
  } else if (topic.datatype == "sightline/FusionReport") {
    subscribe<sightline::FusionReport>(name, [this, name](const sightline::FusionReport::ConstPtr& message) {
      model_.take(name, message, clockNow());
    });
  } else if (topic.datatype == "dynamic_reconfigure/ConfigDescription") {
    subscribe<dynamic_reconfigure::ConfigDescription>(
        name,
        [this, node = name.substr(0, name.rfind('/'))](const auto& message) { knobs_.take(node, *message); });
  } else if (topic.datatype == "dynamic_reconfigure/Config") {
    subscribe<dynamic_reconfigure::Config>(name, [this, node = name.substr(0, name.rfind('/'))](
                                                     const auto& message) { knobs_.take(node, *message); });
  }
}

void InspectorFeed::announce(const std::optional<TrackKey>& key, bool alone) {
  sightline::TrackSelection message;
  message.header.stamp = ros::Time::now();
  if (key) message.topic = key->topic;
  if (key) message.track = key->id;
  message.alone = static_cast<std::uint8_t>(alone && key);
  selection_.publish(message);
}

}  // namespace sightline_ros
