#pragma once

#include <optional>
#include <string>

#include <sightline/TrackletArray.h>

#include "sightline/core/model/refusal.h"
#include "sightline/core/tracking/tracklet_builder.h"

namespace sightline_ros {

/// `frame`: the tracking frame.
sightline::TrackletArray toMessage(const sightline::core::TrackletReport& report, const std::string& frame);

/// What a message of tracklets says.
struct ReadTracklets {
  sightline::core::TrackletReport report;           ///< with the tracklets that can be used
  std::optional<sightline::core::Refusal> refusal;  ///< of the last that cannot: which one, and why
};

ReadTracklets readTracklets(const sightline::TrackletArray& message);

}  // namespace sightline_ros
