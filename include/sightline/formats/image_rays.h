#pragma once

#include <optional>
#include <string>

#include <Eigen/Core>

#include "sightline/core/imaging/lens.h"
#include "sightline/formats/import_options.h"
#include "sightline/formats/text_file.h"

namespace sightline::formats {

/// A direction in an image: (azimuth, elevation) [rad], x along the axis, y left, z up, and d angles / d
/// pixel.
struct ImageRay {
  Eigen::Vector2d angles = Eigen::Vector2d::Zero();
  Eigen::Matrix2d jacobian = Eigen::Matrix2d::Zero();  ///< [rad/pixel]
};

/// Directions of pixels. Pixel (0, 0) is the middle of the upper left one.
class ImageRays {
 public:
  /// From the camera's calibration (camera_info YAML: camera_matrix, distortion_model,
  /// distortion_coefficients), or from field of view and image size. Throws FormatError when neither is told,
  /// and for a calibration with a mistake.
  static ImageRays from(const ImportOptions& options, const TextFile& file);

  /// nullopt when no ray falls on the pixel.
  std::optional<ImageRay> rayAt(const Eigen::Vector2d& pixel) const;

 private:
  ImageRays(core::Lens lens, const Eigen::Vector2d& focal, const Eigen::Vector2d& principal);
  static ImageRays fromCalibration(const std::string& path);

  core::Lens lens_;
  Eigen::Vector2d focal_, principal_;  // [pixels]
};

}  // namespace sightline::formats
