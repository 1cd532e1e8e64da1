#include "sightline/ros/adapters/spot_detector_params.h"

#include <vector>

#include "sightline/core/model/sphere.h"

namespace sightline_ros {

namespace core = sightline::core;

namespace {

core::SpotDetectorParams loadDetector(const ParamReader& reader) {
  using Params = core::SpotDetectorParams;
  Params params;
  const std::string background = reader.choice("background", "spatial", {"spatial", "temporal"});
  params.background = background == "temporal" ? Params::Background::temporal : Params::Background::spatial;
  const std::string polarity = reader.choice("polarity", "bright", {"bright", "dark", "both"});
  params.polarity = polarity == "both"   ? Params::Polarity::both
                    : polarity == "dark" ? Params::Polarity::dark
                                         : Params::Polarity::bright;
  params.threshold = reader.number("threshold", params.threshold, above(0.0));
  params.min_contrast = reader.number("min_contrast", params.min_contrast, atLeast(0.0), "grey levels");
  params.guard = reader.integer("guard", params.guard, 1, 1000);
  params.neighbourhood = reader.integer("neighbourhood", params.neighbourhood, 2, 1000);
  if (params.neighbourhood <= params.guard) {
    throw reader.error("neighbourhood", "expected more than guard (" + std::to_string(params.guard) +
                                            "), got " + std::to_string(params.neighbourhood));
  }
  params.max_size = reader.integer("max_size", params.max_size, 1, 1000);
  params.max_spots = reader.integer("max_spots", params.max_spots, 1, 10000);
  params.memory = reader.integer("memory", params.memory, 2, 1000000);
  params.warm_up = reader.integer("warm_up", params.warm_up, 1, params.memory);
  params.centroid_floor = reader.number("centroid_floor", params.centroid_floor, atLeast(0.0), "px");
  return params;
}

Eigen::Vector2d loadFieldOfView(const ParamReader& reader) {
  const std::vector<double> angles =
      reader.numbers("field_of_view", {0.0, 0.0}, Range{0.0, core::kPi, false, true}, "rad");
  const bool is_none = angles.size() == 2 && angles[0] == 0.0 && angles[1] == 0.0;
  if (angles.size() != 2 || (!is_none && (angles[0] == 0.0 || angles[1] == 0.0))) {
    throw reader.error("field_of_view",
                       "expected two angles above 0 [rad], or [0.0, 0.0] for a camera with CameraInfo");
  }
  return {angles[0], angles[1]};
}

}  // namespace

SpotDetectorNodeParams loadSpotDetectorParams(const ParamReader& reader) {
  SpotDetectorNodeParams params;
  params.detector = loadDetector(reader);
  params.sensor = reader.text("sensor", params.sensor);
  params.frame = reader.text("frame", params.frame);
  params.transport = reader.text("transport", params.transport);
  params.rectified = reader.flag("rectified", params.rectified);
  params.stamp_offset = reader.number("stamp_offset", params.stamp_offset, between(-3600.0, 3600.0), "s");
  params.field_of_view = loadFieldOfView(reader);
  params.detection_probability =
      reader.number("detection_probability", params.detection_probability, Range{0.0, 1.0, true, false});
  params.clutter_density = reader.number("clutter_density", params.clutter_density, atLeast(0.0), "1/sr");
  return params;
}

}  // namespace sightline_ros
