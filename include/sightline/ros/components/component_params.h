#pragma once

#include <cstddef>
#include <string>

#include "sightline/ros/params/param_reader.h"

namespace sightline_ros {

/// After as many messages in a row whose handling failed, a component gives up all that it tracks.
constexpr std::size_t kMostFailuresInARow = 20;

/// The name under which a component's tracks are published: ~tracker_name, or `fallback` where that is empty.
inline std::string trackerNameFrom(const ParamReader& reader, const std::string& fallback) {
  const std::string name = reader.text("tracker_name", "");
  return name.empty() ? fallback : name;
}

/// ~silence [s]: how long a source may say nothing before the diagnostics warn of it.
inline double silenceFrom(const ParamReader& reader) {
  constexpr double kDefaultSilence = 2.0;
  return reader.number("silence", kDefaultSilence, above(0.0), "s");
}

}  // namespace sightline_ros
