#include "sightline/ros/nodes/reconfigure_server.h"

#include <exception>
#include <map>
#include <utility>

#include <ros/console.h>

#include "sightline/ros/nodes/this_node.h"
#include "sightline/ros/params/param_text.h"

namespace sightline_ros {
namespace {

using XmlRpc::XmlRpcValue;

const char* const kGroupName = "Default";  // of all parameters, as clients expect it

dynamic_reconfigure::Config emptyConfig() {
  dynamic_reconfigure::Config config;
  config.groups.resize(1);
  config.groups[0].name = kGroupName;
  config.groups[0].state = true;
  return config;
}

template <typename Entry, typename Value>
void append(const std::string& key, const Value& value, std::vector<Entry>& entries) {
  Entry entry;
  entry.name = key;
  entry.value = value;
  entries.push_back(std::move(entry));
}

void append(const ReadParam& param, XmlRpcValue value, dynamic_reconfigure::Config& config) {
  switch (param.kind) {
    case ReadParam::Kind::number:
      return append(param.key, static_cast<double>(value), config.doubles);
    case ReadParam::Kind::integer:
      return append(param.key, static_cast<int>(value), config.ints);
    case ReadParam::Kind::flag:
      return append(param.key, static_cast<bool>(value), config.bools);
    case ReadParam::Kind::text:
      return append(param.key, static_cast<std::string>(value), config.strs);
  }
}

/// The least and the largest value, in the kind of the parameter.
std::pair<XmlRpcValue, XmlRpcValue> limitsOf(const ReadParam& param) {
  switch (param.kind) {
    case ReadParam::Kind::number:
      return {param.range.low, param.range.high};
    case ReadParam::Kind::integer:
      return {static_cast<int>(param.range.low), static_cast<int>(param.range.high)};
    case ReadParam::Kind::flag:
      return {false, true};
    case ReadParam::Kind::text:
      break;
  }
  return {"", ""};
}

std::string typeOf(ReadParam::Kind kind) {
  switch (kind) {
    case ReadParam::Kind::number:
      return "double";
    case ReadParam::Kind::integer:
      return "int";
    case ReadParam::Kind::flag:
      return "bool";
    case ReadParam::Kind::text:
      break;
  }
  return "str";
}

/// A dictionary of Python, which clients evaluate to show a list of choices.
std::string editMethodOf(const ReadParam& param) {
  if (param.choices.empty()) return "";
  std::string entries;
  for (const std::string& choice : param.choices) {
    entries += (entries.empty() ? "" : ", ");
    entries += "{'name': '" + choice + "', 'type': 'str', 'value': '" + choice +
               "', 'description': '', 'srcline': 0, 'srcfile': '', 'cconsttype': 'const char * const', "
               "'ctype': 'std::string'}";
  }
  return "{'enum_description': '" + param.key + "', 'enum': [" + entries + "]}";
}

std::map<std::string, XmlRpcValue> valuesOf(const dynamic_reconfigure::Config& config) {
  std::map<std::string, XmlRpcValue> values;
  for (const auto& entry : config.bools) values[entry.name] = XmlRpcValue(entry.value != 0);
  for (const auto& entry : config.ints) values[entry.name] = XmlRpcValue(static_cast<int>(entry.value));
  for (const auto& entry : config.strs) values[entry.name] = XmlRpcValue(entry.value);
  for (const auto& entry : config.doubles) values[entry.name] = XmlRpcValue(entry.value);
  return values;
}

}  // namespace

dynamic_reconfigure::Config configOf(const std::vector<ReadParam>& params) {
  dynamic_reconfigure::Config config = emptyConfig();
  for (const ReadParam& param : params) append(param, param.value, config);
  return config;
}

dynamic_reconfigure::ConfigDescription descriptionOf(const Reconfiguration& reconfiguration) {
  dynamic_reconfigure::ConfigDescription description;
  description.min = description.max = description.dflt = emptyConfig();
  description.groups.resize(1);
  description.groups[0].name = kGroupName;
  for (std::size_t i = 0; i < reconfiguration.params().size(); ++i) {
    const ReadParam& param = reconfiguration.params()[i];
    const auto [least, largest] = limitsOf(param);
    append(param, least, description.min);
    append(param, largest, description.max);
    append(param, param.fallback, description.dflt);
    dynamic_reconfigure::ParamDescription entry;
    entry.name = param.key;
    entry.type = typeOf(param.kind);
    entry.description = reconfiguration.table()[i].description;
    if (param.kind == ReadParam::Kind::number)
      entry.description += ": " + expectedNumber(param.range, param.unit);
    entry.edit_method = editMethodOf(param);
    description.groups[0].parameters.push_back(entry);
  }
  return description;
}

ReconfigureServer::ReconfigureServer(const ros::NodeHandle& pnh, Reconfiguration reconfiguration)
    : pnh_(pnh),
      reconfiguration_(std::move(reconfiguration)),
      at_start_(reconfiguration_.params()),
      descriptions_(
          pnh_.advertise<dynamic_reconfigure::ConfigDescription>("parameter_descriptions", 1, true)),
      updates_(pnh_.advertise<dynamic_reconfigure::Config>("parameter_updates", 1, true)) {
  publish();
  service_ = pnh_.advertiseService("set_parameters", &ReconfigureServer::onRequest, this);
}

bool ReconfigureServer::onRequest(dynamic_reconfigure::Reconfigure::Request& request,
                                  dynamic_reconfigure::Reconfigure::Response& answer) {
  ReconfigurationResult result;
  try {
    result = reconfiguration_.change(valuesOf(request.config));
  } catch (const std::exception& problem) {
    result.refusal = std::string("failed (") + problem.what() + "); please report this";
  }
  if (result.refusal) {
    ++refused_;
    last_refusal_ = *result.refusal;
    ROS_WARN_STREAM(nameOfNode(pnh_) << ": no parameter is changed in flight: " << last_refusal_);
  }
  for (const ParamChange& change : result.changes) {
    ROS_INFO_STREAM(nameOfNode(pnh_) << ": " << change.key << " changed in flight from "
                                     << shortText(change.from) << " to " << shortText(change.to));
    pnh_.setParam(change.key, change.to);
  }
  if (!result.changes.empty()) publish();
  answer.config = configOf(reconfiguration_.params());
  return true;
}

/// The limits of one may depend on another.
void ReconfigureServer::publish() {
  descriptions_.publish(descriptionOf(reconfiguration_));
  updates_.publish(configOf(reconfiguration_.params()));
}

void ReconfigureServer::diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) const {
  for (std::size_t i = 0; i < at_start_.size(); ++i) {
    const ReadParam& param = reconfiguration_.params()[i];
    if (param.value == at_start_[i].value) continue;
    status.add("changed in flight: " + param.key,
               shortText(param.value) + " (" + shortText(at_start_[i].value) + " at the start)");
  }
  if (refused_ > 0)
    status.add("changes refused in flight", std::to_string(refused_) + ", the last: " + last_refusal_);
}

}  // namespace sightline_ros
