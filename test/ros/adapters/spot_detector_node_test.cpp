// The spot detector as node (with CameraInfo) and as nodelet (with a stated field of view and a tracker
// behind it).
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <diagnostic_msgs/DiagnosticArray.h>
#include <ros/ros.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>
#include <sightline/SightingArray.h>
#include <sightline/TrackArray.h>

#include "sightline/core/model/sphere.h"
#include "sightline/core/simulation/random_stream.h"
#include "sightline/ros/adapters/pixel_rays.h"

#include "support/received.h"

namespace {

namespace core = sightline::core;

constexpr unsigned kWidth = 320, kHeight = 256;  // [px]

class SpotDetectorNode : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(eventually([this] {
      return images_.getNumSubscribers() == 2 && camera_info_.getNumSubscribers() == 1 &&
             node_.isConnected() && nodelet_.isConnected() && tracks_.isConnected();
    })) << "the nodes did not come up";
  }

  /// A noisy sky with a spot at a pixel; without one when it is negative.
  sensor_msgs::Image imageWith(double u, double v, const std::string& encoding = "mono8") {
    const std::size_t bytes = encoding == "mono16"  ? 2
                              : encoding == "rgb8"  ? 3
                              : encoding == "32FC1" ? 4
                              : encoding == "64FC1" ? 8
                                                    : 1;
    const double scale = encoding == "mono16" ? 200.0 : 1.0;
    sensor_msgs::Image image;
    image.header.stamp = ros::Time::now();
    image.header.frame_id = "camera_optical";
    image.width = kWidth;
    image.height = kHeight;
    image.encoding = encoding;
    image.step = static_cast<std::uint32_t>(kWidth * bytes);
    image.data.resize(image.step * kHeight);
    for (unsigned y = 0; y < kHeight; ++y) {
      for (unsigned x = 0; x < kWidth; ++x) {
        const double d2 = (x - u) * (x - u) + (y - v) * (y - v);
        const double level =
            60.0 + 2.0 * stream_.normalPair().x() + (u < 0.0 ? 0.0 : 120.0 * std::exp(-0.5 * d2));
        const auto value = static_cast<std::uint16_t>(std::lround(scale * level));
        std::uint8_t* const pixel = &image.data[y * image.step + x * bytes];
        if (bytes == 4) {
          const auto single = static_cast<float>(level);
          std::memcpy(pixel, &single, bytes);
          continue;
        }
        if (bytes == 8) {
          std::memcpy(pixel, &level, bytes);
          continue;
        }
        for (std::size_t k = 0; k < bytes; ++k) {
          pixel[k] = static_cast<std::uint8_t>(bytes == 2 ? value >> (8 * k) : value);
        }
      }
    }
    return image;
  }

  /// The node's scan with this stamp, when it has come.
  static const sightline::SightingArray* scanOf(const Received<sightline::SightingArray>& heard,
                                                const ros::Time& stamp) {
    for (const auto& scan : heard.messages()) {
      if (scan.header.stamp == stamp) return &scan;
    }
    return nullptr;
  }

  std::string diagnosticOf(const std::string& node, const std::string& key) {
    std::string newest;
    for (const auto& array : diagnostics_.messages()) {
      for (const auto& status : array.status) {
        if (status.name.find(node) != 0) continue;
        for (const auto& value : status.values) {
          if (value.key == key) newest = value.value;
        }
      }
    }
    return newest;
  }

  void calibrate() {
    auto info = sightline_ros::pinholeCamera(kWidth, kHeight, {24.0 * core::kDegree, 19.0 * core::kDegree});
    info.header.frame_id = "camera_optical";
    camera_info_.publish(info);
    ASSERT_TRUE(eventually([&] {
      images_.publish(imageWith(-1.0, -1.0));
      return !node_.messages().empty();
    }));
  }

  sightline::core::RandomStream stream_{1};
  ros::NodeHandle nh_;
  ros::Publisher images_ = nh_.advertise<sensor_msgs::Image>("/camera/image_raw", 100);
  ros::Publisher camera_info_ = nh_.advertise<sensor_msgs::CameraInfo>("/camera/camera_info", 100);
  Received<sightline::SightingArray> node_{nh_, "/node/sightings"};
  Received<sightline::SightingArray> nodelet_{nh_, "/nodelet/sightings"};
  Received<sightline::TrackArray> tracks_{nh_, "/nodelet/tracks"};
  Received<diagnostic_msgs::DiagnosticArray> diagnostics_{nh_, "/diagnostics"};
};

TEST_F(SpotDetectorNode, WithoutCalibrationNothingIsSaidAndTheRemedyIs) {
  images_.publish(imageWith(100.0, 80.0));
  EXPECT_TRUE(
      eventually([&] { return !diagnosticOf("node/spot_detector", "refused, no calibration").empty(); }));
  sensor_msgs::CameraInfo uncalibrated;
  camera_info_.publish(uncalibrated);
  EXPECT_TRUE(eventually(
      [&] { return !diagnosticOf("node/spot_detector", "refused, camera not calibrated").empty(); }));
  EXPECT_TRUE(node_.messages().empty());
}

TEST_F(SpotDetectorNode, ASpotBecomesASightingAtItsAnglesInEveryEncoding) {
  calibrate();
  const double fx = 160.0 / std::tan(12.0 * core::kDegree),
               fy = 128.0 / std::tan(9.5 * core::kDegree);  // [px]
  for (const std::string encoding : {"mono8", "mono16", "rgb8"}) {
    const auto image = imageWith(99.5, 80.25, encoding);
    images_.publish(image);
    ASSERT_TRUE(eventually([&] { return scanOf(node_, image.header.stamp) != nullptr; })) << encoding;
    const auto& scan = *scanOf(node_, image.header.stamp);
    EXPECT_EQ(scan.sensor, "node");
    EXPECT_EQ(scan.header.frame_id, "camera_optical_boresight");
    EXPECT_NEAR(scan.ifov, 1.0 / std::sqrt(fx * fy), 1e-9);
    ASSERT_EQ(scan.sightings.size(), 1u) << encoding;
    EXPECT_NEAR(scan.sightings[0].azimuth, std::atan(60.0 / fx), 0.2 / fx);
    EXPECT_NEAR(scan.sightings[0].elevation, std::atan(47.25 / std::hypot(fy, 60.0 * fy / fx)), 0.2 / fy);
    EXPECT_GT(scan.sightings[0].snr, 10.0);
    EXPECT_GT(scan.sightings[0].covariance[0], 0.0);
  }
}

/// Replaces the pixels of a rectangle of a 32FC1 or 64FC1 image.
template <typename Pixel>
void spoil(sensor_msgs::Image& image, unsigned left, unsigned top, unsigned right, unsigned bottom,
           Pixel value) {
  for (unsigned y = top; y < bottom; ++y)
    for (unsigned x = left; x < right; ++x)
      std::memcpy(&image.data[y * image.step + x * sizeof(Pixel)], &value, sizeof(Pixel));
}

TEST_F(SpotDetectorNode, BadPixelsAreMaskedCountedAndSaidAndTheSpotIsAsWithoutThem) {
  calibrate();
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  const auto clean = imageWith(99.5, 80.25, "32FC1");
  const auto spoilt = [&](unsigned left, unsigned top, unsigned right, unsigned bottom, float value) {
    auto image = clean;
    image.header.stamp += ros::Duration(1e-3 * (left + 1.0) + 1e-6 * (bottom + 1.0));
    spoil(image, left, top, right, bottom, value);
    return image;
  };
  const auto scanOfImage = [&](const sensor_msgs::Image& image) -> const sightline::SightingArray* {
    images_.publish(image);
    EXPECT_TRUE(eventually([&] { return scanOf(node_, image.header.stamp) != nullptr; }));
    return scanOf(node_, image.header.stamp);
  };
  const auto* const without = scanOfImage(clean);
  ASSERT_TRUE(without);
  ASSERT_EQ(without->sightings.size(), 1u);
  const double azimuth = without->sightings[0].azimuth, elevation = without->sightings[0].elevation;
  for (const auto& image : {spoilt(5, 5, 6, 6, nan), spoilt(7, 9, 8, 10, inf), spoilt(10, 0, 60, 40, nan)}) {
    const auto* const scan = scanOfImage(image);
    ASSERT_TRUE(scan);
    ASSERT_EQ(scan->sightings.size(), 1u);
    EXPECT_NEAR(scan->sightings[0].azimuth, azimuth, 1e-9);
    EXPECT_NEAR(scan->sightings[0].elevation, elevation, 1e-9);
  }
  EXPECT_TRUE(eventually([&] {
    return diagnosticOf("node/spot_detector", "bad pixels of the newest image, masked") == "2000" &&
           diagnosticOf("node/spot_detector", "images with bad pixels") == "3";
  }));

  auto doubles = imageWith(99.5, 80.25, "64FC1");
  spoil(doubles, 5, 5, 6, 6, std::numeric_limits<double>::quiet_NaN());
  const auto* const of_doubles = scanOfImage(doubles);
  ASSERT_TRUE(of_doubles);
  EXPECT_EQ(of_doubles->sightings.size(), 1u);

  auto blind = clean;
  blind.header.stamp = ros::Time::now();
  spoil(blind, 0, 0, kWidth, kHeight, nan);
  images_.publish(blind);
  EXPECT_TRUE(
      eventually([&] { return !diagnosticOf("node/spot_detector", "refused, no good pixel").empty(); }));
  EXPECT_EQ(scanOf(node_, blind.header.stamp), nullptr) << "it did not look, and is silent";
}

TEST_F(SpotDetectorNode, AnImageWithoutSpotsIsAnEmptyScan) {
  calibrate();
  const auto image = imageWith(-1.0, -1.0);
  images_.publish(image);
  ASSERT_TRUE(eventually([&] { return scanOf(node_, image.header.stamp) != nullptr; }));
  EXPECT_TRUE(scanOf(node_, image.header.stamp)->sightings.empty());
}

TEST_F(SpotDetectorNode, ImagesThatDoNotFitTheirCameraOrTheirEncodingAreRefused) {
  calibrate();
  auto small = imageWith(100.0, 80.0);
  small.height = kHeight / 2;
  small.data.resize(small.step * small.height);
  images_.publish(small);
  EXPECT_TRUE(eventually([&] { return !diagnosticOf("node/spot_detector", "refused, wrong size").empty(); }));
  auto strange = imageWith(100.0, 80.0);
  strange.encoding = "no_such_encoding";
  images_.publish(strange);
  EXPECT_TRUE(
      eventually([&] { return !diagnosticOf("node/spot_detector", "refused, image unusable").empty(); }));
}

TEST_F(SpotDetectorNode, WithAFieldOfViewInsteadOfACalibrationTheTrackerBehindFollowsTheSpot) {
  double u = 60.0;
  const auto publishNext = [&] { images_.publish(imageWith(u += 1.0, 100.0)); };
  const auto is_tracked = [&] {
    if (tracks_.messages().empty()) return false;
    for (const auto& track : tracks_.messages().back().tracks) {
      if (track.status == sightline::Track::CONFIRMED) return true;
    }
    return false;
  };
  EXPECT_TRUE(eventually(is_tracked, publishNext, ros::WallDuration(0.03)));
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "spot_detector_node_test");
  ros::NodeHandle keeps_ros_running;
  return RUN_ALL_TESTS();
}
