#pragma once

#include <string>

#include <rosbag/bag.h>

#include "sightline/ros/params/param_reader.h"
#include "sightline/ros/recordings/replay.h"

namespace sightline_ros {

/// Whether lines "key: value" of a replay's or a node's parameters are on a topic of that name.
inline bool isParameterTopic(const std::string& topic) {
  const std::string end = "/parameters";
  return topic.size() > end.size() && topic.compare(topic.size() - end.size(), end.size(), end) == 0;
}

/// Topic (std_msgs/String) on which a replay says what it was told.
constexpr const char* kReplayParameters = "/replay/parameters";

/// Whether a replay wrote this recording, and not every message of its topics: see ReplaySettings::all.
bool isWrittenInPart(const rosbag::Bag& bag);

/// The configuration of a replay; empty where there is none. Throws ParamError.
ParamReader configurationOf(const ReplaySettings& settings);

/// A section of the configuration with `choice` (empty = none) under `key`.
ParamReader sectionOf(const ParamReader& config, const std::string& name, const std::string& key,
                      const std::string& choice);

/// The section of the fusion, which has an estimator, too.
ParamReader fusionSectionOf(const ParamReader& config, const ReplaySettings& settings);

/// What a replay was told, one "name: value" a line: the configuration file, every value in it by its full
/// name ("local_tracker/gate_probability: 0.99"), and --estimator, --rule, --positions, --topics and --live
/// where they were given, and whether --all was. What is not in it has its default. Throws ParamError or
/// YAML::Exception for a file that cannot be read.
std::string parametersText(const ReplaySettings& settings);

}  // namespace sightline_ros
