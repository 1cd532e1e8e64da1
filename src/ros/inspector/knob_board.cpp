#include "sightline/ros/inspector/knob_board.h"

#include <algorithm>
#include <cstdlib>
#include <dynamic_reconfigure/Reconfigure.h>
#include <limits>
#include <sstream>

#include <ros/node_handle.h>

namespace sightline_ros {
namespace {

const char* const kRefusedKey = "changes refused in flight";  // of ReconfigureServer::diagnose

/// The choices in a Python dictionary of dynamic_reconfigure: each 'value': '...'.
std::vector<std::string> choicesIn(const std::string& edit_method) {
  const std::string before = "'value': '";
  std::vector<std::string> choices;
  for (std::size_t at = edit_method.find(before); at != std::string::npos;
       at = edit_method.find(before, at)) {
    at += before.size();
    choices.push_back(edit_method.substr(at, edit_method.find('\'', at) - at));
  }
  return choices;
}

std::map<std::string, KnobValue> knobValuesOf(const dynamic_reconfigure::Config& config) {
  std::map<std::string, KnobValue> values;
  for (const auto& entry : config.bools) values[entry.name] = entry.value != 0;
  for (const auto& entry : config.ints) values[entry.name] = static_cast<int>(entry.value);
  for (const auto& entry : config.doubles) values[entry.name] = static_cast<double>(entry.value);
  for (const auto& entry : config.strs) values[entry.name] = entry.value;
  return values;
}

double limitOf(const std::map<std::string, KnobValue>& limits, const std::string& key, double unknown) {
  const auto found = limits.find(key);
  if (found == limits.end()) return unknown;
  if (const int* whole = std::get_if<int>(&found->second)) {
    const bool is_end =
        *whole == std::numeric_limits<int>::max() || *whole == std::numeric_limits<int>::min();
    return is_end ? unknown : *whole;
  }
  const double* number = std::get_if<double>(&found->second);
  return number && std::abs(*number) < 0.5 * std::numeric_limits<double>::max() ? *number : unknown;
}

dynamic_reconfigure::Config configWith(const std::string& key, const KnobValue& value) {
  dynamic_reconfigure::Config config;
  const auto add = [&](auto& entries, const auto& it) {
    entries.emplace_back();
    entries.back().name = key;
    entries.back().value = it;
  };
  if (const bool* flag = std::get_if<bool>(&value)) add(config.bools, *flag);
  if (const int* whole = std::get_if<int>(&value)) add(config.ints, *whole);
  if (const double* number = std::get_if<double>(&value)) add(config.doubles, *number);
  if (const std::string* text = std::get_if<std::string>(&value)) add(config.strs, *text);
  return config;
}

}  // namespace

std::string textOf(const KnobValue& value) {
  std::ostringstream words;
  words << std::boolalpha;
  std::visit([&words](const auto& it) { words << it; }, value);
  return words.str();
}

KnobBoard::~KnobBoard() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    is_given_up_ = true;
    client_.shutdown();  // drops the connection, so that a call that waits for its answer returns
  }
  if (thread_.joinable()) thread_.join();
}

void KnobBoard::take(const std::string& node, const dynamic_reconfigure::ConfigDescription& description) {
  constexpr double kEndless = std::numeric_limits<double>::infinity();
  const std::lock_guard<std::mutex> lock(mutex_);
  if (nodes_.size() >= kMostNodes && nodes_.count(node) == 0) return;
  const auto least = knobValuesOf(description.min), largest = knobValuesOf(description.max),
             fallbacks = knobValuesOf(description.dflt);
  std::vector<Knob> knobs;
  for (const auto& group : description.groups) {
    for (const auto& param : group.parameters) {
      const auto fallback = fallbacks.find(param.name);
      if (fallback == fallbacks.end()) continue;
      Knob knob;
      knob.key = param.name;
      knob.description = param.description;
      knob.value = knob.fallback = fallback->second;
      knob.low = limitOf(least, param.name, -kEndless);
      knob.high = limitOf(largest, param.name, kEndless);
      knob.choices = choicesIn(param.edit_method);
      for (const Knob& known : nodes_[node].knobs)
        if (known.key == knob.key) knob.value = known.value;
      knobs.push_back(std::move(knob));
    }
  }
  nodes_[node].knobs = std::move(knobs);
}

void KnobBoard::take(const std::string& node, const dynamic_reconfigure::Config& values) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto found = nodes_.find(node);
  if (found == nodes_.end()) {  // before its description
    if (nodes_.size() >= kMostNodes) return;
    for (const auto& [key, value] : knobValuesOf(values)) {
      nodes_[node].knobs.emplace_back();
      nodes_[node].knobs.back().key = key;
      nodes_[node].knobs.back().value = value;
    }
    return;
  }
  const auto in_force = knobValuesOf(values);
  for (Knob& knob : found->second.knobs) {
    const auto value = in_force.find(knob.key);
    if (value != in_force.end()) knob.value = value->second;
  }
}

void KnobBoard::take(const diagnostic_msgs::DiagnosticArray& diagnostics) {
  const std::lock_guard<std::mutex> lock(mutex_);
  for (const auto& status : diagnostics.status) {
    const auto found = nodes_.find("/" + status.name.substr(0, status.name.find(':')));
    if (found == nodes_.end()) continue;
    for (const auto& value : status.values) {
      if (value.key != kRefusedKey) continue;
      const std::size_t reason = value.value.find("last: ");
      found->second.refused = std::strtoull(value.value.c_str(), nullptr, 10);
      found->second.reason = reason == std::string::npos ? value.value : value.value.substr(reason + 6);
    }
    const bool is_told =
        refused_ && refused_->node == found->first && found->second.refused > refused_->refused_before;
    if (!is_told) continue;
    words_ = "refused: " + found->second.reason;
    refused_.reset();
  }
}

std::vector<std::string> KnobBoard::nodes() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  std::vector<std::string> names;
  for (const auto& [name, node] : nodes_)
    if (!node.knobs.empty() && !node.knobs.front().description.empty()) names.push_back(name);
  return names;
}

std::vector<Knob> KnobBoard::knobsOf(const std::string& node) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto found = nodes_.find(node);
  return found == nodes_.end() ? std::vector<Knob>() : found->second.knobs;
}

void KnobBoard::wish(const std::string& node, const std::string& key, const KnobValue& value) {
  Wish wish{node, key, value, 0};
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (is_under_way_ || is_given_up_) return;
    is_under_way_ = true;
    refused_.reset();
    wish.refused_before = nodes_[node].refused;
    words_ = key + " = " + textOf(value) + " ...";
  }
  if (thread_.joinable()) thread_.join();
  thread_ = std::thread([this, wish] { run(wish); });
}

std::optional<dynamic_reconfigure::Config> KnobBoard::askService(const std::string& node,
                                                                 const dynamic_reconfigure::Config& wanted) {
  ros::NodeHandle nh;
  // Persistent: only such a connection can be dropped from outside while a call waits.
  ros::ServiceClient client =
      nh.serviceClient<dynamic_reconfigure::Reconfigure>(node + "/set_parameters", true);
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (is_given_up_) return std::nullopt;
    client_ = client;
  }
  dynamic_reconfigure::Reconfigure call;
  call.request.config = wanted;
  const bool is_answered = client.isValid() && client.call(call);
  const std::lock_guard<std::mutex> lock(mutex_);
  client_ = ros::ServiceClient();
  return is_answered ? std::make_optional(call.response.config) : std::nullopt;
}

void KnobBoard::run(const Wish& wish) {
  const dynamic_reconfigure::Config wanted = configWith(wish.key, wish.value);
  const auto in_force = ask_ ? ask_(wish.node, wanted) : askService(wish.node, wanted);
  if (in_force) take(wish.node, *in_force);
  const std::lock_guard<std::mutex> lock(mutex_);
  words_ = in_force ? outcome(wish, *in_force)
                    : "not changed: " + wish.node + " does not answer; does it still run?";
  is_under_way_ = false;
}

std::string KnobBoard::outcome(const Wish& wish, const dynamic_reconfigure::Config& in_force) {
  const auto values = knobValuesOf(in_force);
  const auto value = values.find(wish.key);
  if (value == values.end()) return "not changed: " + wish.node + " has no " + wish.key;
  if (value->second == wish.value) return wish.key + " is " + textOf(wish.value);
  refused_ = wish;
  return "refused: " + wish.key + " = " + textOf(wish.value) + "; it stays " + textOf(value->second) +
         " (the reason comes with the node's next diagnostics)";
}

std::string KnobBoard::words() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return words_;
}

bool KnobBoard::isUnderWay() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return is_under_way_;
}

}  // namespace sightline_ros
