#include "sightline/ros/adapters/pixel_rays.h"

#include <algorithm>
#include <cmath>
#include <image_geometry/pinhole_camera_model.h>
#include <set>
#include <sstream>
#include <stdexcept>

#include <Eigen/LU>

#include <sensor_msgs/distortion_models.h>

#include "sightline/core/model/line_of_sight.h"

namespace sightline_ros {

namespace core = sightline::core;

namespace {

constexpr double kJacobianStep = 0.05;     // [px]: central differences of a smooth function
constexpr int kNewtonSteps = 20;           // image_geometry's own inversion is left at 5 fixed-point steps
constexpr double kRaysAgree = 1e-6;        // [px]
constexpr double kSmallestStretch = 1e-3;  // |det| of d raw / d rectified: below, the image folds over

unsigned reduced(unsigned full, unsigned of_region, unsigned binning) {
  return (of_region > 0 ? of_region : full) / std::max(binning, 1u);
}

}  // namespace

std::optional<core::Refusal> refusalOf(const sensor_msgs::CameraInfo& camera) {
  const std::string kind = "camera not calibrated";
  std::ostringstream why;
  if (camera.K[0] == 0.0) {
    why << "the camera is not calibrated (K[0] = 0 in its CameraInfo): calibrate it with camera_calibration";
    return core::Refusal{kind, why.str()};
  }
  const bool is_finite =
      std::all_of(camera.K.begin(), camera.K.end(), [](double k) { return std::isfinite(k); });
  if (!is_finite || !(camera.K[0] > 0.0) || !(camera.K[4] > 0.0) || !(camera.K[8] > 0.0)) {
    why << "the camera's calibration makes no sense (focal lengths K[0] = " << camera.K[0]
        << ", K[4] = " << camera.K[4] << " px, K[8] = " << camera.K[8]
        << "): positive focal lengths and K[8] = 1 are expected";
    return core::Refusal{kind, why.str()};
  }
  if (camera.width == 0 || camera.height == 0) {
    why << "the camera's CameraInfo states an image of " << camera.width << "x" << camera.height
        << " pixels: its driver must fill width and height in";
    return core::Refusal{kind, why.str()};
  }
  const std::set<std::string> known = {"", sensor_msgs::distortion_models::PLUMB_BOB,
                                       sensor_msgs::distortion_models::RATIONAL_POLYNOMIAL,
                                       sensor_msgs::distortion_models::EQUIDISTANT};
  if (known.count(camera.distortion_model) == 0) {
    why << "the distortion model \"" << camera.distortion_model
        << "\" is not known here: plumb_bob, rational_polynomial or equidistant is expected";
    return core::Refusal{kind, why.str()};
  }
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
      rectified_(rectified),
      width_(reduced(camera.width, camera.roi.width, camera.binning_x)),
      height_(reduced(camera.height, camera.roi.height, camera.binning_y)) {
  if (const auto refusal = refusalOf(camera)) throw std::invalid_argument(refusal->detail);
  // A camera that is alone may leave R and P out: its rectified image is then that of K.
  if (camera_.P[0] == 0.0) {
    const auto& K = camera_.K;
    camera_.P = {K[0], K[1], K[2], 0.0, K[3], K[4], K[5], 0.0, K[6], K[7], K[8], 0.0};
  }
  if (std::all_of(camera_.R.begin(), camera_.R.end(), [](double r) { return r == 0.0; })) {
    camera_.R = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
  }
  if (camera_.distortion_model.empty()) camera_.distortion_model = sensor_msgs::distortion_models::PLUMB_BOB;
  const auto model = std::make_shared<image_geometry::PinholeCameraModel>();
  model->fromCameraInfo(camera_);
  model_ = model;
}

std::optional<core::Sighting> PixelRays::sightingAt(const Eigen::Vector2d& pixel,
                                                    const Eigen::Matrix2d& covariance) const {
  if (!pixel.allFinite()) return std::nullopt;
  const auto rectified = rectify(pixel);
  if (!rectified) return std::nullopt;
  const Eigen::Matrix2d rectified_by_raw =
      rectified->raw_by_rectified.inverse();  // rectify() saw to its size

  const cv::Point3d ray = model_->projectPixelTo3dRay({rectified->pixel.x(), rectified->pixel.y()});
  Eigen::Matrix<double, 3, 2> J =
      Eigen::Matrix<double, 3, 2>::Zero();  // d ray / d rectified pixel; ray.z is 1
  J(0, 0) = 1.0 / model_->fx();
  J(1, 1) = 1.0 / model_->fy();
  J *= rectified_by_raw;

  return core::sightingOfPoint({ray.x, ray.y, ray.z}, J * covariance * J.transpose());
}

bool PixelRays::isOnImage(const Eigen::Vector2d& pixel) const {
  return pixel.x() >= -0.5 && pixel.y() >= -0.5 && pixel.x() <= width_ - 0.5 && pixel.y() <= height_ - 0.5;
}

double PixelRays::ifov() const {
  return 1.0 / std::sqrt(model_->fx() * model_->fy());
}

std::optional<PixelRays::Rectified> PixelRays::rectify(const Eigen::Vector2d& raw) const {
  if (rectified_) return Rectified{raw, Eigen::Matrix2d::Identity()};
  const cv::Point2d start = model_->rectifyPoint({raw.x(), raw.y()});
  Rectified found{{start.x, start.y}, Eigen::Matrix2d::Identity()};
  for (int step = 0; step < kNewtonSteps && found.pixel.allFinite(); ++step) {
    const Eigen::Vector2d miss = raw - distort(found.pixel);
    found.raw_by_rectified = distortionJacobian(found.pixel);
    // The scale between raw and rectified image is free: compare with the focal lengths'.
    const double scale =
        model_->intrinsicMatrix()(0, 0) * model_->intrinsicMatrix()(1, 1) / (model_->fx() * model_->fy());
    if (!(found.raw_by_rectified.determinant() > kSmallestStretch * scale)) return std::nullopt;
    if (miss.norm() < kRaysAgree) return found;
    found.pixel += found.raw_by_rectified.inverse() * miss;
  }
  return std::nullopt;
}

Eigen::Vector2d PixelRays::distort(const Eigen::Vector2d& rectified) const {
  const cv::Point2d raw = model_->unrectifyPoint({rectified.x(), rectified.y()});
  return {raw.x, raw.y};
}

Eigen::Matrix2d PixelRays::distortionJacobian(const Eigen::Vector2d& rectified) const {
  const Eigen::Vector2d right(kJacobianStep, 0.0), down(0.0, kJacobianStep);
  Eigen::Matrix2d jacobian;
  jacobian.col(0) = (distort(rectified + right) - distort(rectified - right)) / (2.0 * kJacobianStep);
  jacobian.col(1) = (distort(rectified + down) - distort(rectified - down)) / (2.0 * kJacobianStep);
  return jacobian;
}

}  // namespace sightline_ros
