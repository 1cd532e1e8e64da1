#pragma once

#include <string>

#include <sightline/TrackletArray.h>

#include "sightline/core/tracking/tracklet_builder.h"

namespace sightline_ros {

/// `frame`: the tracking frame.
sightline::TrackletArray toMessage(const sightline::core::TrackletReport& report, const std::string& frame);

/// The usable ones of a message's tracklets. `complaint` says what is wrong with the others ("invalid: which,
/// why"); empty when nothing is.
sightline::core::TrackletReport toCore(const sightline::TrackletArray& message, std::string& complaint);

}  // namespace sightline_ros
