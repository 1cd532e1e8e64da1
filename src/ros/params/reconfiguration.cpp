#include "sightline/ros/params/reconfiguration.h"

#include <algorithm>
#include <set>
#include <stdexcept>
#include <utility>

#include "sightline/ros/params/param_text.h"

namespace sightline_ros {
namespace {

using XmlRpc::XmlRpcValue;

std::vector<ReadParam> chosenFrom(const std::vector<ReadParam>& read,
                                  const std::vector<ChangeableParam>& table) {
  std::vector<ReadParam> chosen;
  for (const ChangeableParam& entry : table) {
    const auto it = std::find_if(read.begin(), read.end(),
                                 [&](const ReadParam& param) { return param.key == entry.key; });
    if (it == read.end()) throw std::logic_error(entry.key + " may change, but nobody has read it");
    chosen.push_back(*it);
  }
  return chosen;
}

/// A whole number where a number is asked for is one.
XmlRpcValue asKindOf(const ReadParam& param, XmlRpcValue value) {
  if (param.kind != ReadParam::Kind::number || value.getType() != XmlRpcValue::TypeInt) return value;
  return {static_cast<double>(static_cast<int>(value))};
}

const std::vector<ChangeableParam>& guardThresholds() {
  static const std::vector<ChangeableParam> table = {
      {"guard/noise_threshold",
       "log likelihood ratio at which a sensor's noise counts as grown; larger = fewer false alarms, later"},
      {"guard/bias_threshold",
       "cumulated innovations at which a sensor counts as biased [sigma]; larger = fewer false alarms, "
       "later"},
      {"guard/noise_release", "variance over the stated one below which a noisy sensor is healthy again"},
      {"guard/bias_release", "mean innovation below which a biased sensor is healthy again [sigma]"},
      {"guard/least_exclusion", "least time that a biased sensor is left out [s]"},
  };
  return table;
}

std::vector<ChangeableParam> joinedTables(std::vector<ChangeableParam> table,
                                          const std::vector<ChangeableParam>& more) {
  table.insert(table.end(), more.begin(), more.end());
  return table;
}

}  // namespace

const std::vector<ChangeableParam>& changeableTrackerParams() {
  static const std::vector<ChangeableParam> table = joinedTables(
      {
          {"gate/probability", "probability that a sighting of the target is inside the gate"},
          {"gate/shape", "shape of the accepted region"},
          {"gate/min_half_width", "least half width of the gate [rad]"},
          {"gate/max_half_width", "largest half width of the gate [rad]"},
          {"association", "how sightings are given to tracks"},
          {"adapt_gate", "whether gates grow where innovations are larger than they should be"},
          {"noise_calibration/enabled",
           "whether the actual noise of sensors is learnt; a change forgets what was"},
          {"lifecycle/by_existence", "whether the probability of existence confirms and deletes tracks"},
          {"lifecycle/confirm_hits", "sightings that confirm a track, at least"},
          {"lifecycle/confirm_scans", "scans within which, without existence"},
          {"lifecycle/confirm_existence", "probability of existence that confirms a track"},
          {"lifecycle/show_existence",
           "probability of existence below which an established track is not published"},
          {"lifecycle/coast_misses", "misses in a row after which a track coasts"},
          {"lifecycle/coast_silence", "silence after which a track coasts [units of its time]"},
          {"lifecycle/delete_misses", "misses in a row after which a track is lost, without existence"},
          {"lifecycle/delete_silence", "silence after which a track is lost [units of its time]"},
          {"lifecycle/remember",
           "silence up to which a lost track goes on when it is seen again [units of its time]"},
          {"lifecycle/max_spread",
           "width of the gate over that of the sightings beyond which a track is deleted"},
          {"lifecycle/merge_scans", "scans in a row after which a second track of one target is deleted"},
          {"lifecycle/mean_life", "mean time that a target stays in view [units of its time]"},
          {"lifecycle/mean_shown", "mean time until a target is hidden [units of its time]"},
          {"lifecycle/mean_hidden", "mean time that it stays hidden [units of its time]"},
          {"lifecycle/mean_patience", "mean time until a hidden target leaves for good [units of its time]"},
      },
      guardThresholds());
  return table;
}

const std::vector<ChangeableParam>& changeableFusionParams() {
  static const std::vector<ChangeableParam> table = joinedTables(
      {
          {"rule", "how local tracks are fused"},
          {"intersection_weights", "what covariance_intersection makes smallest"},
          {"allow_shared_sensors",
           "whether local tracks with a sensor in common are fused: its sightings count twice"},
          {"gate/probability", "probability that two tracks of one target are recognised as such"},
          {"gate/leave_factor", "times the gate's threshold at which a supporter contradicts the others"},
          {"gate/leave_after", "time of contradiction after which a supporter leaves [s]"},
          {"coasting_age", "time for which a coasting local track counts [s]"},
          {"delete_after",
           "time for which a global track without supporters may be continued by a new one [s]"},
          {"remember", "time within which a local track that returns continues its global track [s]"},
          {"tracklets/max_missing", "share of lost tracklets beyond which another rule is better"},
      },
      guardThresholds());
  return table;
}

Reconfiguration::Reconfiguration(const ParamReader& reader, const std::vector<ChangeableParam>& table,
                                 Apply apply)
    : reader_(reader),
      at_start_(reader.readParams()),
      table_(table),
      apply_(std::move(apply)),
      params_(chosenFrom(at_start_, table)) {}

ReconfigurationResult Reconfiguration::change(std::map<std::string, XmlRpcValue> wanted) {
  ReconfigurationResult result;
  ParamReader reader = reader_;
  std::string wish;
  for (auto& [key, value] : wanted) {
    const ReadParam* param = find(key);
    if (param == nullptr) {
      result.refusal = key + " " + whyFixed(key);
      return result;
    }
    const XmlRpcValue to = asKindOf(*param, value);
    if (to == param->value) continue;
    reader = reader.withKey(key, to);
    wish += (wish.empty() ? "" : ", ") + key + " = " + shortText(to);
    result.changes.push_back({key, param->value, to});
  }
  if (result.changes.empty()) return result;
  try {
    if (const auto refusal = apply_(reader)) result.refusal = wish + ": " + refusal->detail;
  } catch (const ParamError& problem) {
    result.refusal = wish + ": " + problem.what();
  }
  if (result.refusal) {
    result.changes.clear();
  } else {
    reader_ = reader;
    params_ = chosenFrom(reader.readParams(), table_);
  }
  return result;
}

const ReadParam* Reconfiguration::find(const std::string& key) const {
  const auto it =
      std::find_if(params_.begin(), params_.end(), [&](const ReadParam& param) { return param.key == key; });
  return it == params_.end() ? nullptr : &*it;
}

/// Why a parameter that is not in the table cannot change.
std::string Reconfiguration::whyFixed(const std::string& key) const {
  std::set<std::string> asked;
  for (const ReadParam& param : at_start_) asked.insert(param.key);
  if (asked.count(key) > 0)
    return "holds from the start of the node: set the parameter and start the node again";
  const std::string meant = nearestName(key, asked);
  return "is no parameter of this node" + (meant.empty() ? "" : " (did you mean " + meant + "?)");
}

std::string shortText(XmlRpcValue value) {
  return value.getType() == XmlRpcValue::TypeString ? static_cast<std::string>(value) : textOf(value);
}

}  // namespace sightline_ros
