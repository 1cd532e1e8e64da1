#include "fuzz/ros/ros_targets.h"

namespace sightline_fuzz {

const std::vector<FuzzTarget>& rosTargets() {
  static const std::vector<FuzzTarget> targets = {
      {"adapter_fields", "adapter: any message by field paths, with bytes and definitions changed",
       fuzzAdapterFields},
      {"adapter_messages", "adapter: standard messages and cameras with absurd values", fuzzAdapterMessages},
      {"configurations", "YAML files of parameters: changed and cut files", fuzzConfigurations},
      {"recordings", "replay and doctor of bags with absurd and cut messages", fuzzRecordings},
  };
  return targets;
}

}  // namespace sightline_fuzz
