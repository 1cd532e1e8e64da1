#include "sightline/ros/messages/frame_params.h"

#include <vector>

#include "sightline/core/model/sphere.h"

namespace sightline_ros {

namespace core = sightline::core;

namespace {

/// Half widths in azimuth and elevation [rad], by sensor.
std::map<std::string, Eigen::Vector2d> loadFieldsOfView(const ParamReader& reader) {
  std::map<std::string, Eigen::Vector2d> fields;
  for (const ParamReader& entry : reader.list("fields_of_view")) {
    const std::string sensor = entry.requiredText("sensor");
    const double azimuth =
        entry.requiredNumber("azimuth_half_width", Range{0.0, core::kPi, true, false}, "rad");
    const double elevation =
        entry.requiredNumber("elevation_half_width", Range{0.0, core::kPi / 2.0, true, false}, "rad");
    if (!fields.emplace(sensor, Eigen::Vector2d(azimuth, elevation)).second)
      throw entry.error("sensor", "the field of view of \"" + sensor + "\" is given twice");
  }
  return fields;
}

}  // namespace

FrameChangeParams loadFrameChangeParams(const ParamReader& reader, FrameChangeParams params) {
  params.tracking_frame = reader.text("tracking_frame", params.tracking_frame);
  params.tf_timeout = reader.number("tf_timeout", params.tf_timeout, atLeast(0.0), "s");
  params.max_future = reader.number("max_future", params.max_future, atLeast(0.0), "s");
  params.max_waiting = reader.integer("max_waiting", params.max_waiting, 1, 1000000);
  if (params.tracking_frame.empty() || params.tracking_frame.front() == '/') {
    throw reader.error("tracking_frame", "expected a frame name without leading slash, got the string \"" +
                                             params.tracking_frame + "\"");
  }
  return params;
}

core::AttitudeParams loadAttitudeParams(const ParamReader& reader, core::AttitudeParams params) {
  const Eigen::Vector3d& sigma = params.sigma;
  const std::vector<double> sigmas = reader.numbers("attitude_sigma", {sigma.x(), sigma.y(), sigma.z()},
                                                    between(0.0, core::kPi / 2.0), "rad");
  if (sigmas.size() != 3) {
    throw reader.error("attitude_sigma",
                       "expected three numbers [rad], of roll, pitch and yaw of the scans' frame, got " +
                           std::to_string(sigmas.size()));
  }
  params.sigma = {sigmas[0], sigmas[1], sigmas[2]};
  params.time_sigma = reader.number("attitude_time_sigma", params.time_sigma, atLeast(0.0), "s");
  return params;
}

FrameChangeParams loadTrackerFrameParams(const ParamReader& reader, FrameChangeParams params) {
  params = loadFrameChangeParams(reader, params);
  params.fields_of_view = loadFieldsOfView(reader);
  params.attitude = loadAttitudeParams(reader, params.attitude);
  return params;
}

}  // namespace sightline_ros
