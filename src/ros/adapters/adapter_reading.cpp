#include "sightline/ros/adapters/adapter_reading.h"

#include <boost/make_shared.hpp>
#include <sstream>

#include <Eigen/LU>

#include "sightline/core/model/line_of_sight.h"
#include "sightline/core/model/sphere.h"
#include "sightline/ros/messages/conversions.h"

namespace sightline_ros {

namespace core = sightline::core;

namespace {

template <typename Derived>
std::string textOf(const Eigen::MatrixBase<Derived>& vector) {
  std::ostringstream text;
  text << '(';
  for (Eigen::Index i = 0; i < vector.size(); ++i) text << (i > 0 ? ", " : "") << vector(i);
  text << ')';
  return text.str();
}

template <typename Matrix>
std::string variancesText(const Matrix& covariance, const std::string& unit) {
  return "variances " + textOf(covariance.diagonal()) + " " + unit;
}

/// A covariance can be used when it is finite, symmetric and positive definite.
bool isKnown(const Eigen::Matrix2d& covariance) {
  return covariance.allFinite() && covariance(0, 0) > 0.0 && covariance.determinant() > 0.0;
}

std::string withoutSlash(const std::string& frame) {
  return !frame.empty() && frame.front() == '/' ? frame.substr(1) : frame;
}

AdaptedScan refused(AdaptedScan out, const std::string& kind, const std::string& detail) {
  out.refusals.push_back({kind, detail});
  return out;
}

}  // namespace

void Reading::refuse(const std::string& kind, const std::string& detail) {
  refusals.push_back({kind, "topic " + topic_.topic + ": " + detail});
}

void Reading::add(std::optional<core::Sighting> sighting, double snr) {
  sighting->snr = snr;
  sightings.push_back(*sighting);
}

bool Reading::mayUseSigma(const std::optional<Eigen::Vector2d>& sigma, const std::string& covariance_text) {
  const bool in_pixels = !topic_.camera_info.empty();
  if (!sigma) {
    refuse("covariance not known", "the message's covariance says nothing (" + covariance_text +
                                       "); let the driver state it, or set " +
                                       (in_pixels ? "sigma_px [px]" : "sigma [rad]") + " for this topic");
    return false;
  }
  if (unknown_covariances++ == 0) first_unknown = covariance_text;
  return true;
}

void Reading::addDirection(const Eigen::Vector3d& direction, double snr) {
  addPoint(direction, std::nullopt, snr);
}

void Reading::addPoint(const Eigen::Vector3d& point, const std::optional<Eigen::Matrix3d>& covariance,
                       double snr) {
  if (!core::hasDirection(point)) {
    refuse("no direction", textOf(point) + " points nowhere: a finite vector that is not zero is expected");
    return;
  }
  if (covariance) {
    if (const auto sighting = core::sightingOfPoint(point, *covariance)) return add(sighting, snr);
    if (!mayUseSigma(topic_.sigma, variancesText(*covariance, "m^2"))) return;
  }
  add(core::sightingAlong(point, *topic_.sigma), snr);
}

void Reading::addAngles(const Eigen::Vector2d& angles, const std::optional<Eigen::Matrix2d>& covariance,
                        double snr) {
  const Eigen::Matrix2d any = Eigen::Matrix2d::Identity() * 1e-6;
  if (const auto why = core::rejectionOf(angles, any)) {
    refuse("angle out of range", why->detail + " (then set unit: deg for this field)");
    return;
  }
  if (covariance) {
    if (isKnown(*covariance)) return add(core::sightingOf(angles, *covariance), snr);
    if (!mayUseSigma(topic_.sigma, variancesText(*covariance, "rad^2"))) return;
  }
  add(core::sightingAlong(core::directionOf(angles), *topic_.sigma), snr);
}

void Reading::addPixel(const Eigen::Vector2d& pixel, const std::optional<Eigen::Matrix2d>& covariance,
                       const PixelRays* rays, double snr) {
  if (rays == nullptr) {
    refuse("no calibration", "no usable CameraInfo has come on " + topic_.camera_info +
                                 " yet: without it a pixel has no direction");
    return;
  }
  if (!pixel.allFinite() || !rays->isOnImage(pixel)) {
    std::ostringstream why;
    why << "pixel " << textOf(pixel) << " is not on the image of " << rays->width() << "x" << rays->height()
        << " that " << topic_.camera_info << " describes: is it that camera's?";
    refuse("off the image", why.str());
    return;
  }
  Eigen::Matrix2d used = covariance.value_or(Eigen::Matrix2d::Zero());
  if (!isKnown(used)) {
    if (covariance && !mayUseSigma(topic_.sigma_px, variancesText(*covariance, "px^2"))) return;
    used = topic_.sigma_px->cwiseAbs2().asDiagonal();
  }
  if (const auto sighting = rays->sightingAt(pixel, used)) return add(sighting, snr);
  refuse("no ray", "the camera's distortion model brings no ray to pixel " + textOf(pixel) +
                       ": it holds for the part of the image in which the calibration target was shown");
}

std::string boresightFrameOf(const std::string& optical_frame) {
  return optical_frame + "_boresight";
}

AdaptedScan adapt(const Reading& reading, const AdapterTopic& topic, const ros::Time& arrival) {
  AdaptedScan out;
  out.refusals = reading.refusals;
  const std::string of_topic = "topic " + topic.topic + ": ";
  const std::size_t offered = reading.offered();
  if (offered > static_cast<std::size_t>(topic.max_sightings)) {
    return refused(std::move(out), "too many sightings",
                   of_topic + std::to_string(offered) + " in one message, more than max_sightings " +
                       std::to_string(topic.max_sightings) +
                       ": these are not detections (a lidar's cloud must be clustered first)");
  }
  const std::string frame = withoutSlash(topic.frame.empty() ? reading.header.frame_id : topic.frame);
  if (frame.empty()) {
    return refused(
        std::move(out), "no frame",
        of_topic + "header.frame_id is empty: let the driver fill it in, or set frame for this topic");
  }
  if (!topic.stamp_on_arrival && reading.header.stamp.isZero()) {
    return refused(
        std::move(out), "no stamp",
        of_topic + "header.stamp is 0: let the driver fill it in, or set stamp: arrival for this topic");
  }
  core::Scan scan;
  scan.time =
      toCore(topic.stamp_on_arrival ? arrival : reading.header.stamp) + core::durationOf(topic.stamp_offset);
  scan.sensor = topic.sensor;
  scan.ifov = topic.ifov;
  scan.detection_probability = topic.detection_probability;
  scan.clutter_density = topic.clutter_density;
  for (const core::Sighting& sighting : reading.sightings) {
    const core::Sighting seen =
        topic.is_optical ? core::rotate(sighting, core::R_boresight_optical()) : sighting;
    if (const auto why = core::rejectionOf(core::anglesOf(seen.direction), core::anglesCovariance(seen))) {
      out.refusals.push_back({"sighting unusable", of_topic + why->detail});
    } else {
      scan.sightings.push_back(seen);
    }
  }
  if (offered > 0 && scan.sightings.empty()) return out;
  if (scan.time < core::Time{}) {
    return refused(std::move(out), "no stamp", of_topic + "stamp_offset brings the stamp before 1970");
  }
  out.scan = boost::make_shared<sightline::SightingArray>(
      toMessage(scan, topic.is_optical ? boresightFrameOf(frame) : frame));
  if (topic.is_optical) out.optical_frame = frame;
  return out;
}

}  // namespace sightline_ros
