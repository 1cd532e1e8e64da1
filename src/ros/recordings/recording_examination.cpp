#include "sightline/ros/recordings/recording_examination.h"

#include <algorithm>
#include <map>
#include <optional>

#include <rosbag/view.h>

#include "sightline/core/model/time.h"
#include "sightline/ros/messages/conversions.h"
#include "sightline/ros/recordings/recorded_stations.h"
#include "sightline/ros/recordings/recorded_transforms.h"
#include "sightline/ros/recordings/recording_reader.h"

namespace sightline_ros {

namespace core = sightline::core;
using sightline::AssociationArray;
using sightline::PositionReport;
using sightline::SightingArray;
using sightline::TrackArray;

namespace {

/// The name of the node that published on a connection; the topic where it is not recorded.
std::string publisherOf(const rosbag::ConnectionInfo& connection) {
  if (!connection.header) return connection.topic;
  const auto caller = connection.header->find("callerid");
  return caller == connection.header->end() || caller->second.empty() ? connection.topic : caller->second;
}

GraphView graphOf(const rosbag::Bag& bag) {
  std::map<std::string, GraphView::Topic> topics;
  rosbag::View view(bag);
  for (const rosbag::ConnectionInfo* connection : view.getConnections()) {
    GraphView::Topic& topic = topics[connection->topic];
    topic.name = connection->topic;
    topic.type = connection->datatype;
    topic.publishers.insert(publisherOf(*connection));
  }
  GraphView graph;
  for (auto& [name, topic] : topics) graph.topics.push_back(std::move(topic));
  return graph;
}

}  // namespace

RecordingExamination examineRecording(const rosbag::Bag& bag, const RecordingExaminationParams& params) {
  RecordingExamination result;
  result.graph = graphOf(bag);
  result.tracking_frame = params.tracking_frame.empty() ? trackingFrameOf(bag) : params.tracking_frame;
  RecordedTransforms transforms(bag);
  std::optional<ros::Time> first, last;
  rosbag::View view(bag);
  for (const rosbag::MessageInstance& message : view) {
    if (message.isType<SightingArray>()) {
      const auto scan = messageOf<SightingArray>(message);
      const ros::Time received = message.getTime();
      if (!first) first = received;
      last = received;
      result.inputs.take(*scan, message.getTopic(), message.getCallerId(),
                         params.with_latency ? toCore(received) : core::Time{});
      transforms.advanceTo(toCore(scan->header.stamp));
      result.inputs.turn(transforms.buffer(), result.tracking_frame);
    } else if (message.isType<AssociationArray>()) {
      result.inputs.take(*messageOf<AssociationArray>(message), message.getTopic());
    } else if (message.isType<TrackArray>()) {
      result.inputs.take(*messageOf<TrackArray>(message), message.getTopic());
    } else if (message.isType<PositionReport>()) {
      result.positions.take(*messageOf<PositionReport>(message), message.getTopic());
    }
  }
  if (first) result.seconds = (*last - *first).toSec();
  if (!first) result.findings.push_back(missingSightings());
  InputLimits limits = params.limits;
  limits.stand_apart = recordedStationsOf(bag, params.metric_frame).standApart();
  for (Finding& finding : result.inputs.findings(transforms.buffer(), result.tracking_frame, limits))
    result.findings.push_back(std::move(finding));
  if (params.with_positions) {
    for (Finding& finding : result.positions.findings()) result.findings.push_back(std::move(finding));
  }
  return result;
}

std::string linesOf(const std::vector<Finding>& findings) {
  std::string lines;
  for (const Finding& finding : findings)
    lines += std::string("  ") + (finding.is_note ? "note   " : "WRONG  ") + finding.subject + ": " +
             finding.words + "\n";
  return lines;
}

}  // namespace sightline_ros
