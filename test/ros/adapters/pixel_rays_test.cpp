#include "sightline/ros/adapters/pixel_rays.h"

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <tuple>
#include <vector>

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

/// The pixel of a direction by the plumb bob model, written down once more.
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
      EXPECT_LT((pixelOf(wideCamera(), sighting->direction) - Eigen::Vector2d(u, v)).norm(), 1e-9)
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
  // A binned pixel joins the pixels (100, 60) to (101, 61): its centre is between them.
  const auto a = full.sightingAt({100.5, 60.5}, kHalfPixel), b = binned.sightingAt({50.0, 30.0}, kHalfPixel);
  ASSERT_TRUE(a && b);
  EXPECT_LT(core::angleBetween(a->direction, b->direction), 1e-12);
  EXPECT_NEAR(std::sqrt(b->covariance.trace() / a->covariance.trace()), 2.0, 1e-6);
  EXPECT_NEAR(binned.ifov(), 2.0 * full.ifov(), 1e-12);
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
  EXPECT_LT(core::angleBetween(sighting->direction, ray), 1e-9);
}

/// K 600/610 with the centre at 640/480 of 1280x960 pixels, without distortion.
sensor_msgs::CameraInfo plainCamera() {
  sensor_msgs::CameraInfo camera;
  camera.header.frame_id = "camera_optical";
  camera.width = 1280;
  camera.height = 960;
  camera.distortion_model = "plumb_bob";
  camera.D.assign(5, 0.0);
  camera.K = {600.0, 0.0, 640.0, 0.0, 610.0, 480.0, 0.0, 0.0, 1.0};
  camera.R = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
  camera.P = {600.0, 0.0, 640.0, 0.0, 0.0, 610.0, 480.0, 0.0, 0.0, 0.0, 1.0, 0.0};
  return camera;
}

/// (azimuth, elevation) in the boresight frame of a pixel.
Eigen::Vector2d anglesAt(const sensor_msgs::CameraInfo& camera, const Eigen::Vector2d& pixel,
                         bool rectified = false) {
  const auto sighting = PixelRays(camera, rectified).sightingAt(pixel, kHalfPixel);
  if (!sighting) {
    ADD_FAILURE() << "no ray at " << pixel.transpose();
    return Eigen::Vector2d::Zero();
  }
  return core::anglesOf(core::R_boresight_optical() * sighting->direction);
}

TEST(PixelRays, AnEquidistantCameraWithoutCoefficientsIsAFisheyeAllTheSame) {
  for (const std::vector<double>& D : {std::vector<double>{}, std::vector<double>(4, 0.0)}) {
    sensor_msgs::CameraInfo camera = plainCamera();
    camera.distortion_model = "equidistant";
    camera.D = D;
    camera.K = {400.0, 0.0, 640.0, 0.0, 400.0, 480.0, 0.0, 0.0, 1.0};
    camera.P = {400.0, 0.0, 640.0, 0.0, 0.0, 400.0, 480.0, 0.0, 0.0, 0.0, 1.0, 0.0};
    const Eigen::Vector2d angles = anglesAt(camera, {640.0 + 400.0 * 60.0 * core::kDegree, 480.0});
    EXPECT_NEAR(angles.x(), -1.047198, 1e-6);
    EXPECT_NEAR(angles.x(), -60.0 * core::kDegree, 1e-12);
    EXPECT_NEAR(angles.y(), 0.0, 1e-12);
  }
}

TEST(PixelRays, AFisheyesRaysAreRightFromEightyFiveDegreesToBehindTheCamera) {
  sensor_msgs::CameraInfo camera = plainCamera();
  camera.distortion_model = "equidistant";
  camera.D = {0.02, -0.004, 0.001, 0.0};
  camera.width = camera.height = 1400;
  camera.K = {300.0, 0.0, 699.5, 0.0, 300.0, 699.5, 0.0, 0.0, 1.0};
  camera.P.fill(0.0);
  const PixelRays rays(camera, false);
  EXPECT_EQ(rays.shareWithoutRay(), 0.0);
  for (const double degrees : {80.0, 84.9, 85.0, 89.999, 90.0, 90.001, 95.0, 105.0}) {
    const double theta = degrees * core::kDegree, bearing = 0.4;
    const double bent =
        theta * (1.0 + 0.02 * std::pow(theta, 2) - 0.004 * std::pow(theta, 4) + 0.001 * std::pow(theta, 6));
    const Eigen::Vector2d pixel(699.5 + 300.0 * bent * std::cos(bearing),
                                699.5 + 300.0 * bent * std::sin(bearing));
    ASSERT_TRUE(rays.isOnImage(pixel)) << degrees;
    const auto sighting = rays.sightingAt(pixel, kHalfPixel);
    ASSERT_TRUE(sighting) << degrees;
    const Eigen::Vector3d ray(std::sin(theta) * std::cos(bearing), std::sin(theta) * std::sin(bearing),
                              std::cos(theta));
    EXPECT_LT(core::angleBetween(sighting->direction, ray), 1e-9) << degrees;
    // Half a pixel off the axis is half a pixel over f and the polynomial's slope; round it, as the arc.
    const double slope =
        1.0 + 0.06 * std::pow(theta, 2) - 0.02 * std::pow(theta, 4) + 0.007 * std::pow(theta, 6);
    const double along = 0.5 / (300.0 * slope), round = 0.5 / (300.0 * bent) * std::sin(theta);
    EXPECT_NEAR(sighting->covariance.trace(), along * along + round * round, 1e-12) << degrees;
  }
}

TEST(PixelRays, RawPixelsAreThoseOfKWhateverPIs) {
  sensor_msgs::CameraInfo camera = plainCamera();
  camera.P = {500.0, 0.0, 630.0, 0.0, 0.0, 505.0, 470.0, 0.0, 0.0, 0.0, 1.0, 0.0};
  const Eigen::Vector2d raw = anglesAt(camera, {900.0, 700.0});
  EXPECT_NEAR(raw.x(), -0.408908, 1e-6);
  EXPECT_NEAR(raw.y(), -0.319579, 1e-6);
  const Eigen::Vector2d rectified = anglesAt(camera, {900.0, 700.0}, true);
  EXPECT_NEAR(rectified.x(), -std::atan(270.0 / 500.0), 1e-12);
  EXPECT_NEAR(PixelRays(camera, false).ifov(), 1.0 / std::sqrt(600.0 * 610.0), 1e-12);
  EXPECT_NEAR(PixelRays(camera, true).ifov(), 1.0 / std::sqrt(500.0 * 505.0), 1e-12);
}

TEST(PixelRays, RawPixelsAreTurnedByRIntoTheFrameOfTheRectifiedImage) {
  sensor_msgs::CameraInfo camera = plainCamera();
  const double c = std::cos(0.1), s = std::sin(0.1);  // about y, which points down
  camera.R = {c, 0.0, s, 0.0, 1.0, 0.0, -s, 0.0, c};
  const Eigen::Vector2d angles = anglesAt(camera, {900.0, 480.0});
  EXPECT_NEAR(angles.x(), -std::atan(260.0 / 600.0) - 0.1, 1e-12);
  EXPECT_NEAR(angles.y(), 0.0, 1e-12);
  EXPECT_NEAR(anglesAt(camera, {900.0, 480.0}, true).x(), -std::atan(260.0 / 600.0), 1e-12);
}

TEST(PixelRays, TheBaselineOfAStereoPairIsNoDirection) {
  sensor_msgs::CameraInfo right = plainCamera();
  right.P[3] = -600.0 * 0.12;  // [px m]
  EXPECT_NEAR(anglesAt(right, {640.0, 480.0}, true).x(), 0.0, 1e-12);
  EXPECT_NEAR(anglesAt(right, {640.0, 480.0}, false).x(), 0.0, 1e-12);
}

TEST(PixelRays, BinningJoinsPixels) {
  for (const auto& [binning, pixel, azimuth] :
       {std::tuple{2u, Eigen::Vector2d(200.0, 150.0), 0.379788}, {4u, {100.0, 75.0}, 0.378349}}) {
    for (const bool rectified : {false, true}) {
      sensor_msgs::CameraInfo camera = plainCamera();
      camera.binning_x = camera.binning_y = binning;
      const Eigen::Vector2d angles = anglesAt(camera, pixel, rectified);
      EXPECT_NEAR(angles.x(), azimuth, 1e-6) << binning;
      const double joined = binning * pixel.y() + 0.5 * (binning - 1.0);
      const double across = std::hypot(1.0, std::tan(angles.x()));
      EXPECT_NEAR(angles.y(), std::atan((480.0 - joined) / 610.0 / across), 1e-12) << binning;
    }
  }
}

TEST(PixelRays, ARegionOfABinnedImageBeginsAtItsOffset) {
  sensor_msgs::CameraInfo all = plainCamera(), region = plainCamera();
  all.binning_x = all.binning_y = region.binning_x = region.binning_y = 2;
  region.roi.x_offset = 200;
  region.roi.y_offset = 100;
  region.roi.width = 600;
  region.roi.height = 400;
  EXPECT_EQ(PixelRays(region, false).width(), 300u);
  EXPECT_LT((anglesAt(region, {10.0, 20.0}) - anglesAt(all, {110.0, 70.0})).norm(), 1e-12);
}

// The model bends back at 703 px from the centre, and the corners are at 800: there is no ray for them.
TEST(PixelRays, CornersOfABarrelLensBeyondItsFoldAreRefusedWithTheReasonAndTheRestIsRight) {
  sensor_msgs::CameraInfo camera = plainCamera();
  camera.D = {-0.26, 0.075, 0.0, 0.0, -0.009};
  camera.K = {600.0, 0.0, 640.0, 0.0, 600.0, 480.0, 0.0, 0.0, 1.0};
  camera.P.fill(0.0);
  const PixelRays rays(camera, false);
  for (double u = 0.0; u <= 1279.0; u += 31.0) {
    for (double v = 0.0; v <= 959.0; v += 29.0) {
      const auto sighting = rays.sightingAt({u, v}, kHalfPixel);
      ASSERT_EQ(sighting.has_value(), std::hypot(u - 640.0, v - 480.0) < 703.1207) << u << ", " << v;
      if (!sighting) continue;
      EXPECT_LT((pixelOf(camera, sighting->direction) - Eigen::Vector2d(u, v)).norm(), 1e-9)
          << u << ", " << v;
    }
  }
  EXPECT_NEAR(100.0 * rays.shareWithoutRay(), 3.42, 0.2);  // of a coarse grid
  const auto why = rays.whyNoRay({2.0, 2.0});
  ASSERT_TRUE(why);
  EXPECT_NE(why->find("pixel (2, 2)"), std::string::npos) << *why;
  EXPECT_NE(why->find("ends at 1.17"), std::string::npos) << *why;
  EXPECT_NE(why->find("62.8"), std::string::npos) << *why << ": the angle off the axis";
  EXPECT_NE(rays.warning().find("% of the pixels"), std::string::npos) << rays.warning();
  EXPECT_FALSE(rays.whyNoRay({640.0, 480.0}));

  camera.K[0] = camera.K[4] = 700.0;
  const PixelRays longer(camera, false);
  EXPECT_TRUE(longer.sightingAt({0.0, 0.0}, kHalfPixel));
  EXPECT_EQ(longer.shareWithoutRay(), 0.0);
  EXPECT_EQ(longer.warning(), "");
}

TEST(PixelRays, OfARectifiedImagePAloneIsNeeded) {
  sensor_msgs::CameraInfo camera = plainCamera();
  camera.K.fill(0.0);
  camera.distortion_model = "a lens of its own";
  EXPECT_FALSE(refusalOf(camera, true));
  EXPECT_NEAR(anglesAt(camera, {900.0, 480.0}, true).x(), -std::atan(260.0 / 600.0), 1e-12);
  const auto raw = refusalOf(camera, false);
  ASSERT_TRUE(raw);
  EXPECT_NE(raw->detail.find("set rectified: true"), std::string::npos) << raw->detail;
  camera.P[5] = -1.0;
  EXPECT_NE(refusalOf(camera, true)->detail.find("P[5] = -1 px"), std::string::npos);
  camera.P.fill(0.0);
  EXPECT_NE(refusalOf(camera, true)->detail.find("K[0] = 0"), std::string::npos);
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
    const auto refusal = refusalOf(camera, false);
    return refusal ? refusal->detail : "none";
  };
  EXPECT_NE(fault([](auto& camera) { camera.K.fill(0.0); }).find("not calibrated (K[0] = 0"),
            std::string::npos);
  EXPECT_NE(fault([](auto& camera) { camera.K[4] = -5.0; }).find("K[4] = -5 px"), std::string::npos);
  EXPECT_NE(fault([](auto& camera) { camera.width = 0; }).find("0x512 pixels"), std::string::npos);
  EXPECT_NE(fault([](auto& camera) { camera.distortion_model = "fov"; }).find("\"fov\" is not known"),
            std::string::npos);
  EXPECT_NE(fault([](auto& camera) { camera.D = {0.1}; }).find("has 1 coefficients D"), std::string::npos);
  EXPECT_NE(fault([](auto& camera) {
              camera.distortion_model = "equidistant";
              camera.D.assign(5, 0.1);
            }).find("none or 4 are expected"),
            std::string::npos);
  EXPECT_NE(fault([](auto& camera) {
              camera.D[2] = std::numeric_limits<double>::quiet_NaN();
            }).find("D is not finite"),
            std::string::npos);
  EXPECT_NE(fault([](auto& camera) { camera.R[0] = 5.0; }).find("R is no rotation"), std::string::npos);
  EXPECT_FALSE(refusalOf(wideCamera(), false));
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
