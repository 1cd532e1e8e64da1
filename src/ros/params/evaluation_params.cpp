#include "sightline/ros/params/evaluation_params.h"

namespace sightline_ros {

namespace core = sightline::core;

core::EvaluationParams loadEvaluationParams(const ParamReader& reader, core::EvaluationParams params) {
  params.settle_time = reader.number("settle_time", params.settle_time, atLeast(0.0), "s");
  params.truth_gap = reader.number("truth_gap", params.truth_gap, above(0.0), "s");
  params.truth_memory = reader.number("truth_memory", params.truth_memory, above(0.0), "s");
  params.match_gate = reader.number("match_gate", params.match_gate, atLeast(0.0), "rad");
  params.sighting_gate = reader.number("sighting_gate", params.sighting_gate, above(0.0), "sigma");
  params.sighting_gate_floor =
      reader.number("sighting_gate_floor", params.sighting_gate_floor, atLeast(0.0), "rad");
  const bool azimuth_only = reader.flag("azimuth_only", params.channels == core::Channels::azimuth_only);
  params.channels = azimuth_only ? core::Channels::azimuth_only : core::Channels::azimuth_and_elevation;

  const ParamReader gospa = reader.sub("gospa");
  params.gospa.cutoff = gospa.number("cutoff", params.gospa.cutoff, above(0.0), "rad");
  params.gospa.order = gospa.number("order", params.gospa.order, atLeast(1.0));

  if (params.truth_memory <= params.truth_gap) {
    throw reader.error("truth_memory",
                       "expected more than truth_gap [s], got less: truth that is forgotten so soon "
                       "cannot be interpolated");
  }
  return params;
}

}  // namespace sightline_ros
