#pragma once

#include "sightline/core/positions/position_tracker.h"
#include "sightline/ros/params/param_reader.h"

namespace sightline_ros {

/// Reads the parameters of the position tracker at this level. Throws ParamError.
sightline::core::PositionTrackerParams loadPositionTrackerParams(
    const ParamReader& reader, sightline::core::PositionTrackerParams defaults = {});

}  // namespace sightline_ros
