#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "sightline/core/model/refusal.h"

namespace sightline::core {

/// Names of sensors, trackers and frames are repeated in every report: longer ones are refused.
constexpr std::size_t kLongestName = 255;      // letters
constexpr std::size_t kMostNamesOfOne = 1024;  // sensors that one track has its state from

/// The beginning of a name that is too long, for messages about it.
inline std::string readableName(const std::string& name) {
  return name.size() <= kLongestName ? name : name.substr(0, 32) + "...";
}

/// Why a name is refused as too long; nullopt when it is not. `what` it is: "the sensor's name".
inline std::optional<Refusal> whyTooLong(const std::string& what, const std::string& name) {
  if (name.size() <= kLongestName) return std::nullopt;
  return invalid(what + " \"" + readableName(name) + "\" has " + std::to_string(name.size()) +
                 " letters: give it at most " + std::to_string(kLongestName));
}

/// The same of the sensors that a track has its state from, and of how many they are.
inline std::optional<Refusal> whyTooLong(const std::vector<std::string>& sources) {
  if (sources.size() > kMostNamesOfOne)
    return invalid(std::to_string(sources.size()) + " sources: a track may have " +
                   std::to_string(kMostNamesOfOne));
  for (const std::string& source : sources) {
    if (auto refusal = whyTooLong("the source", source)) return refusal;
  }
  return std::nullopt;
}

}  // namespace sightline::core
