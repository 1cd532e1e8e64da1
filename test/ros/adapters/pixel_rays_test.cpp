#include "sightline/ros/adapters/pixel_rays.h"

#include <cmath>
#include <limits>
#include <stdexcept>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "sightline/core/model/line_of_sight.h"
#include "sightline/core/model/sphere.h"
#include "sightline/core/simulation/random_stream.h"

namespace sightline_ros {
namespace {

namespace core = sightline::core;

sensor_msgs::CameraInfo wideCamera() {
  sensor_msgs::CameraInfo camera = pinholeCamera(640, 512, {64.0 * core::kDegree, 53.0 * core::kDegree});
  camera.header.frame_id = "camera_optical";
  camera.D = {-0.31, 0.12, 0.001, -0.0015, -0.02};
  return camera;
}

/// The pixel of a direction by the plumb bob model, written down independently of image_geometry.
Eigen::Vector2d pixelOf(const sensor_msgs::CameraInfo& camera, const Eigen::Vector3d& ray) {
  const double x = ray.x() / ray.z(), y = ray.y() / ray.z(), r2 = x * x + y * y;
  const auto& D = camera.D;
  const double radial = 1.0 + D[0] * r2 + D[1] * r2 * r2 + D[4] * r2 * r2 * r2;
  const double xd = x * radial + 2.0 * D[2] * x * y + D[3] * (r2 + 2.0 * x * x);
  const double yd = y * radial + D[2] * (r2 + 2.0 * y * y) + 2.0 * D[3] * x * y;
  return {camera.K[0] * xd + camera.K[2], camera.K[4] * yd + camera.K[5]};
}

const Eigen::Matrix2d kHalfPixel = Eigen::Matrix2d::Identity() * 0.25;

TEST(PixelRays, RaysLeadBackToTheirPixelsThroughTheDistortionOverTheWholeImage) {
  const PixelRays rays(wideCamera(), false);
  for (double u = 0.0; u <= 639.0; u += 71.0) {
    for (double v = 0.0; v <= 511.0; v += 73.0) {
      const auto sighting = rays.sightingAt({u, v}, kHalfPixel);
      ASSERT_TRUE(sighting) << u << ", " << v;
      EXPECT_LT((pixelOf(wideCamera(), sighting->direction) - Eigen::Vector2d(u, v)).norm(), 1e-4)
          << u << ", " << v;
    }
  }
}

TEST(PixelRays, CovarianceIsThatOfTheRaysOfNoisyPixelsNearTheCornerToo) {
  const PixelRays rays(wideCamera(), false);
  Eigen::Matrix2d covariance;
  covariance << 0.5, 0.2, 0.2, 0.3;  // [px^2]
  const Eigen::Matrix2d root = covariance.llt().matrixL();
  for (const Eigen::Vector2d& pixel : {Eigen::Vector2d(320.0, 250.0), Eigen::Vector2d(30.0, 25.0)}) {
    const auto stated = rays.sightingAt(pixel, covariance);
    ASSERT_TRUE(stated);
    const core::Sighting seen = core::rotate(*stated, core::R_boresight_optical());
    const Eigen::LLT<Eigen::Matrix2d> whiten(core::anglesCovariance(seen));
    core::RandomStream stream(3);
    constexpr int kDraws = 4000;
    Eigen::Matrix2d scatter = Eigen::Matrix2d::Zero();
    for (int i = 0; i < kDraws; ++i) {
      const auto noisy = rays.sightingAt(pixel + root * stream.normalPair(), covariance);
      const Eigen::Vector2d angles = core::anglesOf(core::R_boresight_optical() * noisy->direction);
      const Eigen::Vector2d error =
          whiten.matrixL().solve(core::angleDifference(angles, core::anglesOf(seen.direction)));
      scatter += error * error.transpose() / kDraws;
    }
    // Whitened: the identity. A variance scatters by sqrt(2/n); four of them.
    const double band = 4.0 * std::sqrt(2.0 / kDraws);
    EXPECT_NEAR(scatter(0, 0), 1.0, band);
    EXPECT_NEAR(scatter(1, 1), 1.0, band);
    EXPECT_NEAR(scatter(0, 1), 0.0, band);
  }
}

TEST(PixelRays, DistortionMattersToTheCovariance) {
  sensor_msgs::CameraInfo ideal = wideCamera();
  ideal.D.assign(5, 0.0);
  const auto bent = PixelRays(wideCamera(), false).sightingAt({30.0, 25.0}, kHalfPixel);
  const auto straight = PixelRays(ideal, false).sightingAt({30.0, 25.0}, kHalfPixel);
  ASSERT_TRUE(bent && straight);
  EXPECT_GT(bent->covariance.trace() / straight->covariance.trace(), 1.2);
}

TEST(PixelRays, PixelsOfTheRectifiedImageAreNotUndistortedAgain) {
  const auto sighting = PixelRays(wideCamera(), true).sightingAt({30.0, 25.0}, kHalfPixel);
  ASSERT_TRUE(sighting);
  const sensor_msgs::CameraInfo camera = wideCamera();
  const Eigen::Vector3d ray((30.0 - camera.K[2]) / camera.K[0], (25.0 - camera.K[5]) / camera.K[4], 1.0);
  EXPECT_LT(core::angleBetween(sighting->direction, ray), 1e-9);
}

TEST(PixelRays, AStatedFieldOfViewReachesFromEdgeToEdge) {
  const PixelRays rays(pinholeCamera(640, 512, {24.0 * core::kDegree, 19.0 * core::kDegree}), false);
  const auto angle = [&](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return core::angleBetween(rays.sightingAt(a, kHalfPixel)->direction,
                              rays.sightingAt(b, kHalfPixel)->direction);
  };
  EXPECT_NEAR(angle({-0.5, 255.5}, {639.5, 255.5}), 24.0 * core::kDegree, 1e-9);
  EXPECT_NEAR(angle({319.5, -0.5}, {319.5, 511.5}), 19.0 * core::kDegree, 1e-9);
}

TEST(PixelRays, BinnedImagesAreReadInTheirOwnPixels) {
  sensor_msgs::CameraInfo camera = wideCamera();
  camera.binning_x = camera.binning_y = 2;
  const PixelRays full(wideCamera(), false), binned(camera, false);
  EXPECT_EQ(binned.width(), 320u);
  const auto a = full.sightingAt({100.0, 60.0}, kHalfPixel), b = binned.sightingAt({50.0, 30.0}, kHalfPixel);
  ASSERT_TRUE(a && b);
  // image_geometry scales pixel coordinates without regard to where within the pixel they are: half a pixel.
  EXPECT_LT(core::angleBetween(a->direction, b->direction), 1.0 * full.ifov());
  EXPECT_NEAR(std::sqrt(b->covariance.trace() / a->covariance.trace()), 2.0, 0.1);
}

TEST(PixelRays, FisheyeCamerasAreReadByTheEquidistantModel) {
  sensor_msgs::CameraInfo camera = pinholeCamera(640, 512, {90.0 * core::kDegree, 80.0 * core::kDegree});
  camera.distortion_model = "equidistant";
  camera.D = {0.02, -0.004, 0.001, 0.0};
  const PixelRays rays(camera, false);
  const double theta = 0.7, bearing = 0.4;
  const double bent =
      theta * (1.0 + 0.02 * std::pow(theta, 2) - 0.004 * std::pow(theta, 4) + 0.001 * std::pow(theta, 6));
  const Eigen::Vector2d pixel(camera.K[2] + camera.K[0] * bent * std::cos(bearing),
                              camera.K[5] + camera.K[4] * bent * std::sin(bearing));
  const auto sighting = rays.sightingAt(pixel, kHalfPixel);
  ASSERT_TRUE(sighting);
  const Eigen::Vector3d ray(std::sin(theta) * std::cos(bearing), std::sin(theta) * std::sin(bearing),
                            std::cos(theta));
  EXPECT_LT(core::angleBetween(sighting->direction, ray), 1e-6);
}

TEST(PixelRays, APixelOnWhichNoRayFallsHasNoSighting) {
  sensor_msgs::CameraInfo camera = wideCamera();
  camera.D = {-0.9, 0.0, 0.0, 0.0, 0.0};  // folds over at r^2 = 1 / (3 * 0.9)
  const PixelRays rays(camera, false);
  EXPECT_TRUE(rays.sightingAt({320.0, 255.0}, kHalfPixel));
  EXPECT_FALSE(rays.sightingAt({2.0, 2.0}, kHalfPixel));
  EXPECT_FALSE(rays.sightingAt({std::numeric_limits<double>::quiet_NaN(), 2.0}, kHalfPixel));
  EXPECT_FALSE(rays.sightingAt({320.0, 255.0}, Eigen::Matrix2d::Zero()));
}

TEST(PixelRays, CamerasThatCannotBeUsedAreRefusedWithTheRemedy) {
  const auto fault = [](const auto& change) {
    sensor_msgs::CameraInfo camera = wideCamera();
    change(camera);
    EXPECT_THROW(PixelRays(camera, false), std::invalid_argument);
    const auto refusal = refusalOf(camera);
    return refusal ? refusal->detail : "none";
  };
  EXPECT_NE(fault([](auto& camera) { camera.K.fill(0.0); }).find("not calibrated (K[0] = 0"),
            std::string::npos);
  EXPECT_NE(fault([](auto& camera) { camera.K[4] = -5.0; }).find("K[4] = -5 px"), std::string::npos);
  EXPECT_NE(fault([](auto& camera) { camera.width = 0; }).find("0x512 pixels"), std::string::npos);
  EXPECT_NE(fault([](auto& camera) { camera.distortion_model = "fov"; }).find("\"fov\" is not known"),
            std::string::npos);
  EXPECT_FALSE(refusalOf(wideCamera()));
}

TEST(PixelRays, ACameraWithoutRAndPIsTheOneThatKDescribes) {
  sensor_msgs::CameraInfo camera = wideCamera();
  camera.R.fill(0.0);
  camera.P.fill(0.0);
  const auto a = PixelRays(camera, false).sightingAt({100.0, 60.0}, kHalfPixel);
  const auto b = PixelRays(wideCamera(), false).sightingAt({100.0, 60.0}, kHalfPixel);
  ASSERT_TRUE(a && b);
  EXPECT_LT(core::angleBetween(a->direction, b->direction), 1e-12);
}

}  // namespace
}  // namespace sightline_ros
