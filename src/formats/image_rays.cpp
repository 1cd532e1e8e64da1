#include "sightline/formats/image_rays.h"

#include <cmath>
#include <utility>
#include <vector>

#include <yaml-cpp/yaml.h>

#include "sightline/core/model/sphere.h"

namespace sightline::formats {

using core::Lens;

namespace {

constexpr std::size_t kLargestCalibration = std::size_t{1} << 20;  // [bytes]

}  // namespace

ImageRays::ImageRays(Lens lens, const Eigen::Vector2d& focal, const Eigen::Vector2d& principal)
    : lens_(std::move(lens)), focal_(focal), principal_(principal) {}

ImageRays ImageRays::fromCalibration(const std::string& path) {
  const TextFile file = TextFile::fromFile(path);
  if (file.text().size() > kLargestCalibration)
    throw file.error(0, "is too long for the calibration of a camera");
  try {
    const YAML::Node camera = YAML::Load(file.text());
    const auto matrix = camera["camera_matrix"]["data"].as<std::vector<double>>();
    if (matrix.size() != 9 || !(matrix[0] > 0.0) || !(matrix[4] > 0.0))
      throw file.error(
          0, "camera_matrix: expected 9 numbers with focal lengths above 0, an uncalibrated camera has none");
    std::vector<double> coefficients;
    if (camera["distortion_coefficients"] && camera["distortion_coefficients"]["data"])
      coefficients = camera["distortion_coefficients"]["data"].as<std::vector<double>>();
    const std::string model =
        camera["distortion_model"] ? camera["distortion_model"].as<std::string>() : std::string("plumb_bob");
    const bool is_fisheye = model == "equidistant" || model == "fisheye";
    if (!is_fisheye && model != "plumb_bob" && model != "rational_polynomial")
      throw file.error(0, "distortion_model: expected plumb_bob, rational_polynomial or equidistant, got \"" +
                              model + "\"");
    if (coefficients.size() > (is_fisheye ? 4U : 14U))
      throw file.error(0, "distortion_coefficients: there are " + std::to_string(coefficients.size()) +
                              ", too many for " + model);
    return {is_fisheye ? Lens::equidistant(coefficients) : Lens::perspective(coefficients),
            Eigen::Vector2d(matrix[0], matrix[4]), Eigen::Vector2d(matrix[2], matrix[5])};
  } catch (const YAML::Exception& problem) {
    throw file.error(problem.mark.is_null() ? 0 : static_cast<std::size_t>(problem.mark.line) + 1,
                     "is no calibration of a camera (camera_info YAML with camera_matrix): " + problem.msg);
  }
}

ImageRays ImageRays::from(const ImportOptions& options, const TextFile& file) {
  if (!options.camera.empty()) return fromCalibration(options.camera);
  if (!options.field_of_view || !options.image_size) {
    throw file.error(
        0,
        "boxes are in pixels: state the camera with --camera FILE.yaml (its calibration), or --field-of-view "
        "24deg,19deg and --image-size 1920x1080 of an undistorted image");
  }
  const Eigen::Vector2d half = 0.5 * *options.image_size;
  const Eigen::Vector2d focal(half.x() / std::tan(0.5 * options.field_of_view->x()),
                              half.y() / std::tan(0.5 * options.field_of_view->y()));
  return {Lens::perspective({}), focal, half.array() - 0.5};
}

std::optional<ImageRay> ImageRays::rayAt(const Eigen::Vector2d& pixel) const {
  const auto ray = lens_.rayAt((pixel - principal_).cwiseQuotient(focal_));
  if (!ray) return std::nullopt;
  // From x right, y down, z along the axis to x along the axis, y left, z up.
  Eigen::Matrix3d turn;
  turn << 0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0, -1.0, 0.0;
  const double length = ray->direction.norm();
  const Eigen::Vector3d direction = turn * ray->direction / length;
  ImageRay found;
  found.angles = core::anglesOf(direction);
  found.jacobian =
      core::anglesJacobian(direction) * turn * ray->jacobian / length * focal_.cwiseInverse().asDiagonal();
  return found;
}

}  // namespace sightline::formats
