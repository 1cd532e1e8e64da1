#pragma once

#include <set>
#include <string>
#include <vector>

#include "sightline/ros/diagnosis/sensor_record.h"

namespace sightline_ros {

/// Who publishes and who subscribes, according to the master.
struct GraphView {
  struct Topic {
    std::string name;
    std::string type;  ///< "sightline/SightingArray"
    std::set<std::string> publishers;
    std::set<std::string> subscribers;
  };
  std::vector<Topic> topics;
  bool use_sim_time = false;
};

/// Asks the master; leaves `myself` out. Throws std::runtime_error when it does not answer.
GraphView viewOfGraph(const std::string& myself);

/// Topics of scans.
std::vector<GraphView::Topic> sightingTopics(const GraphView& graph);

/// Nodes that track sightings: they publish associations.
std::set<std::string> trackersOf(const GraphView& graph);

/// Nodes that fuse tracks: they publish fusion reports.
std::set<std::string> fusionsOf(const GraphView& graph);

/// Whether somebody publishes the topic.
bool isPublished(const GraphView& graph, const std::string& topic);

/// That there are no scans at all.
Finding missingSightings();

/// What is wrong with the subscriptions: trackers and fusions that subscribe to topics that nobody publishes,
/// sensors to which no tracker subscribes, trackers whose sensors are in no fusion.
std::vector<Finding> findingsOf(const GraphView& graph);

}  // namespace sightline_ros
