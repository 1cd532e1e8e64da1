#pragma once

#include <cstdint>
#include <dynamic_reconfigure/Config.h>
#include <dynamic_reconfigure/ConfigDescription.h>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <variant>
#include <vector>

#include <diagnostic_msgs/DiagnosticArray.h>
#include <ros/service_client.h>

namespace sightline_ros {

using KnobValue = std::variant<bool, int, double, std::string>;

/// A parameter of a running node that may change in flight.
struct Knob {
  std::string key, description;      ///< "gate/probability"; one line with the unit
  KnobValue value, fallback;         ///< in force; the default
  double low = 0.0, high = 0.0;      ///< of numbers; infinite where there is no limit
  std::vector<std::string> choices;  ///< of a text; empty = any
};

/// `0.9`, `true`, `best`.
std::string textOf(const KnobValue& value);

/// The parameters that may change in flight, of all nodes that speak dynamic_reconfigure's messages as
/// ReconfigureServer does, and wishes to change them. One wish at a time, in a thread of its own; what became
/// of it is read from the values in force then, and the reason of a refusal from /diagnostics. Safe from any
/// thread.
class KnobBoard {
 public:
  static constexpr std::size_t kMostNodes = 64;

  /// Wishes values of a node; the values in force then, nullopt when it does not answer.
  using Ask = std::function<std::optional<dynamic_reconfigure::Config>(
      const std::string& node, const dynamic_reconfigure::Config& wanted)>;

  KnobBoard() = default;

  /// With something else than the node's service, for tests.
  explicit KnobBoard(Ask ask) : ask_(std::move(ask)) {}

  ~KnobBoard();

  /// From `node`'s topics parameter_descriptions and parameter_updates.
  void take(const std::string& node, const dynamic_reconfigure::ConfigDescription& description);
  void take(const std::string& node, const dynamic_reconfigure::Config& values);
  void take(const diagnostic_msgs::DiagnosticArray& diagnostics);

  /// Full names of the nodes that have said what may change.
  std::vector<std::string> nodes() const;
  std::vector<Knob> knobsOf(const std::string& node) const;

  /// Wishes a value; nothing happens while another wish is under way.
  void wish(const std::string& node, const std::string& key, const KnobValue& value);

  /// What became of the last wish, in one line; empty before the first.
  std::string words() const;
  bool isUnderWay() const;

 private:
  struct Node {
    std::vector<Knob> knobs;
    std::uint64_t refused = 0;  // wishes of anybody, by its diagnostics
    std::string reason;         // of the last one
  };
  struct Wish {
    std::string node, key;
    KnobValue value;
    std::uint64_t refused_before = 0;
  };

  void run(const Wish& wish);
  std::optional<dynamic_reconfigure::Config> askService(const std::string& node,
                                                        const dynamic_reconfigure::Config& wanted);
  std::string outcome(const Wish& wish, const dynamic_reconfigure::Config& in_force);

  const Ask ask_;             // empty: the node's service
  mutable std::mutex mutex_;  // of everything below but the thread
  std::map<std::string, Node> nodes_;
  std::optional<Wish> refused_;  // the last wish, while the reason of its refusal is not known
  ros::ServiceClient client_;
  std::string words_;
  bool is_under_way_ = false, is_given_up_ = false;
  std::thread thread_;
};

}  // namespace sightline_ros
