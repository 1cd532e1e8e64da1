#pragma once

#include <memory>
#include <stdexcept>
#include <string>
#include <vector>
#include <xmlrpcpp/XmlRpcValue.h>

#include <ros/node_handle.h>

#include "sightline/ros/params/param_range.h"

namespace sightline_ros {

/// A configuration that cannot be used. The message is one line: full parameter name, what was expected with
/// its unit, what was found, and the remedy where one is known.
struct ParamError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A number, flag or text as it was read: what a loader asked for, and what it got.
struct ReadParam {
  enum class Kind { number, integer, flag, text };
  std::string key;  ///< below the reader, sub-namespaces before a slash: "gate/probability"
  Kind kind = Kind::text;
  XmlRpc::XmlRpcValue value;         ///< in force
  XmlRpc::XmlRpcValue fallback;      ///< what it is where it is not set
  Range range;                       ///< of a number or an integer
  std::string unit;                  ///< of a number, may be empty
  std::vector<std::string> choices;  ///< of a text; empty = any
};

/// Reads one tree of parameters strictly: a wrong type, a value out of range, a missing required key and a
/// key that nobody asked for are refused with a ParamError. It remembers what was read; a reader and its
/// sub-readers and copies share that memory. Whole numbers serve as numbers; nothing else is converted.
class ParamReader {
 public:
  /// Everything below the node handle's namespace, as it is on the parameter server now.
  explicit ParamReader(const ros::NodeHandle& nh);

  /// A tree at hand (a struct, or invalid for "no parameters"); `name` is put before every key in messages.
  ParamReader(const XmlRpc::XmlRpcValue& tree, std::string name);

  /// A YAML file, its scalars typed as roslaunch types them: `1e-3` is a string there, `deg(0.5)` is in
  /// radians.
  static ParamReader fromYaml(const std::string& file);

  /// Several files into one tree, as roslaunch loads them one after the other: maps merge, otherwise the
  /// later file wins. Messages name the last file.
  static ParamReader fromYamlFiles(const std::vector<std::string>& files);

  /// The sub-namespace `key`; empty when it is not there.
  ParamReader sub(const std::string& key) const;

  /// The same tree with one key set to another value, for what a command line overrides.
  ParamReader with(const std::string& key, const XmlRpc::XmlRpcValue& value) const;

  /// The same with a key of a sub-namespace, "gate/probability", and with a memory of its own.
  ParamReader withKey(const std::string& path, const XmlRpc::XmlRpcValue& value) const;

  /// Each element of a list of maps; empty when the key is not there.
  std::vector<ParamReader> list(const std::string& key) const;

  bool has(const std::string& key) const;
  std::vector<std::string> keys() const;  ///< of this level, sorted
  const std::string& name() const { return name_; }

  /// The parameter, or `fallback` when it is not set. `unit` is for the message only.
  double number(const std::string& key, double fallback, const Range& range,
                const std::string& unit = "") const;
  int integer(const std::string& key, int fallback, int low, int high) const;
  bool flag(const std::string& key, bool fallback) const;
  std::string text(const std::string& key, const std::string& fallback) const;
  std::string choice(const std::string& key, const std::string& fallback,
                     const std::vector<std::string>& choices) const;
  std::vector<std::string> texts(const std::string& key, const std::vector<std::string>& fallback) const;
  std::vector<double> numbers(const std::string& key, const std::vector<double>& fallback, const Range& each,
                              const std::string& unit = "") const;

  /// The parameter, which has to be set. Texts are refused when empty, lists when they have no element.
  double requiredNumber(const std::string& key, const Range& range, const std::string& unit = "") const;
  std::string requiredText(const std::string& key) const;
  std::vector<std::string> requiredTexts(const std::string& key) const;
  std::vector<double> requiredNumbers(const std::string& key, const Range& each,
                                      const std::string& unit = "") const;

  /// An error about `key`, for checks that a range cannot express: "<full name>: <complaint>".
  ParamError error(const std::string& key, const std::string& complaint) const;

  /// Refuses every key at or below this level that nobody read.
  void finish() const;

  /// Every number, flag and text at or below this level that was read with a fallback, by key.
  std::vector<ReadParam> readParams() const;

  /// Full names of the keys at or below this level that were read and are absent or differ from the fallback.
  std::vector<std::string> differences() const;

 private:
  struct Memory;

  ParamReader(std::shared_ptr<XmlRpc::XmlRpcValue> tree, std::string name, std::shared_ptr<Memory> memory);

  std::string fullName(const std::string& key) const;
  bool isBelow(const std::string& full_name) const;
  XmlRpc::XmlRpcValue* find(const std::string& key) const;
  XmlRpc::XmlRpcValue& findRequired(const std::string& key, const std::string& expected) const;
  void remember(const std::string& key, bool equals_fallback) const;
  void remember(const std::string& key, ReadParam read) const;

  std::shared_ptr<XmlRpc::XmlRpcValue> tree_;
  std::string name_;
  std::shared_ptr<Memory> memory_;
};

}  // namespace sightline_ros
