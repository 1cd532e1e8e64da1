#pragma once

#include <optional>
#include <string>

#include <Eigen/Core>

#include <sensor_msgs/CameraInfo.h>

#include "sightline/core/imaging/lens.h"
#include "sightline/core/model/refusal.h"
#include "sightline/core/model/sighting.h"

namespace sightline_ros {

/// What is wrong with a camera's calibration for turning pixels into directions, with the remedy; nullopt
/// when nothing is. Of a raw image K, D and R are needed, of a rectified one P alone (or K, where P is left
/// out). Refused: what is not calibrated, a focal length or an image size that makes no sense, a distortion
/// model that is not known here or has a wrong number of coefficients, an R that is no rotation.
std::optional<sightline::core::Refusal> refusalOf(const sensor_msgs::CameraInfo& camera, bool rectified);

/// Whether two CameraInfos say the same but for their stamps.
bool isSameCalibration(const sensor_msgs::CameraInfo& a, const sensor_msgs::CameraInfo& b);

/// The calibration of an ideal pinhole camera whose image spans a field of view [rad, full angles, below pi].
sensor_msgs::CameraInfo pinholeCamera(unsigned width, unsigned height, const Eigen::Vector2d& field_of_view);

/// Directions of a camera's pixels. A pixel's centre has whole coordinates: (0, 0) is that of the first one.
/// Of a binned image, too: the centre of its first pixel lies between those of the pixels that it joins.
class PixelRays {
 public:
  /// `rectified`: pixels are of the rectified image (image_rect), not of the raw one. Throws
  /// std::invalid_argument with the detail of `refusalOf`.
  PixelRays(const sensor_msgs::CameraInfo& camera, bool rectified);

  /// Sighting in the optical frame (x right, y down, z forward; as everywhere in ROS it is taken for that of
  /// the rectified image: the ray of a raw pixel is turned by R) at a pixel with its covariance [px^2],
  /// carried over by the Jacobian of the lens. nullopt when the covariance is not positive definite, or when
  /// no ray falls on this pixel.
  std::optional<sightline::core::Sighting> sightingAt(const Eigen::Vector2d& pixel,
                                                      const Eigen::Matrix2d& covariance) const;

  /// Why no ray falls on a pixel, with the remedy; nullopt when one does.
  std::optional<std::string> whyNoRay(const Eigen::Vector2d& pixel) const;

  /// Share of the image's pixels on which no ray falls, from a grid of some thousand; 0 when all have one.
  double shareWithoutRay() const { return share_without_ray_; }

  /// What is to be said of a camera of whose image a part has no rays; empty when all of it has.
  std::string warning() const;

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
  Eigen::Vector2d imageOf(const Eigen::Vector2d& pixel) const;
  double countWithoutRay() const;

  sensor_msgs::CameraInfo camera_;
  unsigned width_, height_;
  sightline::core::Lens lens_;
  Eigen::Matrix2d image_by_pixel_;    // d (image at focal length 1) / d pixel
  Eigen::Vector2d principal_point_;   // [px] of the image as it is published
  Eigen::Matrix3d R_optical_camera_;  // from the lens's frame to the one of the rectified image
  double share_without_ray_ = 0.0;
};

}  // namespace sightline_ros
