#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>
#include <xmlrpcpp/XmlRpcValue.h>

#include "sightline/core/model/refusal.h"
#include "sightline/ros/params/param_reader.h"

namespace sightline_ros {

/// A parameter that may change while a node runs.
struct ChangeableParam {
  std::string key;          ///< as in the YAML: "gate/probability"
  std::string description;  ///< one line for a person at a slider, with the unit
};

/// Those of a local tracker, keys of config/local_tracker.yaml: what core::whyNotInFlight allows.
const std::vector<ChangeableParam>& changeableTrackerParams();

/// Those of a track fusion, keys of config/track_fusion.yaml: likewise.
const std::vector<ChangeableParam>& changeableFusionParams();

/// A parameter that has changed.
struct ParamChange {
  std::string key;
  XmlRpc::XmlRpcValue from, to;
};

/// What became of a wish to change parameters: all of it or nothing.
struct ReconfigurationResult {
  std::vector<ParamChange> changes;    ///< in the order of the keys; values equal to those in force are none
  std::optional<std::string> refusal;  ///< one line, why nothing has changed
};

/// The parameters of a running node that may change, with the values in force. Types, limits and defaults are
/// those that the loader asked for when it read the parameters; a change goes through the same loader.
class Reconfiguration {
 public:
  /// Loads the parameters again and goes on with them. Throws ParamError, or returns why not; then it has
  /// changed nothing.
  using Apply = std::function<std::optional<sightline::core::Refusal>(const ParamReader&)>;

  /// `reader`: with which the parameters of `table` have been loaded. Throws std::logic_error when one of
  /// them was not.
  Reconfiguration(const ParamReader& reader, const std::vector<ChangeableParam>& table, Apply apply);

  /// Changes parameters by their keys, all at once.
  ReconfigurationResult change(std::map<std::string, XmlRpc::XmlRpcValue> wanted);

  /// The parameters with the values in force, in the order of the table.
  const std::vector<ReadParam>& params() const { return params_; }

  const std::vector<ChangeableParam>& table() const { return table_; }

 private:
  const ReadParam* find(const std::string& key) const;
  std::string whyFixed(const std::string& key) const;

  ParamReader reader_;
  std::vector<ReadParam> at_start_;  // all that was read then
  std::vector<ChangeableParam> table_;
  Apply apply_;
  std::vector<ReadParam> params_;
};

/// The value alone: `0.9`, `true`, `best`.
std::string shortText(XmlRpc::XmlRpcValue value);

}  // namespace sightline_ros
