#include "sightline/formats/image_rays.h"

#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "format_files.h"
#include "support/scratch_folder.h"

namespace {

using namespace sightline::test;
using namespace sightline::formats;

const TextFile kFile("f", "x");

ImageRays calibrated(const std::string& text) {
  const ScratchFolder folder;
  ImportOptions options;
  options.camera = folder.write("camera.yaml", text);
  return ImageRays::from(options, kFile);
}

std::string yaml(const std::string& model, const std::string& coefficients) {
  return "camera_matrix: {data: [400, 0, 640, 0, 400, 480, 0, 0, 1]}\ndistortion_model: " + model +
         "\ndistortion_coefficients: {data: [" + coefficients + "]}\n";
}

TEST(ImageRays, RightOfTheAxisIsANegativeAzimuthAndAboveAPositiveElevation) {
  ImportOptions options;
  options.image_size = Eigen::Vector2d(1281.0, 961.0);
  options.field_of_view = Eigen::Vector2d(2.0 * std::atan(640.5 / 500.0), 2.0 * std::atan(480.5 / 500.0));
  const ImageRays rays = ImageRays::from(options, kFile);
  EXPECT_NEAR(rays.rayAt({640.0, 480.0})->angles.norm(), 0.0, 1e-12);
  EXPECT_NEAR(rays.rayAt({1140.0, 480.0})->angles.x(), -45.0 * kDegree, 1e-12);
  EXPECT_NEAR(rays.rayAt({640.0, 380.0})->angles.y(), std::atan(0.2), 1e-12);
}

TEST(ImageRays, FisheyesAreEquidistant) {
  const ImageRays rays = calibrated(yaml("equidistant", "0, 0, 0, 0"));
  EXPECT_NEAR(rays.rayAt({640.0 + 400.0 * 60.0 * kDegree, 480.0})->angles.x(), -60.0 * kDegree, 1e-9);
}

TEST(ImageRays, TheJacobianIsThatOfDifferences) {
  const ImageRays rays = calibrated(yaml("plumb_bob", "-0.26, 0.075, 0.001, -0.002, -0.009"));
  const Eigen::Vector2d pixel(800.0, 350.0);
  const auto ray = rays.rayAt(pixel);
  for (int axis = 0; axis < 2; ++axis) {
    const Eigen::Vector2d step = 1e-3 * Eigen::Vector2d::Unit(axis);
    const Eigen::Vector2d slope =
        (rays.rayAt(pixel + step)->angles - rays.rayAt(pixel - step)->angles) / 2e-3;
    EXPECT_LT((slope - ray->jacobian.col(axis)).norm(), 1e-9);
  }
}

TEST(ImageRays, CalibrationsWithMistakesAreRefused) {
  EXPECT_TRUE(contains(refusal([] { calibrated("camera_matrix: {data: [0, 0, 0, 0, 0, 0, 0, 0, 0]}\n"); }),
                       "focal lengths above 0"));
  EXPECT_TRUE(contains(refusal([] { calibrated(yaml("thin_plate", "0")); }), "got \"thin_plate\""));
  EXPECT_TRUE(contains(refusal([] { calibrated(yaml("equidistant", "0, 0, 0, 0, 0")); }),
                       "too many for equidistant"));
  EXPECT_TRUE(contains(refusal([] { calibrated("a: [\n"); }), "no calibration of a camera"));
  EXPECT_TRUE(contains(refusal([] { ImageRays::from({}, kFile); }), "--camera FILE.yaml"));
}

}  // namespace
