#pragma once

#include <string>
#include <vector>

#include "sightline/core/model/time.h"
#include "sightline/core/model/track.h"

namespace sightline::core {

/// What a tracker, or a fusion, reports at one instant.
struct TrackReport {
  Time time{};                ///< at which every state is valid
  std::string tracker;        ///< its name
  bool fused = false;         ///< whether the tracks are made of tracks
  std::vector<Track> tracks;  ///< in the tracking frame
};

}  // namespace sightline::core
