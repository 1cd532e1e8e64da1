#include "sightline/ros/messages/framed_scan.h"

#include <cmath>
#include <limits>
#include <sstream>

#include "sightline/core/model/name.h"
#include "sightline/ros/messages/conversions.h"

namespace sightline_ros {

namespace core = sightline::core;

namespace {

bool isKnown(double value) {
  return !std::isnan(value);
}

core::Sighting unusableSighting() {
  core::Sighting sighting;
  sighting.covariance.setConstant(std::numeric_limits<double>::quiet_NaN());
  return sighting;
}

core::Sighting turned(const core::Sighting& sighting, const Turn& turn) {
  return core::rotate(
      turn.attitude_covariance ? core::withAttitude(sighting, *turn.attitude_covariance) : sighting,
      turn.R_tracking_sensor);
}

/// Fills the scan with the message's sightings, turned where it is not in the tracking frame already.
void addSightings(const std::optional<Turn>& turn, FramedScan& framed) {
  const auto& sightings = framed.message->sightings;
  framed.scan.sightings.reserve(sightings.size());
  for (std::size_t i = 0; i < sightings.size(); ++i) {
    const Eigen::Vector2d angles(sightings[i].azimuth, sightings[i].elevation);
    const Eigen::Matrix2d covariance =
        Eigen::Map<const Eigen::Matrix<double, 2, 2, Eigen::RowMajor>>(sightings[i].covariance.data());
    if (auto why = core::rejectionOf(angles, covariance)) {
      framed.rejections.emplace_back(static_cast<std::uint32_t>(i), std::move(why->detail));
      framed.scan.sightings.push_back(unusableSighting());
      continue;
    }
    const core::Sighting sighting = core::sightingOf(angles, covariance, sightings[i].snr);
    framed.scan.sightings.push_back(turn ? turned(sighting, *turn) : sighting);
  }
}

}  // namespace

std::optional<core::Refusal> refusalOf(const sightline::SightingArray& message) {
  std::ostringstream detail;
  if (message.header.stamp.isZero()) {
    return core::Refusal{"no stamp", "header.stamp is 0: set it to the middle of the exposure"};
  }
  if (message.sensor.empty()) {
    return core::Refusal{"no sensor name", "sensor is empty: give every sensor a unique name"};
  }
  if (auto refusal = core::whyTooLong("the sensor's name", message.sensor)) return refusal;
  if (auto refusal = core::whyTooLong("header.frame_id", message.header.frame_id)) return refusal;
  if (message.header.frame_id.empty()) {
    return core::Refusal{"bad frame", "header.frame_id is empty: set it to the sensor's frame"};
  }
  if (message.header.frame_id.front() == '/') {
    return core::Refusal{"bad frame", "header.frame_id \"" + message.header.frame_id +
                                          "\" starts with a slash: tf2 frames have none"};
  }
  if (isKnown(message.ifov) && !(message.ifov > 0.0 && std::isfinite(message.ifov))) {
    detail << "ifov is " << message.ifov << " rad: state an angle above 0, or NaN for not known";
    return core::Refusal{"bad ifov", detail.str()};
  }
  if (isKnown(message.detection_probability) &&
      !(message.detection_probability > 0.0 && message.detection_probability <= 1.0)) {
    detail << "detection_probability is " << message.detection_probability
           << ": state one in (0, 1], or NaN for not known";
    return core::Refusal{"bad detection probability", detail.str()};
  }
  if (isKnown(message.clutter_density) &&
      !(message.clutter_density >= 0.0 && std::isfinite(message.clutter_density))) {
    detail << "clutter_density is " << message.clutter_density
           << " per sr: state one of at least 0, or NaN for not known";
    return core::Refusal{"bad clutter density", detail.str()};
  }
  return std::nullopt;
}

FramedScan framedScan(const sightline::SightingArray::ConstPtr& message, const std::optional<Turn>& turn,
                      const std::optional<core::FieldOfView>& view) {
  FramedScan framed;
  framed.message = message;
  framed.scan.time = toCore(message->header.stamp);
  framed.scan.sensor = message->sensor;
  framed.scan.ifov = message->ifov;
  framed.scan.detection_probability = message->detection_probability;
  framed.scan.clutter_density = message->clutter_density;
  framed.scan.view = view;
  addSightings(turn, framed);
  if (!framed.rejections.empty() && framed.rejections.size() == framed.scan.sightings.size()) {
    framed.refusal =
        core::Refusal{"no usable sighting", "all its sightings are rejected, the first because its " +
                                                framed.rejections.front().second};
  }
  return framed;
}

FramedScan refusedScan(const sightline::SightingArray::ConstPtr& message, core::Refusal refusal) {
  FramedScan framed;
  framed.message = message;
  framed.scan.time = toCore(message->header.stamp);
  framed.scan.sensor = message->sensor;
  framed.refusal = std::move(refusal);
  return framed;
}

}  // namespace sightline_ros
