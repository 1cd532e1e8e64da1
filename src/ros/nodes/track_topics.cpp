#include "sightline/ros/nodes/track_topics.h"

#include <set>

#include <ros/names.h>

namespace sightline_ros {

std::vector<std::string> trackTopicsFrom(const ParamReader& reader, const ros::NodeHandle& nh) {
  std::set<std::string> seen;
  std::vector<std::string> topics;
  for (const std::string& topic : reader.requiredTexts("track_topics")) {
    topics.push_back(nh.resolveName(topic));
    if (!seen.insert(topics.back()).second) {
      throw reader.error("track_topics", "expected different topics, got " + topics.back() + " twice");
    }
  }
  if (topics.size() < 2) {
    throw reader.error("track_topics", "expected two topics of sightline/TrackArray or more, got one");
  }
  return topics;
}

std::vector<std::string> trackletTopicsFrom(const ParamReader& reader, const ros::NodeHandle& nh,
                                            const std::vector<std::string>& track_topics) {
  std::set<std::string> topics;
  for (const std::string& topic : reader.texts("tracklet_topics", {})) {
    if (!topics.insert(nh.resolveName(topic)).second) {
      throw reader.error("tracklet_topics",
                         "expected different topics, got " + nh.resolveName(topic) + " twice");
    }
  }
  if (topics.empty()) {
    for (const std::string& topic : track_topics)
      topics.insert(ros::names::append(ros::names::parentNamespace(topic), "tracklets"));
  }
  return {topics.begin(), topics.end()};
}

}  // namespace sightline_ros
