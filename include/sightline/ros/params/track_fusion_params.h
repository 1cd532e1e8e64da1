#pragma once

#include "sightline/core/fusion/track_fusion.h"
#include "sightline/ros/params/param_reader.h"

namespace sightline_ros {

/// Reads the keys of config/track_fusion.yaml that make the fusion, at this level of `reader`, and the
/// settings of its estimators, named as in config/local_tracker.yaml; defaults, units and meaning are at the
/// structs. Throws ParamError.
sightline::core::TrackFusionParams loadTrackFusionParams(const ParamReader& reader,
                                                         sightline::core::TrackFusionParams defaults = {});

}  // namespace sightline_ros
