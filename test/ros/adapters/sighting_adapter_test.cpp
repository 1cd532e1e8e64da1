// The sighting adapter as node and as nodelet, seen from outside.
#include <cmath>
#include <functional>
#include <nav_msgs/Odometry.h>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <diagnostic_msgs/DiagnosticArray.h>
#include <geometry_msgs/PointStamped.h>
#include <geometry_msgs/Polygon.h>
#include <geometry_msgs/Vector3Stamped.h>
#include <ros/ros.h>
#include <sensor_msgs/CameraInfo.h>
#include <sightline/SightingArray.h>
#include <sightline/TrackArray.h>
#include <tf2/buffer_core.h>
#include <tf2_msgs/TFMessage.h>

#include "sightline/core/model/sphere.h"
#include "sightline/ros/adapters/pixel_rays.h"
#include "sightline/ros/diagnosis/transform_subscriber.h"

#include "support/command.h"
#include "support/received.h"

namespace {

class SightingAdapter : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(eventually([this] {
      return bearing_.getNumSubscribers() == 1 && pixel_.getNumSubscribers() == 1 &&
             camera_info_.getNumSubscribers() == 1 && odometry_.getNumSubscribers() == 1 &&
             any_.getNumSubscribers() == 1 && nodelet_bearing_.getNumSubscribers() == 1 &&
             seeker_.publishers() == 2 && camera_.publishers() == 2 && wingman_.publishers() == 2 &&
             any_sightings_.publishers() == 1 && sources_.getNumSubscribers() == 1 &&
             rectified_.getNumSubscribers() == 1 && rectified_info_.getNumSubscribers() == 1 &&
             ears_.publishers() == 1 && rectified_sightings_.publishers() == 1;
    })) << "the nodes did not come up";
  }

  template <typename Message>
  static Message stamped(const std::string& frame) {
    Message message;
    message.header.stamp = ros::Time::now();
    message.header.frame_id = frame;
    return message;
  }

  /// The newest value under `key` in the diagnostics of the node; empty when there is none.
  std::string diagnosticOf(const std::string& key) {
    std::string newest;
    for (const auto& array : diagnostics_.messages()) {
      for (const auto& status : array.status) {
        if (status.name.find("sighting_adapter") != 0) continue;
        for (const auto& value : status.values) {
          if (value.key == key) newest = value.value;
        }
      }
    }
    return newest;
  }

  ros::NodeHandle nh_;
  ros::Publisher bearing_ = nh_.advertise<geometry_msgs::Vector3Stamped>("/bearing", 100);
  ros::Publisher nodelet_bearing_ =
      nh_.advertise<geometry_msgs::Vector3Stamped>("/seeker/line_of_sight", 100);
  ros::Publisher pixel_ = nh_.advertise<geometry_msgs::PointStamped>("/pixel", 100);
  ros::Publisher camera_info_ = nh_.advertise<sensor_msgs::CameraInfo>("/camera_info", 100);
  ros::Publisher odometry_ = nh_.advertise<nav_msgs::Odometry>("/odometry", 100);
  ros::Publisher any_ = nh_.advertise<sightline::TrackArray>("/any", 100);
  Received<sightline::SightingArray> seeker_{nh_, "/sensors/seeker/sightings"};
  Received<sightline::SightingArray> camera_{nh_, "/sensors/camera/sightings"};
  Received<sightline::SightingArray> wingman_{nh_, "/sensors/wingman/sightings"};
  Received<sightline::SightingArray> any_sightings_{nh_, "/sensors/any/sightings"};
  ros::Publisher sources_ = nh_.advertise<geometry_msgs::Polygon>("/sources", 100);
  ros::Publisher rectified_ = nh_.advertise<geometry_msgs::PointStamped>("/rectified", 100);
  ros::Publisher rectified_info_ = nh_.advertise<sensor_msgs::CameraInfo>("/rectified_info", 100);
  Received<sightline::SightingArray> ears_{nh_, "/sensors/ears/sightings"};
  Received<sightline::SightingArray> rectified_sightings_{nh_, "/sensors/rectified/sightings"};
  Received<diagnostic_msgs::DiagnosticArray> diagnostics_{nh_, "/diagnostics"};
};

TEST_F(SightingAdapter, ADriversDirectionBecomesASightingInNodeAndNodeletAlike) {
  auto message = stamped<geometry_msgs::Vector3Stamped>("mast");
  message.vector.x = message.vector.y = 1.0;
  bearing_.publish(message);
  ASSERT_TRUE(eventually([&] { return !seeker_.messages().empty(); }));
  EXPECT_EQ(seeker_.messages()[0].header.stamp, message.header.stamp);
  EXPECT_NEAR(seeker_.messages()[0].sightings.at(0).azimuth, 45.0 * sightline::core::kDegree, 1e-12);
  const std::size_t before = seeker_.messages().size();
  nodelet_bearing_.publish(message);  // the nodelet's seeker has the same output
  EXPECT_TRUE(eventually([&] { return seeker_.messages().size() > before; }));
}

TEST_F(SightingAdapter, PixelsWaitForACalibratedCameraAndTheirFrameIsOnTf) {
  auto pixel = stamped<geometry_msgs::PointStamped>("");
  pixel.point.x = 100.0;
  pixel.point.y = 255.5;
  pixel_.publish(pixel);
  EXPECT_TRUE(eventually([&] { return diagnosticOf("refused, no calibration") == "1"; }));
  sensor_msgs::CameraInfo uncalibrated;
  uncalibrated.width = 640;
  uncalibrated.height = 512;
  camera_info_.publish(uncalibrated);
  EXPECT_TRUE(eventually([&] { return diagnosticOf("refused, camera not calibrated") == "1"; }));
  EXPECT_TRUE(camera_.messages().empty());

  auto info = sightline_ros::pinholeCamera(
      640, 512, {24.0 * sightline::core::kDegree, 19.0 * sightline::core::kDegree});
  info.header.frame_id = "camera_optical";
  info.header.stamp = ros::Time::now();
  camera_info_.publish(info);
  ASSERT_TRUE(eventually([&] {
    pixel_.publish(pixel);
    return !camera_.messages().empty();
  }));
  EXPECT_EQ(camera_.messages()[0].header.frame_id, "camera_optical_boresight");
  EXPECT_GT(camera_.messages()[0].sightings.at(0).azimuth, 0.0);  // left of the middle

  tf2::BufferCore transforms;
  const sightline_ros::TransformSubscriber subscriber(nh_, transforms, [] {});
  ASSERT_TRUE(eventually([&] {
    return transforms.canTransform("camera_optical", "camera_optical_boresight", ros::Time(0));
  })) << "a listener that comes late hears it too";
  const auto turn = transforms.lookupTransform("camera_optical", "camera_optical_boresight", ros::Time(0))
                        .transform.rotation;
  // Maps x (boresight) to z (optical axis).
  EXPECT_NEAR(2.0 * (turn.x * turn.z - turn.w * turn.y), 1.0, 1e-9);
}

TEST_F(SightingAdapter, AnUnknownCovarianceIsReplacedAndCounted) {
  auto message = stamped<nav_msgs::Odometry>("base");
  message.pose.pose.position.x = 50.0;
  odometry_.publish(message);
  ASSERT_TRUE(eventually([&] { return !wingman_.messages().empty(); }));
  EXPECT_NEAR(wingman_.messages()[0].sightings.at(0).covariance[0], 4e-6, 1e-12);
  EXPECT_TRUE(eventually([&] { return diagnosticOf("wingman: covariance not known, sigma taken") == "1"; }));
}

TEST_F(SightingAdapter, AMessageReadByFieldPathsIsReadAndOneInDegreesTooManyIsRefused) {
  auto message = stamped<sightline::TrackArray>("base");
  message.tracks.resize(1);
  message.tracks[0].azimuth = 90.0;
  any_.publish(message);
  ASSERT_TRUE(eventually([&] { return !any_sightings_.messages().empty(); }));
  EXPECT_NEAR(any_sightings_.messages()[0].sightings.at(0).azimuth, 90.0 * sightline::core::kDegree, 1e-12);
  message.tracks[0].azimuth = 9000.0;
  any_.publish(message);
  EXPECT_TRUE(eventually([&] { return diagnosticOf("refused, angle out of range") == "1"; }));
  EXPECT_EQ(any_sightings_.messages().size(), 1u);
}

TEST_F(SightingAdapter, UnusedSlotsOfASoundLocaliserMeanThatNothingIsThereAndAreCounted) {
  geometry_msgs::Polygon slots;
  slots.points.resize(4);
  sources_.publish(slots);
  ASSERT_TRUE(eventually([&] { return ears_.messages().size() == 1; }));
  EXPECT_TRUE(ears_.messages()[0].sightings.empty()) << "looked, and saw nothing";
  EXPECT_EQ(ears_.messages()[0].header.frame_id, "head");
  slots.points[3].y = -1.0F;
  sources_.publish(slots);
  ASSERT_TRUE(eventually([&] { return ears_.messages().size() == 2; }));
  ASSERT_EQ(ears_.messages()[1].sightings.size(), 1u);
  EXPECT_NEAR(ears_.messages()[1].sightings[0].azimuth, -90.0 * sightline::core::kDegree, 1e-9);
  EXPECT_TRUE(eventually([&] { return diagnosticOf("ears: unused slots (zeros)") == "7"; }));
}

TEST_F(SightingAdapter, ARectifiedImageNeedsNothingButPAndOfALensThatFoldsTheShareIsSaid) {
  auto pixel = stamped<geometry_msgs::PointStamped>("");
  pixel.point.x = 900.0;
  pixel.point.y = 480.0;
  sensor_msgs::CameraInfo info;
  info.header.frame_id = "camera_optical";
  info.width = 1280;
  info.height = 960;
  info.P = {600.0, 0.0, 640.0, 0.0, 0.0, 600.0, 480.0, 0.0, 0.0, 0.0, 1.0, 0.0};
  rectified_info_.publish(info);
  ASSERT_TRUE(eventually([&] {
    rectified_.publish(pixel);
    return !rectified_sightings_.messages().empty();
  }));
  EXPECT_NEAR(rectified_sightings_.messages()[0].sightings.at(0).azimuth, -std::atan(260.0 / 600.0), 1e-9);

  info.K = {600.0, 0.0, 640.0, 0.0, 600.0, 480.0, 0.0, 0.0, 1.0};
  info.D = {-0.26, 0.075, 0.0, 0.0, -0.009};
  info.distortion_model = "plumb_bob";
  camera_info_.publish(info);
  EXPECT_TRUE(
      eventually([&] { return diagnosticOf("camera: pixels without a ray [%]").substr(0, 2) == "3."; }));
  pixel.point.x = pixel.point.y = 2.0;  // in a corner beyond the fold
  pixel_.publish(pixel);
  EXPECT_TRUE(eventually([&] { return diagnosticOf("refused, no ray") == "1"; }));
}

TEST_F(SightingAdapter, WrongConfigurationEndsTheNodeWithOneLineAndExitCodeOne) {
  const auto [code, said] = outcomeOf("rosrun sightline sighting_adapter __name:=wrong");
  EXPECT_EQ(code, 1);
  EXPECT_NE(said.find("/wrong/topics: expected a list with an entry for each topic"), std::string::npos)
      << said;
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "sighting_adapter_test");
  ros::NodeHandle keeps_ros_running;
  return RUN_ALL_TESTS();
}
