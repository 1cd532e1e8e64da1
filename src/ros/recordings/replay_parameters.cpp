#include "sightline/ros/recordings/replay_parameters.h"

#include <algorithm>

#include <yaml-cpp/yaml.h>

#include <rosbag/view.h>
#include <std_msgs/String.h>

#include "sightline/report/value_text.h"
#include "sightline/ros/recordings/bags.h"

namespace sightline_ros {
namespace {

const char* const kWrittenInPart = "--all: no\n";

/// "[1, 2]" of a list, whatever its style in the file.
std::string flowTextOf(const YAML::Node& node) {
  YAML::Emitter emitter;
  emitter << YAML::Flow << node;
  return emitter.c_str();
}

void addLines(const std::string& name, const YAML::Node& node, std::string& text) {
  if (!node.IsMap()) {
    text += name + ": " + (node.IsScalar() ? node.Scalar() : flowTextOf(node)) + "\n";
    return;
  }
  for (const auto& entry : node)
    addLines((name.empty() ? "" : name + "/") + entry.first.Scalar(), entry.second, text);
}

}  // namespace

bool isWrittenInPart(const rosbag::Bag& bag) {
  rosbag::View view(bag, rosbag::TopicQuery(kReplayParameters));
  return std::any_of(view.begin(), view.end(), [](const rosbag::MessageInstance& message) {
    if (!message.isType<std_msgs::String>()) return false;
    const auto told = messageIn<std_msgs::String>(message);
    return told->data.find(kWrittenInPart) != std::string::npos;
  });
}

ParamReader configurationOf(const ReplaySettings& settings) {
  return settings.config.empty() ? ParamReader(XmlRpc::XmlRpcValue(), "")
                                 : ParamReader::fromYaml(settings.config);
}

ParamReader sectionOf(const ParamReader& config, const std::string& name, const std::string& key,
                      const std::string& choice) {
  const ParamReader section = config.sub(name);
  return choice.empty() ? section : section.with(key, choice);
}

ParamReader fusionSectionOf(const ParamReader& config, const ReplaySettings& settings) {
  const ParamReader section = sectionOf(config, "track_fusion", "rule", settings.rule);
  return settings.estimator.empty() ? section : section.with("estimator", settings.estimator);
}

std::string parametersText(const ReplaySettings& settings) {
  std::string text = "--config: " + (settings.config.empty() ? "none" : settings.config) + "\n";
  if (!settings.config.empty()) {
    const YAML::Node file = YAML::LoadFile(settings.config);
    if (file.IsMap()) addLines("", file, text);
  }
  if (!settings.estimator.empty()) text += "--estimator: " + settings.estimator + "\n";
  if (!settings.rule.empty()) text += "--rule: " + settings.rule + "\n";
  if (settings.positions) text += std::string("--positions: ") + (*settings.positions ? "yes" : "no") + "\n";
  if (settings.smooth) text += "--smooth: yes\n";
  if (settings.lag) text += "--lag: " + sightline::report::valueOf(*settings.lag, "s") + "\n";
  for (const std::string& topic : settings.topics) text += "--topics: " + topic + "\n";
  if (settings.topics.empty()) text += settings.all ? "--all: yes\n" : kWrittenInPart;
  if (settings.live) text += "--live: yes\n";
  return text;
}

}  // namespace sightline_ros
