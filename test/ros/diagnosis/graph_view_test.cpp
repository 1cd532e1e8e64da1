#include "sightline/ros/diagnosis/graph_view.h"

#include <string>

#include <gtest/gtest.h>

namespace {

using sightline_ros::Finding;
using sightline_ros::GraphView;

const std::string kSightings = "sightline/SightingArray", kTracks = "sightline/TrackArray",
                  kAssociations = "sightline/AssociationArray", kReports = "sightline/FusionReport",
                  kMarkers = "visualization_msgs/MarkerArray";

/// Two sensors, each tracked, and a fusion of both trackers' tracks.
GraphView healthy() {
  GraphView graph;
  for (const std::string side : {"left", "right"}) {
    const std::string space = "/" + side, tracker = space + "/tracker";
    graph.topics.push_back({space + "/sightings", kSightings, {space + "/driver"}, {tracker}});
    graph.topics.push_back({space + "/tracks", kTracks, {tracker}, {"/fusion"}});
    graph.topics.push_back({space + "/associations", kAssociations, {tracker}, {}});
  }
  graph.topics.push_back({"/fusion/report", kReports, {"/fusion"}, {}});
  return graph;
}

GraphView::Topic& topic(GraphView& graph, const std::string& name) {
  for (GraphView::Topic& topic : graph.topics) {
    if (topic.name == name) return topic;
  }
  throw std::runtime_error("no topic " + name);
}

/// The only finding, as "subject: words".
std::string onlyFinding(const GraphView& graph) {
  const auto found = findingsOf(graph);
  return found.size() == 1 ? found[0].subject + ": " + found[0].words
                           : std::to_string(found.size()) + " findings";
}

TEST(GraphView, FindsNothingWrongWithAHealthyGraph) {
  EXPECT_TRUE(findingsOf(healthy()).empty());
  EXPECT_EQ(trackersOf(healthy()), (std::set<std::string>{"/left/tracker", "/right/tracker"}));
  EXPECT_EQ(fusionsOf(healthy()), (std::set<std::string>{"/fusion"}));
  EXPECT_EQ(sightingTopics(healthy()).size(), 2u);
}

TEST(GraphView, ATrackerThatListensInVainIsFoundWithWhatIsPublished) {
  GraphView graph = healthy();
  graph.topics.push_back({"/lfet/sightings", kSightings, {}, {"/left/tracker"}});
  const std::string found = onlyFinding(graph);
  EXPECT_EQ(found.find("/lfet/sightings: /left/tracker listens to it, and nobody publishes it"), 0u) << found;
  EXPECT_NE(found.find("published are /left/sightings, /right/sightings"), std::string::npos) << found;
}

TEST(GraphView, ADisplayMayListenInVain) {
  GraphView graph = healthy();
  topic(graph, "/left/associations").publishers.insert("/display");
  graph.topics.push_back({"/display/all", kMarkers, {"/display"}, {}});
  graph.topics.push_back({"/absent/sightings", kSightings, {}, {"/display"}});
  EXPECT_TRUE(findingsOf(graph).empty()) << onlyFinding(graph);
}

TEST(GraphView, ASensorWithoutTrackerIsFound) {
  GraphView graph = healthy();
  topic(graph, "/left/sightings").subscribers = {"/recorder"};
  EXPECT_EQ(onlyFinding(graph).find("/left/sightings: no tracker listens to it"), 0u) << onlyFinding(graph);
}

TEST(GraphView, ATrackerThatIsInNoFusionIsFound) {
  GraphView graph = healthy();
  topic(graph, "/left/tracks").subscribers.clear();
  EXPECT_EQ(onlyFinding(graph).find("/left/sightings: is tracked by /left/tracker alone"), 0u)
      << onlyFinding(graph);
}

TEST(GraphView, AGraphWithoutSightingsIsFound) {
  EXPECT_NE(onlyFinding(GraphView{}).find("nobody publishes sightline/SightingArray"), std::string::npos);
  EXPECT_FALSE(isPublished(GraphView{}, "/clock"));
  EXPECT_TRUE(isPublished(healthy(), "/fusion/report"));
}

}  // namespace
