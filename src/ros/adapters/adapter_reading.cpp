#include "sightline/ros/adapters/adapter_reading.h"

#include <algorithm>
#include <boost/make_shared.hpp>
#include <cmath>
#include <limits>
#include <sstream>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "sightline/core/model/angle_range.h"
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

constexpr double kLargestSigma =
    core::kPi / 2.0;                        // [rad]: beyond, a sigma says nothing, as the trackers see it
constexpr double kLargestPixelSigma = 1e4;  // [px], as the configuration's
constexpr double kNearPole = 1e-9;          // of the cosine of an elevation (S-12)

/// A covariance can be used when it is finite, symmetric and positive definite.
bool isKnown(const Eigen::Matrix2d& covariance) {
  return covariance.allFinite() && covariance(0, 0) > 0.0 && covariance.determinant() > 0.0;
}

/// Which axes a covariance says nothing of: not finite, zero, negative, a number that stands for it, or a
/// variance above the largest of each.
template <int kAxes>
Eigen::Array<int, kAxes, 1> unknownAxes(const Eigen::Matrix<double, kAxes, kAxes>& covariance,
                                        const Eigen::Matrix<double, kAxes, 1>& largest) {
  Eigen::Array<int, kAxes, 1> unknown;
  for (int i = 0; i < kAxes; ++i) {
    const double variance = covariance(i, i);
    unknown(i) = !(variance > 0.0) || !(variance <= largest(i)) || standsForUnknown(variance);
  }
  return unknown;
}

/// A covariance in which some axes are replaced by variances of their own.
template <int kAxes>
Eigen::Matrix<double, kAxes, kAxes> withAxes(Eigen::Matrix<double, kAxes, kAxes> covariance,
                                             const Eigen::Array<int, kAxes, 1>& axes,
                                             const Eigen::Matrix<double, kAxes, 1>& variances) {
  for (int i = 0; i < kAxes; ++i) {
    if (axes(i) == 0) continue;
    covariance.row(i).setZero();
    covariance.col(i).setZero();
    covariance(i, i) = variances(i);
  }
  return covariance;
}

/// Whether a sighting's sigma is small enough in all directions to say something.
bool saysSomething(const core::Sighting& sighting) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(sighting.covariance, Eigen::EigenvaluesOnly);
  return solver.eigenvalues()(2) <= kLargestSigma * kLargestSigma;
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

/// The configured sigma is one of arcs along azimuth and elevation: of an optical frame, of its boresight
/// frame.
std::optional<core::Sighting> Reading::sightingWithSigma(const Eigen::Vector3d& direction) const {
  if (!topic_.is_optical) return core::sightingAlong(direction, *topic_.sigma);
  const Eigen::Matrix3d R = core::R_boresight_optical();
  const auto sighting = core::sightingAlong(R * direction, *topic_.sigma);
  if (!sighting) return std::nullopt;
  return core::rotate(*sighting, R.transpose());
}

/// Lengths across the line of sight at a distance for the configured arcs: upright axes have that of the
/// elevation.
Eigen::Matrix3d Reading::withSigmaOnAxes(const Eigen::Matrix3d& covariance, const Eigen::Array3i& axes,
                                         double range) const {
  const Eigen::Vector2d lengths = range * *topic_.sigma;
  const Eigen::Vector3d of_axes = topic_.is_optical ? Eigen::Vector3d(lengths.x(), lengths.y(), lengths.x())
                                                    : Eigen::Vector3d(lengths.x(), lengths.x(), lengths.y());
  return withAxes<3>(covariance, axes, of_axes.cwiseAbs2());
}

void Reading::addPoint(const Eigen::Vector3d& point, const std::optional<Eigen::Matrix3d>& covariance,
                       double snr) {
  if (topic_.zero_is_nothing && point.isZero(0.0)) {
    ++unused_slots;
    return;
  }
  if (!core::hasDirection(point)) {
    refuse("no direction", textOf(point) + " points nowhere: a finite vector that is not zero is expected");
    return;
  }
  if (covariance) {
    const double range = point.stableNorm();
    const Eigen::Vector3d any = Eigen::Vector3d::Constant(std::numeric_limits<double>::max());
    const Eigen::Array3i unknown = unknownAxes<3>(*covariance, any);
    // Along the line of sight an axis may be anything; but one that is marked as unknown reaches across it.
    const Eigen::Array3i zero = (covariance->diagonal().array() == 0.0).cast<int>();
    const Eigen::Array3i marked = unknown * (1 - zero);
    if (topic_.sigma && marked.any() && !unknown.all()) {
      mayUseSigma(topic_.sigma, variancesText(*covariance, "m^2"));
      if (const auto sighting = core::sightingOfPoint(point, withSigmaOnAxes(*covariance, unknown, range))) {
        return add(sighting, snr);
      }
    } else {
      const auto sighting = core::sightingOfPoint(point, *covariance);
      if (sighting && (!marked.any() || saysSomething(*sighting))) return add(sighting, snr);
      if (!mayUseSigma(topic_.sigma, variancesText(*covariance, "m^2"))) return;
      if (unknown.any() && !unknown.all()) {
        const auto mended = core::sightingOfPoint(point, withSigmaOnAxes(*covariance, unknown, range));
        if (mended) return add(mended, snr);
      }
    }
  }
  add(sightingWithSigma(point), snr);
}

std::optional<Eigen::Vector2d> Reading::sigmaOfAngles(double elevation) const {
  if (!topic_.sigma) return std::nullopt;
  const double cosine = std::max(std::cos(core::withinPoles(elevation)), kNearPole);
  return Eigen::Vector2d(topic_.sigma->x() / cosine, topic_.sigma->y());
}

void Reading::addAngles(const Eigen::Vector2d& angles, const std::optional<Eigen::Matrix2d>& covariance,
                        double snr) {
  const Eigen::Matrix2d any = Eigen::Matrix2d::Identity() * 1e-6;
  if (const auto why = core::rejectionOf(angles, any)) {
    refuse("angle out of range", why->detail + " (then set unit: deg for this field)");
    return;
  }
  const Eigen::Vector2d on_sphere(angles.x(), core::withinPoles(angles.y()));
  if (covariance) {
    // Of an azimuth its arc says how much it says, which is short near a pole.
    const double cosine = std::max(std::cos(on_sphere.y()), kNearPole);
    const Eigen::Vector2d largest(kLargestSigma / cosine, kLargestSigma);
    const Eigen::Array2i unknown = unknownAxes<2>(*covariance, largest.cwiseAbs2());
    if (!unknown.any() && isKnown(*covariance)) return add(core::sightingOf(angles, *covariance), snr);
    if (!mayUseSigma(topic_.sigma, variancesText(*covariance, "rad^2"))) return;
    if (unknown.any() && !unknown.all()) {
      const Eigen::Vector2d sigma = *sigmaOfAngles(on_sphere.y());
      return add(core::sightingOf(angles, withAxes<2>(*covariance, unknown, sigma.cwiseAbs2())), snr);
    }
  }
  add(core::sightingAlong(core::directionOf(on_sphere), *topic_.sigma), snr);
}

void Reading::addBox(const Eigen::Vector2d& first, const Eigen::Vector2d& last, const PixelRays* rays,
                     double snr) {
  if (topic_.zero_is_nothing && first.isZero(0.0) && last.isZero(0.0)) {
    ++unused_slots;
  } else if (!(last.x() >= first.x() && last.y() >= first.y())) {
    refuse("malformed", "a box from " + textOf(first) + " to " + textOf(last) +
                            " px: its last corner is before its first one; are the fields of xmin, xmax, "
                            "ymin and ymax the right ones?");
  } else {
    addPixel(0.5 * (first + last), std::nullopt, rays, snr);
  }
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
  const Eigen::Vector2d largest = Eigen::Vector2d::Constant(kLargestPixelSigma * kLargestPixelSigma);
  Eigen::Array2i unknown = unknownAxes<2>(used, largest);
  if (unknown.any() || !isKnown(used)) {
    if (covariance && !mayUseSigma(topic_.sigma_px, variancesText(*covariance, "px^2"))) return;
    if (!unknown.any()) unknown.setOnes();
    used = withAxes<2>(used, unknown, topic_.sigma_px->cwiseAbs2());
  }
  if (const auto sighting = rays->sightingAt(pixel, used)) return add(sighting, snr);
  refuse("no ray", rays->whyNoRay(pixel).value_or("the covariance of pixel " + textOf(pixel) +
                                                  " is not positive definite"));
}

bool standsForUnknown(double stated) {
  if (!(stated >= 99999.0)) return false;
  if (stated > 1e30) return true;
  const double power = std::pow(10.0, std::round(std::log10(stated)));
  return std::abs(stated - power) < 1e-6 || std::abs(stated - (power - 1.0)) < 1e-6;
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
  if (offered > 0 && reading.sightings.empty()) return out;
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
  scan.time = (topic.stamp_on_arrival ? toCore(arrival) : toCore(reading.header.stamp) + reading.middle) +
              core::durationOf(topic.stamp_offset);
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
  if (scan.time > toCore(ros::TIME_MAX))
    return refused(std::move(out), "no stamp", of_topic + "the stamp is beyond 2106: is it in seconds?");
  out.scan = boost::make_shared<sightline::SightingArray>(
      toMessage(scan, topic.is_optical ? boresightFrameOf(frame) : frame));
  if (topic.is_optical) out.optical_frame = frame;
  return out;
}

}  // namespace sightline_ros
