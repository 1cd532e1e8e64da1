#include "sightline/ros/adapters/pixel_rays.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include <Eigen/LU>

#include <sensor_msgs/distortion_models.h>

#include "sightline/core/model/line_of_sight.h"
#include "sightline/core/model/sphere.h"

namespace sightline_ros {

namespace core = sightline::core;

namespace {

constexpr double kRotationTolerance = 1e-2;  // of R times its transpose: calibrations are written rounded
constexpr int kGrid = 48;                    // pixels a side that are tried for rays

unsigned reduced(unsigned full, unsigned of_region, unsigned binning) {
  return (of_region > 0 ? of_region : full) / std::max(binning, 1u);
}

bool isZero(double value) {
  return value == 0.0;
}

template <typename Numbers>
bool isFinite(const Numbers& numbers) {
  return std::all_of(numbers.begin(), numbers.end(), [](double value) { return std::isfinite(value); });
}

bool isEquidistant(const sensor_msgs::CameraInfo& camera) {
  return camera.distortion_model == sensor_msgs::distortion_models::EQUIDISTANT;
}

bool hasProjection(const sensor_msgs::CameraInfo& camera) {
  return !isZero(camera.P[0]);
}

/// A camera that is alone may leave R out.
Eigen::Matrix3d rotationOf(const sensor_msgs::CameraInfo& camera) {
  if (std::all_of(camera.R.begin(), camera.R.end(), isZero)) return Eigen::Matrix3d::Identity();
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(camera.R.data());
}

/// Focal lengths, skew and principal point of the image at hand: those of P for a rectified one (of K, where
/// P is left out), else those of K.
struct Intrinsics {
  double fx, skew, cx, fy, cy;
};

Intrinsics intrinsicsOf(const sensor_msgs::CameraInfo& camera, bool rectified) {
  const auto& K = camera.K;
  const auto& P = camera.P;
  if (rectified && hasProjection(camera)) return {P[0], P[1], P[2], P[5], P[6]};
  return {K[0], K[1], K[2], K[4], K[5]};
}

core::Lens lensOf(const sensor_msgs::CameraInfo& camera, bool rectified) {
  if (rectified) return core::Lens::perspective({});
  return isEquidistant(camera) ? core::Lens::equidistant(camera.D) : core::Lens::perspective(camera.D);
}

std::optional<std::string> faultOfFocalLengths(const sensor_msgs::CameraInfo& camera, bool rectified) {
  std::ostringstream why;
  const bool by_projection = rectified && hasProjection(camera);
  if (!by_projection && camera.K[0] == 0.0) {
    why << "the camera is not calibrated (K[0] = 0 in its CameraInfo): calibrate it with camera_calibration";
    if (hasProjection(camera)) {
      why << ", or set rectified: true where the pixels are of the rectified image, which its P describes";
    }
    return why.str();
  }
  const Intrinsics intrinsics = intrinsicsOf(camera, rectified);
  const bool is_finite = by_projection ? isFinite(camera.P) : isFinite(camera.K);
  const double last = by_projection ? camera.P[10] : camera.K[8];
  if (is_finite && intrinsics.fx > 0.0 && intrinsics.fy > 0.0 && last > 0.0) return std::nullopt;
  const std::array<const char*, 3> names = by_projection ? std::array<const char*, 3>{"P[0]", "P[5]", "P[10]"}
                                                         : std::array<const char*, 3>{"K[0]", "K[4]", "K[8]"};
  why << "the camera's calibration makes no sense (focal lengths " << names[0] << " = " << intrinsics.fx
      << ", " << names[1] << " = " << intrinsics.fy << " px, " << names[2] << " = " << last
      << "): positive focal lengths and " << names[2] << " = 1 are expected";
  return why.str();
}

std::optional<std::string> faultOfDistortion(const sensor_msgs::CameraInfo& camera) {
  using namespace sensor_msgs::distortion_models;
  std::ostringstream why;
  const std::string& model = camera.distortion_model;
  if (!model.empty() && model != PLUMB_BOB && model != RATIONAL_POLYNOMIAL && model != EQUIDISTANT) {
    why << "the distortion model \"" << model
        << "\" is not known here: plumb_bob, rational_polynomial or equidistant is expected";
    return why.str();
  }
  const std::size_t most = isEquidistant(camera) ? 4 : 14;
  const bool is_long =
      camera.D.size() > most &&
      !std::all_of(camera.D.begin() + static_cast<std::ptrdiff_t>(most), camera.D.end(), isZero);
  const bool is_short = camera.D.size() < 4 && !std::all_of(camera.D.begin(), camera.D.end(), isZero);
  if (is_long || is_short) {
    why << "the distortion model \"" << model << "\" has " << camera.D.size()
        << " coefficients D: none or 4 are expected of equidistant, none, 4, 5, 8, 12 or 14 of the others";
    return why.str();
  }
  if (!isFinite(camera.D)) return "a distortion coefficient D is not finite: calibrate the camera again";
  return std::nullopt;
}

std::optional<std::string> faultOfRotation(const sensor_msgs::CameraInfo& camera) {
  const Eigen::Matrix3d R = rotationOf(camera);
  const Eigen::Matrix3d product = R * R.transpose();
  if (R.allFinite() && product.isApprox(Eigen::Matrix3d::Identity(), kRotationTolerance) &&
      R.determinant() > 0.0) {
    return std::nullopt;
  }
  std::ostringstream why;
  why << "the camera's R is no rotation (determinant " << R.determinant()
      << "): a camera that is not one of a stereo pair has the identity there";
  return why.str();
}

}  // namespace

std::optional<core::Refusal> refusalOf(const sensor_msgs::CameraInfo& camera, bool rectified) {
  const std::string kind = "camera not calibrated";
  if (const auto why = faultOfFocalLengths(camera, rectified)) return core::Refusal{kind, *why};
  if (camera.width == 0 || camera.height == 0) {
    std::ostringstream why;
    why << "the camera's CameraInfo states an image of " << camera.width << "x" << camera.height
        << " pixels: its driver must fill width and height in";
    return core::Refusal{kind, why.str()};
  }
  if (rectified) return std::nullopt;
  if (const auto why = faultOfDistortion(camera)) return core::Refusal{kind, *why};
  if (const auto why = faultOfRotation(camera)) return core::Refusal{kind, *why};
  return std::nullopt;
}

bool isSameCalibration(const sensor_msgs::CameraInfo& a, const sensor_msgs::CameraInfo& b) {
  return a.header.frame_id == b.header.frame_id && a.width == b.width && a.height == b.height &&
         a.distortion_model == b.distortion_model && a.D == b.D && a.K == b.K && a.R == b.R && a.P == b.P &&
         a.binning_x == b.binning_x && a.binning_y == b.binning_y && a.roi.x_offset == b.roi.x_offset &&
         a.roi.y_offset == b.roi.y_offset && a.roi.width == b.roi.width && a.roi.height == b.roi.height;
}

sensor_msgs::CameraInfo pinholeCamera(unsigned width, unsigned height, const Eigen::Vector2d& field_of_view) {
  sensor_msgs::CameraInfo camera;
  camera.width = width;
  camera.height = height;
  camera.distortion_model = sensor_msgs::distortion_models::PLUMB_BOB;
  camera.D.assign(5, 0.0);
  const double fx = 0.5 * width / std::tan(0.5 * field_of_view.x());
  const double fy = 0.5 * height / std::tan(0.5 * field_of_view.y());
  const double cx = 0.5 * (width - 1.0), cy = 0.5 * (height - 1.0);
  camera.K = {fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0};
  camera.R = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
  camera.P = {fx, 0.0, cx, 0.0, 0.0, fy, cy, 0.0, 0.0, 0.0, 1.0, 0.0};
  return camera;
}

PixelRays::PixelRays(const sensor_msgs::CameraInfo& camera, bool rectified)
    : camera_(camera),
      width_(reduced(camera.width, camera.roi.width, camera.binning_x)),
      height_(reduced(camera.height, camera.roi.height, camera.binning_y)),
      lens_(core::Lens::perspective({})) {
  if (const auto refusal = refusalOf(camera, rectified)) throw std::invalid_argument(refusal->detail);
  lens_ = lensOf(camera, rectified);
  R_optical_camera_ = rectified ? Eigen::Matrix3d::Identity() : rotationOf(camera);
  // (S-104): K and P are those of the whole image without binning. A pixel that joins n x n lies between
  // them.
  const Intrinsics of_all = intrinsicsOf(camera, rectified);
  const Eigen::Vector2d binning(std::max(camera.binning_x, 1u), std::max(camera.binning_y, 1u));
  const Eigen::Vector2d region(camera.roi.x_offset, camera.roi.y_offset);
  const Eigen::Vector2d centre(of_all.cx, of_all.cy);
  principal_point_ = (centre - region - 0.5 * (binning - Eigen::Vector2d::Ones())).cwiseQuotient(binning);
  Eigen::Matrix2d focal_lengths;
  focal_lengths << of_all.fx, of_all.skew, 0.0, of_all.fy;
  image_by_pixel_ = focal_lengths.inverse() * binning.asDiagonal();
  share_without_ray_ = countWithoutRay();
}

/// At a focal length of 1, with the axis at (0, 0).
Eigen::Vector2d PixelRays::imageOf(const Eigen::Vector2d& pixel) const {
  return image_by_pixel_ * (pixel - principal_point_);
}

std::optional<core::Sighting> PixelRays::sightingAt(const Eigen::Vector2d& pixel,
                                                    const Eigen::Matrix2d& covariance) const {
  const auto ray = lens_.rayAt(imageOf(pixel));
  if (!ray) return std::nullopt;
  const Eigen::Matrix<double, 3, 2> J = R_optical_camera_ * ray->jacobian * image_by_pixel_;
  return core::sightingOfPoint(R_optical_camera_ * ray->direction, J * covariance * J.transpose());
}

std::optional<std::string> PixelRays::whyNoRay(const Eigen::Vector2d& pixel) const {
  if (lens_.rayAt(imageOf(pixel))) return std::nullopt;
  std::ostringstream why;
  why << "no ray of the camera's distortion model falls on pixel (" << pixel.x() << ", " << pixel.y()
      << "): it is " << imageOf(pixel).norm() << " focal lengths from the centre, and the model ends at "
      << lens_.edgeRadius() << " (" << lens_.edgeAngle() / core::kDegree
      << " deg off the axis), where it bends back. Calibrate with the target in the corners, or leave such "
         "pixels out";
  return why.str();
}

std::string PixelRays::warning() const {
  if (share_without_ray_ == 0.0) return "";
  std::ostringstream text;
  text << "no ray falls on about " << 100.0 * share_without_ray_
       << " % of the pixels: the camera's distortion model ends at " << lens_.edgeRadius()
       << " focal lengths from the centre of the image (" << lens_.edgeAngle() / core::kDegree
       << " deg off the axis), where it bends back. Detections beyond are refused; calibrate with the target "
          "in the corners";
  return text.str();
}

double PixelRays::countWithoutRay() const {
  const auto has_ray = [this](double across, double down) {  // as shares of the image
    const Eigen::Vector2d pixel(across * (width_ - 1.0), down * (height_ - 1.0));
    return lens_.rayAt(imageOf(pixel)).has_value();
  };
  // The lens ends round its centre: where all of the border has rays, all of the image has.
  bool all_of_border = true;
  for (int i = 0; i <= kGrid && all_of_border; ++i) {
    const double share = static_cast<double>(i) / kGrid;
    all_of_border = has_ray(share, 0.0) && has_ray(share, 1.0) && has_ray(0.0, share) && has_ray(1.0, share);
  }
  if (all_of_border) return 0.0;
  int without = 0;
  for (int i = 0; i < kGrid; ++i)
    for (int j = 0; j < kGrid; ++j) without += has_ray((i + 0.5) / kGrid, (j + 0.5) / kGrid) ? 0 : 1;
  return std::max(without, 1) / static_cast<double>(kGrid * kGrid);
}

bool PixelRays::isOnImage(const Eigen::Vector2d& pixel) const {
  return pixel.x() >= -0.5 && pixel.y() >= -0.5 && pixel.x() <= width_ - 0.5 && pixel.y() <= height_ - 0.5;
}

double PixelRays::ifov() const {
  return std::sqrt(image_by_pixel_.determinant());
}

}  // namespace sightline_ros
