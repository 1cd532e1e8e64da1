#include "sightline/ros/diagnosis/input_doctor.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>

#include <ros/callback_queue.h>
#include <ros/param.h>
#include <ros/this_node.h>
#include <ros/time.h>
#include <sightline/PositionReport.h>

#include "sightline/ros/messages/conversions.h"

namespace sightline_ros {
namespace {

constexpr std::uint32_t kDoctorQueue = 10000;  // messages a topic
constexpr double kSecondsBetweenLooks = 0.5;   // at the graph
constexpr double kSecondsForTransforms = 0.7;  // that may come so much later than their scans
constexpr double kSecondsOfTransforms = 20.0;  // that are kept, beyond the time of looking
constexpr double kOnePlatform = 10.0;          // [m], as the default of the fusion's max_baseline
const char* const kUsualTrackingFrame = "platform_enu";

}  // namespace

InputDoctor::InputDoctor(const ros::NodeHandle& nh, const DoctorParams& params)
    : nh_(nh),
      params_(params),
      transforms_(ros::Duration(params.seconds + kSecondsOfTransforms)),
      transform_subscriber_(nh, transforms_, [] {}) {}

std::vector<Finding> InputDoctor::examine() {
  first_now_ = ros::Time::now();
  lookFor(params_.seconds);
  is_listening_ = false;
  lookFor(kSecondsForTransforms);
  tracking_frame_ = params_.tracking_frame.empty() ? usedTrackingFrame() : params_.tracking_frame;

  std::vector<Finding> found;
  findClock(found);
  for (Finding& finding : findingsOf(graph_)) found.push_back(std::move(finding));
  for (Finding& finding : examination_.silentTopics(graph_, params_.seconds))
    found.push_back(std::move(finding));
  for (Finding& finding : positions_.silentTopics(graph_, params_.seconds))
    found.push_back(std::move(finding));
  InputLimits limits = params_.limits;
  limits.stand_apart |= doSensorsStandApart();
  for (Finding& finding : examination_.findings(transforms_, tracking_frame_, limits))
    found.push_back(std::move(finding));
  for (Finding& finding : positions_.findings()) found.push_back(std::move(finding));
  return found;
}

void InputDoctor::lookFor(double seconds) {
  const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(seconds);
  ros::WallTime next_look;
  while (ros::ok() && ros::WallTime::now() < end) {
    if (ros::WallTime::now() >= next_look) {
      listen();
      next_look = ros::WallTime::now() + ros::WallDuration(kSecondsBetweenLooks);
    }
    ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.02));
  }
}

/// Subscribes to what has come up since.
void InputDoctor::listen() {
  graph_ = viewOfGraph(ros::this_node::getName());
  for (const GraphView::Topic& topic : graph_.topics) {
    if (topic.publishers.empty() || subscribers_.count(topic.name) > 0) continue;
    const std::string& name = topic.name;
    if (topic.type == "sightline/SightingArray") {
      const boost::function<void(const ros::MessageEvent<sightline::SightingArray const>&)> take =
          [this, name](const auto& event) { onScan(event, name); };
      subscribers_[name] = nh_.subscribe<sightline::SightingArray>(
          name, kDoctorQueue, take, ros::VoidConstPtr(), ros::TransportHints().tcpNoDelay());
    } else if (topic.type == "sightline/AssociationArray") {
      const boost::function<void(const sightline::AssociationArray::ConstPtr&)> take =
          [this, name](const auto& associations) {
            if (is_listening_) examination_.take(*associations, name);
          };
      subscribers_[name] = nh_.subscribe<sightline::AssociationArray>(name, kDoctorQueue, take);
    } else if (topic.type == "sightline/TrackArray") {
      const boost::function<void(const sightline::TrackArray::ConstPtr&)> take = [this,
                                                                                  name](const auto& tracks) {
        if (is_listening_) examination_.take(*tracks, name);
      };
      subscribers_[name] = nh_.subscribe<sightline::TrackArray>(name, kDoctorQueue, take);
    } else if (topic.type == "sightline/PositionReport") {
      const boost::function<void(const sightline::PositionReport::ConstPtr&)> take =
          [this, name](const auto& report) {
            if (is_listening_) positions_.take(*report, name);
          };
      subscribers_[name] = nh_.subscribe<sightline::PositionReport>(name, kDoctorQueue, take);
    }
  }
}

void InputDoctor::onScan(const ros::MessageEvent<sightline::SightingArray const>& event,
                         const std::string& topic) {
  if (!is_listening_) return;
  examination_.take(*event.getConstMessage(), topic, event.getPublisherName(),
                    toCore(event.getReceiptTime()));
}

/// That of the running trackers; the commonest where they differ.
std::string InputDoctor::usedTrackingFrame() const {
  std::map<std::string, int> votes;
  for (const std::string& tracker : trackersOf(graph_)) {
    std::string frame = kUsualTrackingFrame;
    ros::param::get(tracker + "/tracking_frame", frame);
    ++votes[frame];
  }
  if (votes.empty()) return kUsualTrackingFrame;
  return std::max_element(votes.begin(), votes.end(),
                          [](const auto& a, const auto& b) { return a.second < b.second; })
      ->first;
}

/// Whether positions are told, or two sensors stand farther apart than one platform is long by the newest tf:
/// then what they see is not in one direction.
bool InputDoctor::doSensorsStandApart() const {
  for (const GraphView::Topic& topic : positionReportTopics(graph_))
    if (!topic.publishers.empty()) return true;
  std::set<std::string> frames;
  for (const InputExamination::Row& row : examination_.sensors())
    frames.insert(row.record->frames().begin(), row.record->frames().end());
  for (auto a = frames.begin(); a != frames.end(); ++a) {
    for (auto b = std::next(a); b != frames.end(); ++b) {
      if (!transforms_.canTransform(*a, *b, ros::Time(0))) continue;
      const auto& offset = transforms_.lookupTransform(*a, *b, ros::Time(0)).transform.translation;
      if (std::hypot(offset.x, offset.y, offset.z) > kOnePlatform) return true;
    }
  }
  return false;
}

void InputDoctor::findClock(std::vector<Finding>& found) const {
  const bool is_published = isPublished(graph_, "/clock");
  if (graph_.use_sim_time && !is_published) {
    found.push_back({"/clock",
                     "use_sim_time is set, and nobody publishes /clock: every node's clock stands "
                     "still; start the simulator, play with --clock, or set use_sim_time to false"});
  } else if (graph_.use_sim_time && ros::Time::now() == first_now_) {
    found.push_back({"/clock",
                     "use_sim_time is set, and the simulated clock stands still: is the simulation, or "
                     "the recording, paused?"});
  } else if (!graph_.use_sim_time && is_published) {
    found.push_back({"/clock",
                     "somebody publishes /clock, but use_sim_time is not set: nodes compare stamps with "
                     "the wall's clock; set use_sim_time before they start"});
  }
}

}  // namespace sightline_ros
