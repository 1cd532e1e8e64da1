#include "sightline/ros/diagnosis/graph_view.h"

#include <algorithm>
#include <map>
#include <stdexcept>

#include <ros/master.h>
#include <ros/message_traits.h>
#include <ros/param.h>
#include <sightline/AssociationArray.h>
#include <sightline/FusionReport.h>
#include <sightline/SightingArray.h>
#include <sightline/TrackArray.h>
#include <visualization_msgs/MarkerArray.h>

#include "sightline/report/value_text.h"

namespace sightline_ros {

using sightline::report::listOf;

namespace {

using Names = std::set<std::string>;

template <typename Message>
std::string typeOf() {
  return ros::message_traits::datatype<Message>();
}

XmlRpc::XmlRpcValue askMaster(const std::string& question, const std::string& myself) {
  XmlRpc::XmlRpcValue arguments, response, answer;
  arguments[0] = myself;
  if (!ros::master::execute(question, arguments, response, answer, false)) {
    throw std::runtime_error("the ROS master at " + ros::master::getURI() +
                             " does not answer: is it running, and ROS_MASTER_URI right?");
  }
  return answer;
}

// XmlRpcValue's begin() is that of a struct: arrays are gone through by index.
// NOLINTBEGIN(modernize-loop-convert)

/// Topic to nodes, of one list of the system's state.
std::map<std::string, Names> nodesByTopic(XmlRpc::XmlRpcValue list, const std::string& myself) {
  std::map<std::string, Names> nodes;
  for (int i = 0; i < list.size(); ++i) {
    Names& of_topic = nodes[static_cast<std::string>(list[i][0])];
    for (int k = 0; k < list[i][1].size(); ++k) of_topic.insert(static_cast<std::string>(list[i][1][k]));
    of_topic.erase(myself);
  }
  return nodes;
}

// NOLINTEND(modernize-loop-convert)

/// Nodes that publish a message of this type.
Names publishersOf(const GraphView& graph, const std::string& type) {
  Names nodes;
  for (const GraphView::Topic& topic : graph.topics) {
    if (topic.type == type) nodes.insert(topic.publishers.begin(), topic.publishers.end());
  }
  return nodes;
}

Names common(const Names& a, const Names& b) {
  Names both;
  std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::inserter(both, both.end()));
  return both;
}

/// What is published of a type, for a listener to choose from.
std::string choiceOf(const GraphView& graph, const std::string& type) {
  Names published;
  for (const GraphView::Topic& topic : graph.topics) {
    if (topic.type == type && !topic.publishers.empty()) published.insert(topic.name);
  }
  return published.empty() ? "nothing of " + type + " is published" : "published are " + listOf(published);
}

/// A listener that shows everything, or a nodelet manager with such a one in it, may listen in vain.
Names withoutDisplays(const GraphView& graph, Names nodes) {
  for (const std::string& display : publishersOf(graph, typeOf<visualization_msgs::MarkerArray>()))
    nodes.erase(display);
  return nodes;
}

/// Listeners among `nodes` to topics that nobody publishes.
void findDeadTopics(const GraphView& graph, const std::string& type, const Names& nodes,
                    const std::string& parameter, std::vector<Finding>& found) {
  for (const GraphView::Topic& topic : graph.topics) {
    const Names in_vain = common(topic.subscribers, nodes);
    if (topic.type != type || !topic.publishers.empty() || in_vain.empty()) continue;
    found.push_back({topic.name, listOf(in_vain) + (in_vain.size() > 1 ? " listen" : " listens") +
                                     " to it, and nobody publishes it: start what does, or "
                                     "correct " +
                                     parameter + " (" + choiceOf(graph, type) + ")"});
  }
}

/// Published sightings that no tracker, or no tracker of the fusion, listens to.
void findLostSensors(const GraphView& graph, std::vector<Finding>& found) {
  const Names trackers = trackersOf(graph), fusions = fusionsOf(graph);
  Names fused;
  for (const GraphView::Topic& topic : graph.topics) {
    if (topic.type == typeOf<sightline::TrackArray>() && !common(topic.subscribers, fusions).empty())
      fused.insert(topic.publishers.begin(), topic.publishers.end());
  }
  for (const GraphView::Topic& topic : sightingTopics(graph)) {
    if (topic.publishers.empty() || trackers.empty()) continue;
    const Names listening = common(topic.subscribers, trackers);
    if (listening.empty()) {
      found.push_back(
          {topic.name, "no tracker listens to it: add it to sighting_topics of a local_tracker (" +
                           listOf(trackers, 3) + ")"});
    } else if (!fusions.empty() && common(listening, fused).empty()) {
      found.push_back({topic.name, "is tracked by " + listOf(listening) +
                                       " alone, whose tracks are in no fusion: add them to track_topics of " +
                                       listOf(fusions)});
    }
  }
}

}  // namespace

GraphView viewOfGraph(const std::string& myself) {
  GraphView graph;
  const XmlRpc::XmlRpcValue state = askMaster("getSystemState", myself);
  XmlRpc::XmlRpcValue types = askMaster("getTopicTypes", myself);
  XmlRpc::XmlRpcValue lists = state;
  const auto publishers = nodesByTopic(lists[0], myself), subscribers = nodesByTopic(lists[1], myself);
  for (int i = 0; i < types.size(); ++i) {  // NOLINT(modernize-loop-convert): an array, as above
    GraphView::Topic topic;
    topic.name = static_cast<std::string>(types[i][0]);
    topic.type = static_cast<std::string>(types[i][1]);
    if (const auto who = publishers.find(topic.name); who != publishers.end()) topic.publishers = who->second;
    if (const auto who = subscribers.find(topic.name); who != subscribers.end())
      topic.subscribers = who->second;
    graph.topics.push_back(topic);
  }
  ros::param::param("/use_sim_time", graph.use_sim_time, false);
  return graph;
}

std::vector<GraphView::Topic> sightingTopics(const GraphView& graph) {
  std::vector<GraphView::Topic> topics;
  for (const GraphView::Topic& topic : graph.topics) {
    if (topic.type == typeOf<sightline::SightingArray>()) topics.push_back(topic);
  }
  return topics;
}

std::set<std::string> trackersOf(const GraphView& graph) {
  return publishersOf(graph, typeOf<sightline::AssociationArray>());
}

std::set<std::string> fusionsOf(const GraphView& graph) {
  return publishersOf(graph, typeOf<sightline::FusionReport>());
}

bool isPublished(const GraphView& graph, const std::string& name) {
  return std::any_of(graph.topics.begin(), graph.topics.end(), [&](const GraphView::Topic& topic) {
    return topic.name == name && !topic.publishers.empty();
  });
}

Finding missingSightings() {
  return {
      "sightings",
      "nobody publishes sightline/SightingArray: start the sensors' drivers, or a sighting_adapter for what "
      "they publish"};
}

std::vector<Finding> findingsOf(const GraphView& graph) {
  std::vector<Finding> found;
  findDeadTopics(graph, typeOf<sightline::SightingArray>(), withoutDisplays(graph, trackersOf(graph)),
                 "sighting_topics", found);
  findDeadTopics(graph, typeOf<sightline::TrackArray>(), withoutDisplays(graph, fusionsOf(graph)),
                 "track_topics", found);
  findLostSensors(graph, found);
  const bool has_sightings =
      std::any_of(graph.topics.begin(), graph.topics.end(), [](const GraphView::Topic& topic) {
        return topic.type == typeOf<sightline::SightingArray>() && !topic.publishers.empty();
      });
  if (!has_sightings) found.push_back(missingSightings());
  return found;
}

}  // namespace sightline_ros
