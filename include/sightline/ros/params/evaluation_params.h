#pragma once

#include "sightline/core/evaluation/evaluation.h"
#include "sightline/ros/params/param_reader.h"

namespace sightline_ros {

/// Reads the keys of this level that are named as the fields, `azimuth_only` for the channels, and
/// `gospa/cutoff` and `gospa/order`. Throws ParamError.
sightline::core::EvaluationParams loadEvaluationParams(const ParamReader& reader,
                                                       sightline::core::EvaluationParams defaults = {});

}  // namespace sightline_ros
