#include "sightline/ros/adapters/sighting_adapter_node.h"

#include <boost/function.hpp>
#include <utility>

#include <diagnostic_msgs/DiagnosticStatus.h>
#include <ros/console.h>

#include "sightline/ros/messages/clock.h"
#include "sightline/ros/messages/conversions.h"

namespace sightline_ros {
namespace {

constexpr std::uint32_t kAdapterQueue = 1000;  // messages a topic
using Kind = AdapterTopic::Kind;

constexpr double kCameraWarning = 60.0;  // between two of them, while a camera zooms [s]

std::vector<std::uint8_t> bytesOf(const topic_tools::ShapeShifter& message) {
  std::vector<std::uint8_t> bytes(message.size());
  ros::serialization::OStream stream(bytes.data(), message.size());
  message.write(stream);
  return bytes;
}

}  // namespace

SightingAdapterNode::SightingAdapterNode(const ros::NodeHandle& nh, const ros::NodeHandle& pnh)
    : SightingAdapterNode(nh, pnh, ParamReader(pnh)) {}

SightingAdapterNode::SightingAdapterNode(const ros::NodeHandle& nh, const ros::NodeHandle& pnh,
                                         const ParamReader& reader)
    : nh_(nh), boresights_(nh) {
  for (AdapterTopic& topic : loadAdapterTopics(reader)) {
    sources_.push_back(std::make_unique<Source>());
    sources_.back()->topic = std::move(topic);
  }
  reader.finish();

  diagnostics_.emplace(nh, pnh, "adapting",
                       [this](auto& status, double elapsed) { diagnose(status, elapsed); });
  for (const auto& source : sources_) start(*source);
}

void SightingAdapterNode::start(Source& source) {
  source.sightings = nh_.advertise<sightline::SightingArray>(source.topic.output, kAdapterQueue);
  if (!source.topic.camera_info.empty()) {
    const boost::function<void(const sensor_msgs::CameraInfo::ConstPtr&)> take =
        [this, &source](const sensor_msgs::CameraInfo::ConstPtr& camera) { onCameraInfo(source, *camera); };
    source.camera_info =
        nh_.subscribe<sensor_msgs::CameraInfo>(source.topic.camera_info, kAdapterQueue, take);
  }
  switch (source.topic.kind) {
    case Kind::direction:
      return subscribe<geometry_msgs::Vector3Stamped>(source);
    case Kind::point:
    case Kind::pixel:
      return subscribe<geometry_msgs::PointStamped>(source);
    case Kind::pose:
      return subscribe<geometry_msgs::PoseStamped>(source);
    case Kind::poses:
      return subscribe<geometry_msgs::PoseArray>(source);
    case Kind::pose_with_covariance:
      return subscribe<geometry_msgs::PoseWithCovarianceStamped>(source);
    case Kind::odometry:
      return subscribe<nav_msgs::Odometry>(source);
    case Kind::box:
      return subscribe<sensor_msgs::RegionOfInterest>(source);
    case Kind::cloud:
      return subscribe<sensor_msgs::PointCloud2>(source);
    case Kind::laser:
      return subscribe<sensor_msgs::LaserScan>(source);
    case Kind::fields:
      break;
  }
  const boost::function<void(const topic_tools::ShapeShifter::ConstPtr&)> take =
      [this, &source](const topic_tools::ShapeShifter::ConstPtr& message) { onAnyMessage(source, *message); };
  source.messages = nh_.subscribe<topic_tools::ShapeShifter>(
      source.topic.topic, kAdapterQueue, take, ros::VoidConstPtr(), ros::TransportHints().tcpNoDelay());
}

template <typename Message>
void SightingAdapterNode::subscribe(Source& source) {
  const boost::function<void(const boost::shared_ptr<const Message>&)> take =
      [this, &source](const boost::shared_ptr<const Message>& message) {
        publish(source, read(*message, source.topic, source.rays ? &*source.rays : nullptr));
      };
  source.messages = nh_.subscribe<Message>(source.topic.topic, kAdapterQueue, take, ros::VoidConstPtr(),
                                           ros::TransportHints().tcpNoDelay());
}

void SightingAdapterNode::onCameraInfo(Source& source, const sensor_msgs::CameraInfo& camera) {
  if (source.rays && isSameCalibration(camera, source.camera)) {
    source.rays->setStamp(camera.header.stamp);
    return;
  }
  if (const auto refusal = refusalOf(camera, source.topic.is_rectified)) {
    source.rays.reset();
    note({refusal->kind, "topic " + source.topic.camera_info + ": " + refusal->detail});
    return;
  }
  source.rays.emplace(camera, source.topic.is_rectified);
  source.camera = camera;
  if (const std::string warning = source.rays->warning(); !warning.empty()) {
    ROS_WARN_STREAM_THROTTLE(kCameraWarning, "topic " << source.topic.camera_info << ": " << warning);
  }
}

void SightingAdapterNode::onAnyMessage(Source& source, const topic_tools::ShapeShifter& message) {
  try {
    publish(source, readAny(source, message));
  } catch (const FieldError& problem) {
    Reading nothing(source.topic, std_msgs::Header());
    nothing.refuse("fields not found", problem.what());
    ++source.message_count;
    note(nothing.refusals.front());
  }
}

Reading SightingAdapterNode::readAny(Source& source, const topic_tools::ShapeShifter& message) {
  if (message.getDataType() != source.topic.type) {
    throw FieldError("it carries " + message.getDataType() + ", but type says " + source.topic.type);
  }
  if (!source.layout || source.layout_md5 != message.getMD5Sum()) {
    source.layout.emplace(message.getDataType(), message.getMessageDefinition());
    source.layout_md5 = message.getMD5Sum();
  }
  const std::vector<std::uint8_t> bytes = bytesOf(message);
  return read({bytes.data(), bytes.size()}, *source.layout, source.topic,
              source.rays ? &*source.rays : nullptr);
}

void SightingAdapterNode::publish(Source& source, const Reading& reading) {
  ++source.message_count;
  if (reading.unknown_covariances > 0 && source.sigma_count == 0) {
    ROS_WARN_STREAM("topic " << source.topic.topic << ": the messages' covariance says nothing ("
                             << reading.first_unknown
                             << "); the configured sigma is taken in its place from here on");
  }
  source.sigma_count += reading.unknown_covariances;
  source.unused_count += reading.unused_slots;
  const AdaptedScan adapted = adapt(reading, source.topic, ros::Time::now());
  for (const sightline::core::Refusal& refusal : adapted.refusals) note(refusal);
  if (!adapted.scan) return;
  if (!adapted.optical_frame.empty()) boresights_.add(adapted.optical_frame);
  source.sighting_count += adapted.scan->sightings.size();
  source.sightings.publish(adapted.scan);
}

void SightingAdapterNode::note(const sightline::core::Refusal& refusal) {
  if (const auto warning = refusals_.note(refusal, clockNow())) ROS_WARN_STREAM(*warning);
}

void SightingAdapterNode::diagnose(diagnostic_updater::DiagnosticStatusWrapper& status, double elapsed) {
  using diagnostic_msgs::DiagnosticStatus;
  status.summary(DiagnosticStatus::OK, std::to_string(sources_.size()) + " topics");
  for (const auto& source : sources_) {
    const std::string& name = source->topic.sensor;
    const auto fresh = static_cast<double>(source->message_count - source->message_count_before);
    source->message_count_before = source->message_count;
    status.addf(name + ": message rate [Hz]", "%.1f", elapsed > 0.0 ? fresh / elapsed : 0.0);
    status.add(name + ": messages", source->message_count);
    status.add(name + ": sightings", source->sighting_count);
    status.add(name + ": covariance not known, sigma taken", source->sigma_count);
    if (source->unused_count > 0) status.add(name + ": unused slots (zeros)", source->unused_count);
    if (source->rays && source->rays->shareWithoutRay() > 0.0) {
      status.addf(name + ": pixels without a ray [%]", "%.2f", 100.0 * source->rays->shareWithoutRay());
    }
    if (source->message_count == 0) {
      status.mergeSummary(DiagnosticStatus::WARN, "no message yet on " + source->topic.topic);
    }
  }
  refusals_.diagnose(status);
}

}  // namespace sightline_ros
