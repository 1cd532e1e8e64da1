#pragma once

#include <memory>
#include <optional>
#include <string>

#include <Eigen/Core>

#include <sensor_msgs/CameraInfo.h>

#include "sightline/core/model/refusal.h"
#include "sightline/core/model/sighting.h"

namespace image_geometry {
class PinholeCameraModel;
}

namespace sightline_ros {

/// What is wrong with a camera's calibration for turning pixels into directions, with the remedy; nullopt
/// when nothing is. Refused: K = 0 (not calibrated), a focal length or an image size that makes no sense, a
/// distortion model that image_geometry does not know.
std::optional<sightline::core::Refusal> refusalOf(const sensor_msgs::CameraInfo& camera);

/// Whether two CameraInfos say the same but for their stamps.
bool isSameCalibration(const sensor_msgs::CameraInfo& a, const sensor_msgs::CameraInfo& b);

/// The calibration of an ideal pinhole camera whose image spans a field of view [rad, full angles, below pi].
sensor_msgs::CameraInfo pinholeCamera(unsigned width, unsigned height, const Eigen::Vector2d& field_of_view);

/// Directions of a camera's pixels. A pixel's centre has whole coordinates: (0, 0) is that of the first one.
class PixelRays {
 public:
  /// `rectified`: pixels are of the rectified image (image_rect), not of the raw one. Throws
  /// std::invalid_argument with the detail of `refusalOf`.
  PixelRays(const sensor_msgs::CameraInfo& camera, bool rectified);

  /// Sighting in the optical frame (x right, y down, z forward; as everywhere in ROS it is taken for that of
  /// the rectified image, which matters for a stereo pair only) at a pixel with its covariance [px^2],
  /// carried over by the Jacobian of projection and distortion. nullopt when the covariance is not positive
  /// definite, or when no ray falls on this pixel (far outside of where the distortion model holds).
  std::optional<sightline::core::Sighting> sightingAt(const Eigen::Vector2d& pixel,
                                                      const Eigen::Matrix2d& covariance) const;

  /// Whether a pixel lies on the image (its edge pixels' outer borders included).
  bool isOnImage(const Eigen::Vector2d& pixel) const;

  const std_msgs::Header& header() const { return camera_.header; }  ///< of the CameraInfo
  const std::string& frame() const { return camera_.header.frame_id; }
  unsigned width() const { return width_; }    ///< of the image as it is published [px]
  unsigned height() const { return height_; }  ///< [px]
  double ifov() const;                         ///< angle of one pixel at the image's centre [rad]

  /// Of a newer CameraInfo with the same calibration.
  void setStamp(const ros::Time& stamp) { camera_.header.stamp = stamp; }

 private:
  /// The rectified pixel that the distortion brings to a raw one, and d raw / d rectified.
  struct Rectified {
    Eigen::Vector2d pixel;
    Eigen::Matrix2d raw_by_rectified;
  };

  std::optional<Rectified> rectify(const Eigen::Vector2d& raw) const;
  Eigen::Vector2d distort(const Eigen::Vector2d& rectified) const;
  Eigen::Matrix2d distortionJacobian(const Eigen::Vector2d& rectified) const;

  sensor_msgs::CameraInfo camera_;
  std::shared_ptr<const image_geometry::PinholeCameraModel> model_;
  bool rectified_;
  unsigned width_, height_;
};

}  // namespace sightline_ros
