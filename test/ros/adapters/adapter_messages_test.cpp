// Every kind of message to sightings, good and bad.
#include "sightline/ros/adapters/adapter_messages.h"

#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <ros/message_traits.h>
#include <ros/serialization.h>
#include <sensor_msgs/point_cloud2_iterator.h>
#include <sightline/TrackArray.h>

#include "sightline/core/model/sphere.h"

#include "support/scratch_folder.h"

namespace sightline_ros {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
const ros::Time kStamp(100, 250000000);
const ros::Time kArrival(101, 0);

/// The one entry of a configuration.
AdapterTopic topicOf(const std::string& type, const std::string& keys) {
  const ScratchFolder folder;
  const ParamReader reader = ParamReader::fromYaml(
      folder.write("adapter.yaml", "topics: [{topic: /in, sensor: s, type: " + type + ", " + keys + "}]"));
  const auto topics = loadAdapterTopics(reader);
  reader.finish();
  return topics.front();
}

template <typename Message>
Message stamped(const std::string& frame = "base") {
  Message message;
  message.header.stamp = kStamp;
  message.header.frame_id = frame;
  return message;
}

PixelRays camera() {
  sensor_msgs::CameraInfo info =
      pinholeCamera(640, 512, {24.0 * sightline::core::kDegree, 19.0 * sightline::core::kDegree});
  info.header.frame_id = "camera_optical";
  info.header.stamp = kStamp;
  return PixelRays(info, false);
}

template <typename Message>
AdaptedScan adapt(const Message& message, const AdapterTopic& topic, const PixelRays* rays = nullptr) {
  return adapt(read(message, topic, rays), topic, kArrival);
}

void expectRefused(const AdaptedScan& adapted, const std::string& reason, const std::string& part_of_detail) {
  EXPECT_FALSE(adapted.scan);
  ASSERT_FALSE(adapted.refusals.empty());
  EXPECT_EQ(adapted.refusals[0].kind, reason);
  EXPECT_NE(adapted.refusals[0].detail.find(part_of_detail), std::string::npos) << adapted.refusals[0].detail;
  EXPECT_NE(adapted.refusals[0].detail.find("/in"), std::string::npos) << "names the topic";
}

TEST(AdapterMessages, ADirectionOfAnyLengthBecomesASightingWithTheConfiguredSigma) {
  auto message = stamped<geometry_msgs::Vector3Stamped>();
  message.vector.x = message.vector.y = 250.0;
  const auto topic =
      topicOf("geometry_msgs/Vector3Stamped",
              "sigma: [0.002, 0.001], ifov: 0.0005, stamp_offset: -0.25, detection_probability: 0.9");
  const auto scan = adapt(message, topic).scan;
  ASSERT_TRUE(scan);
  EXPECT_EQ(scan->header.frame_id, "base");
  EXPECT_EQ(scan->header.stamp, ros::Time(100, 0));
  EXPECT_EQ(scan->sensor, "s");
  EXPECT_EQ(scan->ifov, 0.0005);
  EXPECT_EQ(scan->detection_probability, 0.9);
  EXPECT_TRUE(std::isnan(scan->clutter_density));
  ASSERT_EQ(scan->sightings.size(), 1u);
  EXPECT_NEAR(scan->sightings[0].azimuth, 45.0 * sightline::core::kDegree, 1e-12);
  EXPECT_NEAR(scan->sightings[0].elevation, 0.0, 1e-12);
  EXPECT_NEAR(scan->sightings[0].covariance[0], 4e-6, 1e-12);
  EXPECT_NEAR(scan->sightings[0].covariance[3], 1e-6, 1e-12);
  EXPECT_TRUE(std::isnan(scan->sightings[0].snr));
}

TEST(AdapterMessages, AVectorThatPointsNowhereIsRefused) {
  const auto topic = topicOf("geometry_msgs/Vector3Stamped", "sigma: [0.002, 0.001]");
  auto message = stamped<geometry_msgs::Vector3Stamped>();
  expectRefused(adapt(message, topic), "no direction", "(0, 0, 0) points nowhere");
  message.vector.z = kNaN;
  expectRefused(adapt(message, topic), "no direction", "(0, 0, nan) points nowhere");
}

TEST(AdapterMessages, EmptyFramesAndStampsAreRefusedUnlessTheConfigurationHelps) {
  auto message = stamped<geometry_msgs::Vector3Stamped>("");
  message.vector.x = 1.0;
  const std::string sigma = "sigma: [0.002, 0.001]";
  expectRefused(adapt(message, topicOf("geometry_msgs/Vector3Stamped", sigma)), "no frame", "set frame");
  const auto with_frame = topicOf("geometry_msgs/Vector3Stamped", sigma + ", frame: mast");
  EXPECT_EQ(adapt(message, with_frame).scan->header.frame_id, "mast");
  message.header.stamp = ros::Time();
  expectRefused(adapt(message, with_frame), "no stamp", "set stamp: arrival");
  const auto on_arrival =
      topicOf("geometry_msgs/Vector3Stamped", sigma + ", frame: mast, stamp: arrival, stamp_offset: -0.5");
  EXPECT_EQ(adapt(message, on_arrival).scan->header.stamp, ros::Time(100, 500000000));
}

TEST(AdapterMessages, PositionsAreSeenFromTheOriginOfTheirFrame) {
  auto pose = stamped<geometry_msgs::PoseStamped>();
  pose.pose.position.y = -20.0;
  pose.pose.position.z = 20.0;
  const auto of_pose = adapt(pose, topicOf("geometry_msgs/PoseStamped", "sigma: [0.001, 0.001]")).scan;
  EXPECT_NEAR(of_pose->sightings.at(0).azimuth, -90.0 * sightline::core::kDegree, 1e-12);
  EXPECT_NEAR(of_pose->sightings.at(0).elevation, 45.0 * sightline::core::kDegree, 1e-12);

  auto point = stamped<geometry_msgs::PointStamped>();
  point.point.y = 3.0;
  const auto of_point = adapt(point, topicOf("geometry_msgs/PointStamped", "sigma: [0.001, 0.001]")).scan;
  EXPECT_NEAR(of_point->sightings.at(0).azimuth, 90.0 * sightline::core::kDegree, 1e-12);

  auto poses = stamped<geometry_msgs::PoseArray>();
  const auto topic = topicOf("geometry_msgs/PoseArray", "sigma: [0.001, 0.001]");
  ASSERT_TRUE(adapt(poses, topic).scan) << "an empty array means: looked, and saw nothing";
  EXPECT_TRUE(adapt(poses, topic).scan->sightings.empty());
  poses.poses.resize(3);
  poses.poses[0].position.x = poses.poses[2].position.y = 1.0;  // the second one is at the origin
  EXPECT_EQ(adapt(poses, topic).scan->sightings.size(), 2u);
  EXPECT_EQ(adapt(poses, topic).refusals.size(), 1u);
}

TEST(AdapterMessages, AScanOfWhichNothingCanBeUsedIsSilentAndNotEmpty) {
  auto poses = stamped<geometry_msgs::PoseArray>();
  poses.poses.resize(2);
  const auto adapted = adapt(poses, topicOf("geometry_msgs/PoseArray", "sigma: [0.001, 0.001]"));
  EXPECT_FALSE(adapted.scan);
  EXPECT_EQ(adapted.refusals.size(), 2u);
}

TEST(AdapterMessages, AnOpticalFrameIsTurnedIntoItsBoresightFrame) {
  auto message = stamped<geometry_msgs::PointStamped>("stereo_optical");
  message.point.x = -1.0;  // left
  message.point.z = 1.0;
  const auto adapted =
      adapt(message, topicOf("geometry_msgs/PointStamped", "sigma: [0.001, 0.001], optical: true"));
  EXPECT_EQ(adapted.optical_frame, "stereo_optical");
  EXPECT_EQ(adapted.scan->header.frame_id, "stereo_optical_boresight");
  EXPECT_NEAR(adapted.scan->sightings.at(0).azimuth, 45.0 * sightline::core::kDegree, 1e-12);
}

TEST(AdapterMessages, APosesCovarianceCountsAcrossTheLineOfSight) {
  auto message = stamped<geometry_msgs::PoseWithCovarianceStamped>();
  message.pose.pose.position.x = 100.0;
  message.pose.covariance[0] = 900.0;  // along the line of sight
  message.pose.covariance[7] = 4.0;
  message.pose.covariance[14] = 1.0;
  const auto topic = topicOf("geometry_msgs/PoseWithCovarianceStamped", "stamp: header");
  const auto scan = adapt(message, topic).scan;
  EXPECT_NEAR(scan->sightings.at(0).covariance[0], 4e-4, 1e-12);
  EXPECT_NEAR(scan->sightings.at(0).covariance[3], 1e-4, 1e-12);

  nav_msgs::Odometry odometry;
  odometry.header = message.header;
  odometry.pose = message.pose;
  const auto same = adapt(odometry, topicOf("nav_msgs/Odometry", "stamp: header")).scan;
  EXPECT_EQ(same->sightings.at(0).covariance, scan->sightings.at(0).covariance);
}

TEST(AdapterMessages, ACovarianceThatSaysNothingIsReplacedByTheSigmaOrRefused) {
  auto message = stamped<nav_msgs::Odometry>();
  message.pose.pose.position.x = 100.0;
  for (const double variance : {0.0, -1.0, kNaN}) {
    message.pose.covariance[0] = message.pose.covariance[7] = message.pose.covariance[14] = variance;
    const auto topic = topicOf("nav_msgs/Odometry", "sigma: [0.002, 0.001]");
    const Reading reading = read(message, topic, nullptr);
    EXPECT_EQ(reading.unknown_covariances, 1u) << variance;
    EXPECT_NE(reading.first_unknown.find("variances ("), std::string::npos);
    EXPECT_NEAR(adapt(reading, topic, kArrival).scan->sightings.at(0).covariance[0], 4e-6, 1e-12);
    expectRefused(adapt(message, topicOf("nav_msgs/Odometry", "stamp: header")), "covariance not known",
                  "set sigma [rad]");
  }
}

TEST(AdapterMessages, PixelsGoThroughTheCamera) {
  const PixelRays rays = camera();
  auto message = stamped<geometry_msgs::PointStamped>("");
  message.point.x = 319.5 - 100.0;
  message.point.y = 255.5;
  const auto topic =
      topicOf("geometry_msgs/PointStamped", "camera_info: /camera/camera_info, sigma_px: [0.5, 0.5]");
  const auto adapted = adapt(message, topic, &rays);
  ASSERT_TRUE(adapted.scan);
  EXPECT_EQ(adapted.scan->header.frame_id, "camera_optical_boresight");
  const double focal_length = 320.0 / std::tan(12.0 * sightline::core::kDegree);
  EXPECT_NEAR(adapted.scan->sightings.at(0).azimuth, std::atan(100.0 / focal_length), 1e-9);
  EXPECT_NEAR(adapted.scan->sightings.at(0).elevation, 0.0, 1e-9);
  const double cosine = std::cos(adapted.scan->sightings[0].azimuth);
  EXPECT_NEAR(std::sqrt(adapted.scan->sightings[0].covariance[0]), 0.5 / focal_length * cosine * cosine,
              1e-9);

  expectRefused(adapt(message, topic, nullptr), "no calibration",
                "no usable CameraInfo has come on /camera/");
  message.point.x = 700.0;
  expectRefused(adapt(message, topic, &rays), "off the image",
                "pixel (700, 255.5) is not on the image of 640x512");
}

TEST(AdapterMessages, ABoxIsSeenAtItsMiddleAndWithoutAreaItIsNothing) {
  const PixelRays rays = camera();
  sensor_msgs::RegionOfInterest box;
  const auto topic =
      topicOf("sensor_msgs/RegionOfInterest", "camera_info: /camera/camera_info, sigma_px: [2.0, 2.0]");
  ASSERT_TRUE(adapt(box, topic, &rays).scan);
  EXPECT_TRUE(adapt(box, topic, &rays).scan->sightings.empty());
  box.x_offset = 310;
  box.width = 20;  // columns 310 to 329: the middle of the image
  box.y_offset = 251;
  box.height = 10;
  const auto scan = adapt(box, topic, &rays).scan;
  EXPECT_EQ(scan->header.stamp, kStamp) << "the CameraInfo's: the message has none";
  EXPECT_NEAR(scan->sightings.at(0).azimuth, 0.0, 1e-9);
  EXPECT_NEAR(scan->sightings.at(0).elevation, 0.0, 1e-9);
  expectRefused(adapt(box, topic, nullptr), "no calibration", "no usable CameraInfo");
}

/// Columns of floats, points of rows.
sensor_msgs::PointCloud2 cloudOf(const std::vector<std::string>& names,
                                 const std::vector<std::vector<float>>& points) {
  auto cloud = stamped<sensor_msgs::PointCloud2>();
  for (const std::string& name : names) {
    sensor_msgs::PointField field;
    field.name = name;
    field.offset = static_cast<std::uint32_t>(4 * cloud.fields.size());
    field.datatype = sensor_msgs::PointField::FLOAT32;
    field.count = 1;
    cloud.fields.push_back(field);
  }
  cloud.height = 1;
  cloud.width = static_cast<std::uint32_t>(points.size());
  cloud.point_step = static_cast<std::uint32_t>(4 * names.size());
  cloud.row_step = cloud.width * cloud.point_step;
  cloud.is_dense = true;
  cloud.data.resize(cloud.row_step);
  for (std::size_t i = 0; i < points.size(); ++i)
    std::memcpy(&cloud.data[i * cloud.point_step], points[i].data(), cloud.point_step);
  return cloud;
}

TEST(AdapterMessages, ARadarsCloudIsReadInItsUnitsWithItsVarianceAndSnr) {
  const auto topic =
      topicOf("sensor_msgs/PointCloud2",
              "azimuth: {field: az, unit: deg, sign: -1, variance: az_var}, "
              "elevation: {field: el, unit: mrad, sigma: el_sigma}, snr: {field: snr, unit: dB}");
  const auto scan = adapt(cloudOf({"az", "el", "az_var", "el_sigma", "snr"},
                                  {{30.0F, 100.0F, 0.25F, 2.0F, 20.0F}, {-60.0F, -50.0F, 1.0F, 1.0F, 6.0F}}),
                          topic)
                        .scan;
  ASSERT_EQ(scan->sightings.size(), 2u);
  EXPECT_NEAR(scan->sightings[0].azimuth, -30.0 * sightline::core::kDegree, 1e-7);
  EXPECT_NEAR(scan->sightings[0].elevation, 0.1, 1e-7);
  EXPECT_NEAR(std::sqrt(scan->sightings[0].covariance[0]), 0.5 * sightline::core::kDegree, 1e-7);
  EXPECT_NEAR(std::sqrt(scan->sightings[0].covariance[3]), 0.002, 1e-7);
  EXPECT_NEAR(scan->sightings[0].snr, 10.0, 1e-6);
  EXPECT_NEAR(scan->sightings[1].azimuth, 60.0 * sightline::core::kDegree, 1e-7);
}

TEST(AdapterMessages, DegreesThatPassForRadiansAreRefusedWithTheRemedy) {
  const auto topic =
      topicOf("sensor_msgs/PointCloud2", "azimuth: {field: az}, elevation: {field: el}, sigma: [0.01, 0.01]");
  expectRefused(adapt(cloudOf({"az", "el"}, {{30.0F, 0.5F}}), topic), "angle out of range", "unit: deg");
  expectRefused(adapt(cloudOf({"az", "el"}, {{0.5F, 3.0F}}), topic), "angle out of range", "unit: deg");
}

TEST(AdapterMessages, MissingReturnsOfAnOrganizedCloudAreLeftOutButNotANumberInADenseOneIsRefused) {
  const auto topic = topicOf("sensor_msgs/PointCloud2", "sigma: [0.01, 0.01]");
  const float nan = std::numeric_limits<float>::quiet_NaN();
  auto cloud = cloudOf({"x", "y", "z"}, {{1.0F, 0.0F, 0.0F}, {nan, nan, nan}, {0.0F, 1.0F, 0.0F}});
  EXPECT_EQ(adapt(cloud, topic).refusals.size(), 1u);
  cloud.is_dense = false;
  EXPECT_EQ(adapt(cloud, topic).refusals.size(), 0u);
  EXPECT_EQ(adapt(cloud, topic).scan->sightings.size(), 2u);
}

TEST(AdapterMessages, CloudsThatLieAboutTheirSizeOrLackAFieldAreRefused) {
  const auto topic = topicOf("sensor_msgs/PointCloud2", "sigma: [0.01, 0.01]");
  auto cloud = cloudOf({"x", "y", "z"}, {{1.0F, 0.0F, 0.0F}});
  cloud.width = 1000;
  expectRefused(adapt(cloud, topic), "malformed", "do not agree");
  expectRefused(adapt(cloudOf({"x", "y"}, {{1.0F, 0.0F}}), topic), "malformed",
                "field \"z\" does not exist: the cloud has x, y");
  auto outside = cloudOf({"x", "y", "z"}, {{1.0F, 0.0F, 0.0F}});
  outside.fields[2].offset = 10;
  expectRefused(adapt(outside, topic), "malformed", "does not lie within its points");
}

TEST(AdapterMessages, ALidarsCloudIsNoListOfDetections) {
  const auto topic = topicOf("sensor_msgs/PointCloud2", "sigma: [0.01, 0.01], max_sightings: 100");
  const std::vector<std::vector<float>> points(101, {1.0F, 0.0F, 0.0F});
  expectRefused(adapt(cloudOf({"x", "y", "z"}, points), topic), "too many sightings", "max_sightings 100");
}

TEST(AdapterMessages, ALaserScannerSeesSmallThingsAtTheMiddleOfItsSweep) {
  auto scan = stamped<sensor_msgs::LaserScan>("laser");
  scan.angle_min = -1.0F;
  scan.angle_increment = 0.01F;
  scan.time_increment = 0.001F;
  scan.range_max = 50.0F;
  scan.ranges.assign(201, 20.0F);  // a wall
  for (int k = 149; k <= 151; ++k) scan.ranges[static_cast<std::size_t>(k)] = 8.0F;
  const auto adapted = adapt(scan, topicOf("sensor_msgs/LaserScan", "sigma: [0.002, 0.1]"));
  ASSERT_EQ(adapted.scan->sightings.size(), 1u);
  EXPECT_NEAR(adapted.scan->sightings[0].azimuth, 0.5, 1e-6);
  EXPECT_EQ(adapted.scan->sightings[0].elevation, 0.0);
  EXPECT_NEAR(adapted.scan->sightings[0].covariance[0], 4e-6 + 0.03 * 0.03 / 12.0, 1e-9);
  EXPECT_NEAR(adapted.scan->sightings[0].covariance[3], 0.01, 1e-12);
  EXPECT_NEAR((adapted.scan->header.stamp - kStamp).toSec(), 0.1, 1e-6);
  scan.angle_increment = 0.0F;
  expectRefused(adapt(scan, topicOf("sensor_msgs/LaserScan", "sigma: [0.002, 0.1]")), "malformed",
                "angle_increment 0");
}

/// Reads any message as one that this program was not built with.
template <typename Message>
AdaptedScan adaptAny(const Message& message, const AdapterTopic& topic, const PixelRays* rays = nullptr) {
  std::vector<std::uint8_t> bytes(ros::serialization::serializationLength(message));
  ros::serialization::OStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  ros::serialization::serialize(stream, message);
  const MessageLayout layout(ros::message_traits::datatype<Message>(),
                             ros::message_traits::definition<Message>());
  return adapt(read({bytes.data(), bytes.size()}, layout, topic, rays), topic, kArrival);
}

TEST(AdapterMessages, AnyMessageIsReadByFieldPaths) {
  auto message = stamped<sightline::TrackArray>("radar");
  message.tracks.resize(2);
  message.tracks[0].azimuth = 30.0;  // taken for a compass bearing in degrees
  message.tracks[0].elevation = 50.0;
  message.tracks[0].covariance[0] = 2.0;
  message.tracks[0].existence = 4.0;
  message.tracks[1].azimuth = 350.0;
  message.tracks[1].covariance[0] = 1.0;
  const auto topic = topicOf(
      "sightline/TrackArray",
      "each: tracks, azimuth: {field: azimuth, unit: deg, sign: -1, offset: deg(90.0), sigma: "
      "'covariance[0]'}, "
      "elevation: {field: elevation, unit: mrad, sign: -1}, snr: {field: existence}, sigma: [0.1, 0.02]");
  const auto scan = adaptAny(message, topic).scan;
  ASSERT_TRUE(scan);
  EXPECT_EQ(scan->header.frame_id, "radar");
  EXPECT_EQ(scan->header.stamp, kStamp);
  ASSERT_EQ(scan->sightings.size(), 2u);
  EXPECT_NEAR(scan->sightings[0].azimuth, 60.0 * sightline::core::kDegree, 1e-12);
  EXPECT_NEAR(scan->sightings[0].elevation, -0.05, 1e-12);
  EXPECT_NEAR(std::sqrt(scan->sightings[0].covariance[0]), 2.0 * sightline::core::kDegree, 1e-9);
  EXPECT_NEAR(std::sqrt(scan->sightings[0].covariance[3]), 0.02, 1e-9);
  EXPECT_EQ(scan->sightings[0].snr, 4.0);
  EXPECT_NEAR(scan->sightings[1].azimuth, 100.0 * sightline::core::kDegree, 1e-12);
}

TEST(AdapterMessages, APathThatDoesNotExistIsRefusedWithWhatThereIs) {
  const auto topic =
      topicOf("sightline/TrackArray", "each: tracks, azimuth: {field: bearing}, sigma: [0.1, 0.02]");
  auto message = stamped<sightline::TrackArray>();
  message.tracks.resize(1);
  try {
    adaptAny(message, topic);
    FAIL() << "a path that does not exist was read";
  } catch (const FieldError& error) {
    EXPECT_NE(
        std::string(error.what()).find("field \"bearing\" does not exist: sightline/Track has id, status"),
        std::string::npos)
        << error.what();
  }
}

TEST(AdapterMessages, AnyMessageMayHoldPixels) {
  const PixelRays rays = camera();
  auto message = stamped<geometry_msgs::PoseArray>("");
  message.poses.resize(1);
  message.poses[0].position.x = 319.5;
  message.poses[0].position.y = 255.5 - 50.0;
  AdapterTopic topic = topicOf("acme/Detections",
                               "each: poses, u: {field: position.x}, v: {field: position.y}, "
                               "camera_info: /c, sigma_px: [0.5, 0.5]");
  const auto scan = adaptAny(message, topic, &rays).scan;
  ASSERT_TRUE(scan);
  EXPECT_EQ(scan->header.frame_id, "camera_optical_boresight");
  EXPECT_NEAR(scan->sightings.at(0).azimuth, 0.0, 1e-9);
  EXPECT_GT(scan->sightings.at(0).elevation, 0.0);
}

const std::string kCompass =
    "azimuth: {field: az, unit: deg, offset: deg(180.0)}, elevation: {field: el, unit: deg}, sigma: [0.02, "
    "0.05]";

TEST(AdapterMessages, AnOffsetTurnsTheAzimuthRoundTheCircle) {
  for (const auto& [field, azimuth] :
       {std::pair{200.0F, 20.0}, {10.0F, -170.0}, {350.0F, 170.0}, {-200.0F, -20.0}, {0.0F, 180.0}}) {
    const auto scan =
        adapt(cloudOf({"az", "el"}, {{field, 5.0F}}), topicOf("sensor_msgs/PointCloud2", kCompass));
    ASSERT_TRUE(scan.scan) << field;
    EXPECT_NEAR(std::abs(sightline::core::wrapAngle(scan.scan->sightings.at(0).azimuth -
                                                    azimuth * sightline::core::kDegree)),
                0.0, 1e-12)
        << field;
  }
  // What is no azimuth before the offset does not become one by it.
  expectRefused(adapt(cloudOf({"az"}, {{200.0F}}),
                      topicOf("sensor_msgs/PointCloud2",
                              "azimuth: {field: az, offset: deg(180.0)}, sigma: [0.1, 0.1]")),
                "angle out of range", "direction (200, 0)");
}

TEST(AdapterMessages, AnOffsetTurnsTheAzimuthOfFieldPathsToo) {
  auto message = stamped<sightline::TrackArray>();
  message.tracks.resize(1);
  message.tracks[0].azimuth = 200.0;
  const auto topic =
      topicOf("sightline/TrackArray",
              "each: tracks, azimuth: {field: azimuth, unit: deg, offset: deg(180.0)}, sigma: [0.1, 0.02]");
  EXPECT_NEAR(adaptAny(message, topic).scan->sightings.at(0).azimuth, 20.0 * sightline::core::kDegree, 1e-12);
}

TEST(AdapterMessages, AnglesThatAreRoundedBeyondTheEndOfTheirRangeAreTaken) {
  const auto topic =
      topicOf("sensor_msgs/PointCloud2", "azimuth: {field: az}, elevation: {field: el}, sigma: [0.01, 0.01]");
  const auto kPi = sightline::core::kPi;
  const auto cloud = cloudOf({"az", "el"}, {{static_cast<float>(2.0 * kPi), 0.5F},
                                            {0.5F, static_cast<float>(0.5 * kPi)},
                                            {0.5F, static_cast<float>(-0.5 * kPi)}});
  const auto adapted = adapt(cloud, topic);
  EXPECT_TRUE(adapted.refusals.empty()) << adapted.refusals.front().detail;
  ASSERT_EQ(adapted.scan->sightings.size(), 3u);
  EXPECT_NEAR(sightline::core::wrapAngle(adapted.scan->sightings[0].azimuth), 0.0, 1e-6);
  EXPECT_NEAR(adapted.scan->sightings[1].elevation, 0.5 * kPi, 1e-12);
  EXPECT_NEAR(adapted.scan->sightings[2].elevation, -0.5 * kPi, 1e-12);

  auto message = stamped<sightline::TrackArray>();
  message.tracks.resize(1);
  message.tracks[0].elevation = 1.570796327;
  const auto any = topicOf("sightline/TrackArray",
                           "each: tracks, azimuth: {field: azimuth}, elevation: {field: elevation}, sigma: "
                           "[0.01, 0.01]");
  EXPECT_NEAR(adaptAny(message, any).scan->sightings.at(0).elevation, 0.5 * kPi, 1e-12);
}

/// Standard deviations of azimuth and elevation [deg].
Eigen::Vector2d sigmasOf(const sightline::Sighting& sighting) {
  return Eigen::Vector2d(std::sqrt(sighting.covariance[0]), std::sqrt(sighting.covariance[3])) /
         sightline::core::kDegree;
}

TEST(AdapterMessages, TheConfiguredSigmaIsAnArcAlsoWhereTheOtherAxisStatesItsOwn) {
  const auto topic =
      topicOf("sensor_msgs/PointCloud2",
              "azimuth: {field: az, unit: deg}, elevation: {field: el, unit: deg, sigma: el_s}, "
              "sigma: [0.02, 0.05]");
  const auto scan =
      adapt(cloudOf({"az", "el", "el_s"}, {{10.0F, 80.0F, 1.0F}, {10.0F, 0.0F, 1.0F}}), topic).scan;
  ASSERT_EQ(scan->sightings.size(), 2u);
  EXPECT_NEAR(sigmasOf(scan->sightings[0]).x(), 6.599, 5e-4) << "0.02 rad / cos(80 deg)";
  EXPECT_NEAR(sigmasOf(scan->sightings[0]).y(), 1.0, 1e-6);
  EXPECT_NEAR(sigmasOf(scan->sightings[1]).x(), 1.146, 5e-4);

  auto message = stamped<sightline::TrackArray>();
  message.tracks.resize(1);
  message.tracks[0].elevation = 80.0;
  message.tracks[0].existence = 1.0;
  const auto any =
      topicOf("sightline/TrackArray",
              "each: tracks, azimuth: {field: azimuth, unit: deg}, elevation: {field: elevation, "
              "unit: deg, sigma: existence}, sigma: [0.02, 0.05]");
  EXPECT_NEAR(sigmasOf(adaptAny(message, any).scan->sightings.at(0)).x(), 6.599, 5e-4);
}

TEST(AdapterMessages, AVarianceThatStandsForUnknownHasTheConfiguredSigmaOfItsAxis) {
  for (const std::string unit : {"deg", "rad", "mrad"}) {
    const auto topic =
        topicOf("sensor_msgs/PointCloud2", "azimuth: {field: az, unit: " + unit +
                                               ", variance: az_v}, elevation: {field: el, unit: " + unit +
                                               ", variance: el_v}, sigma: [0.02, 0.05]");
    const double one = unit == "deg" ? sightline::core::kDegree : unit == "rad" ? 1.0 : 1e-3;
    for (const float unknown :
         {1e6F, 999999.0F, 99999.0F, 1e9F, 0.0F, -1.0F, std::numeric_limits<float>::infinity()}) {
      const auto cloud =
          cloudOf({"az", "el", "az_v", "el_v"}, {{0.5F, 0.0F, unknown, 0.25F}, {0.5F, 0.0F, 0.25F, unknown}});
      const Reading reading = read(cloud, topic, nullptr);
      EXPECT_EQ(reading.unknown_covariances, 2u);
      const auto scan = adapt(reading, topic, kArrival).scan;
      ASSERT_TRUE(scan) << unit << ", " << unknown;
      ASSERT_EQ(scan->sightings.size(), 2u);
      EXPECT_NEAR(std::sqrt(scan->sightings[0].covariance[0]), 0.02, 1e-6) << unit << ", " << unknown;
      EXPECT_NEAR(std::sqrt(scan->sightings[0].covariance[3]), 0.5 * one, 1e-6);
      EXPECT_NEAR(std::sqrt(scan->sightings[1].covariance[0]), 0.5 * one, 1e-6);
      EXPECT_NEAR(std::sqrt(scan->sightings[1].covariance[3]), 0.05, 1e-6);
    }
  }
}

TEST(AdapterMessages, OfAPositionAnUnknownAxisHasTheConfiguredSigmaAtItsDistance) {
  auto message = stamped<nav_msgs::Odometry>();
  message.pose.pose.position.x = 100.0;
  const auto topic = topicOf("nav_msgs/Odometry", "sigma: [0.02, 0.05]");
  for (const double unknown : {1e6, 999999.0, 1e9, kNaN}) {
    message.pose.covariance[0] = 900.0;
    message.pose.covariance[7] = 4.0;
    message.pose.covariance[14] = unknown;  // upright
    const Reading reading = read(message, topic, nullptr);
    EXPECT_EQ(reading.unknown_covariances, 1u) << unknown;
    const auto scan = adapt(reading, topic, kArrival).scan;
    ASSERT_TRUE(scan) << unknown;
    EXPECT_NEAR(std::sqrt(scan->sightings.at(0).covariance[0]), 2.0 / 100.0, 1e-9) << unknown;
    EXPECT_NEAR(std::sqrt(scan->sightings.at(0).covariance[3]), 0.05, 1e-9) << unknown;
  }
  // A position that is known badly, and says so by a number of its own, is not better known than that.
  message.pose.covariance[14] = 5e5;
  EXPECT_FALSE(adapt(message, topic).scan);
  // Without a sigma the axis stays unknown, which is refused.
  message.pose.covariance[14] = 1e6;
  expectRefused(adapt(message, topicOf("nav_msgs/Odometry", "stamp: header")), "covariance not known",
                "set sigma [rad]");
}

TEST(AdapterMessages, OfAPixelAnUnknownAxisHasTheConfiguredSigma) {
  const PixelRays rays = camera();
  const auto topic = topicOf("sensor_msgs/PointCloud2",
                             "u: {field: u, variance: u_v}, v: {field: v, variance: v_v}, camera_info: /c, "
                             "sigma_px: [3.0, 2.0]");
  const double focal_length = 320.0 / std::tan(12.0 * sightline::core::kDegree);
  const double focal_length_v = 256.0 / std::tan(9.5 * sightline::core::kDegree);
  const auto scan = adapt(cloudOf({"u", "v", "u_v", "v_v"},
                                  {{319.5F, 255.5F, 1e6F, 1.0F}, {319.5F, 255.5F, 1.0F, 999999.0F}}),
                          topic, &rays)
                        .scan;
  ASSERT_TRUE(scan);
  ASSERT_EQ(scan->sightings.size(), 2u);
  EXPECT_NEAR(std::sqrt(scan->sightings[0].covariance[0]), 3.0 / focal_length, 1e-9);
  EXPECT_NEAR(std::sqrt(scan->sightings[0].covariance[3]), 1.0 / focal_length_v, 1e-9);
  EXPECT_NEAR(std::sqrt(scan->sightings[1].covariance[3]), 2.0 / focal_length_v, 1e-9);
}

TEST(AdapterMessages, TheConfiguredSigmaOfAnOpticalFrameIsAlongTheBoresightsAzimuthAndElevation) {
  auto message = stamped<geometry_msgs::PointStamped>("stereo_optical");
  message.point.z = 10.0;
  const auto scan =
      adapt(message, topicOf("geometry_msgs/PointStamped", "sigma: [0.002, 0.005], optical: true")).scan;
  EXPECT_NEAR(std::sqrt(scan->sightings.at(0).covariance[0]), 0.002, 1e-9);
  EXPECT_NEAR(std::sqrt(scan->sightings.at(0).covariance[3]), 0.005, 1e-9);
}

TEST(AdapterMessages, AHeaderMayBeThatOfAnElementAndPathsMayHaveSlashes) {
  const auto with = [](const std::string& header) {
    return topicOf("sightline/TestList",
                   "each: poses, x: {field: pose.position.x}, y: {field: pose.position.y}, "
                   "z: {field: pose.position.z}, sigma: [0.1, 0.1], header: " +
                       header);
  };
  // A list of messages of which each has a header of its own: that of its definition is written out here.
  const std::string definition =
      std::string("geometry_msgs/PoseStamped[] poses\n===\nMSG: geometry_msgs/PoseStamped\n") +
      ros::message_traits::definition<geometry_msgs::PoseStamped>();
  const MessageLayout layout("sightline/TestList", definition);
  std::vector<geometry_msgs::PoseStamped> poses(2, stamped<geometry_msgs::PoseStamped>("/camera"));
  poses[0].pose.position.y = poses[1].pose.position.x = 2.0;
  const auto bytesOf = [](const auto& list) {
    std::vector<std::uint8_t> bytes(ros::serialization::serializationLength(list));
    ros::serialization::OStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
    ros::serialization::serialize(stream, list);
    return bytes;
  };
  const auto bytes = bytesOf(poses);
  for (const std::string header :
       {"poses.0.header", "'poses[0].header'", "/poses.0.header", "/poses/0/header", "poses.1.header"}) {
    const AdapterTopic topic = with(header);
    const auto adapted = adapt(read({bytes.data(), bytes.size()}, layout, topic, nullptr), topic, kArrival);
    ASSERT_TRUE(adapted.scan) << header;
    EXPECT_EQ(adapted.scan->header.stamp, kStamp) << header;
    EXPECT_EQ(adapted.scan->header.frame_id, "camera") << header << ": tf2 frames have no leading slash";
    EXPECT_EQ(adapted.scan->sightings.size(), 2u);
  }
  // An empty list has no header: then only the time of arrival tells when nothing was seen.
  const auto empty = bytesOf(std::vector<geometry_msgs::PoseStamped>());
  const AdapterTopic by_header = with("poses.0.header");
  const auto refused =
      adapt(read({empty.data(), empty.size()}, layout, by_header, nullptr), by_header, kArrival);
  expectRefused(refused, "no stamp", "set stamp: arrival");
  const AdapterTopic by_arrival = with("poses.0.header, stamp: arrival, frame: camera");
  const auto nothing =
      adapt(read({empty.data(), empty.size()}, layout, by_arrival, nullptr), by_arrival, kArrival);
  ASSERT_TRUE(nothing.scan);
  EXPECT_TRUE(nothing.scan->sightings.empty());
}

TEST(AdapterMessages, AHeaderWithALeadingSlashIsTheHeader) {
  auto message = stamped<sightline::TrackArray>("/radar");
  message.tracks.resize(1);
  const auto topic = topicOf("sightline/TrackArray",
                             "each: /tracks, header: /header, azimuth: {field: /azimuth}, sigma: [0.1, 0.1]");
  const auto scan = adaptAny(message, topic).scan;
  ASSERT_TRUE(scan);
  EXPECT_EQ(scan->header.stamp, kStamp);
  EXPECT_EQ(scan->header.frame_id, "radar");
}

TEST(AdapterMessages, FramesWithALeadingSlashAreTakenOfEveryType) {
  auto direction = stamped<geometry_msgs::Vector3Stamped>("/mast");
  direction.vector.x = 1.0;
  EXPECT_EQ(
      adapt(direction, topicOf("geometry_msgs/Vector3Stamped", "sigma: [0.1, 0.1]")).scan->header.frame_id,
      "mast");
  const auto set = topicOf("geometry_msgs/Vector3Stamped", "sigma: [0.1, 0.1], frame: /tower");
  EXPECT_EQ(adapt(direction, set).scan->header.frame_id, "tower");
}

/// The adapter's only source of corners: the fields of a cloud, or of any message.
TEST(AdapterMessages, ABoxOfCornersIsSeenAtItsMiddle) {
  const PixelRays rays = camera();
  const std::string keys =
      "xmin: {field: xmin}, xmax: {field: xmax}, ymin: {field: ymin}, ymax: {field: ymax}, camera_info: /c, "
      "sigma_px: [2.0, 2.0]";
  const auto topic = topicOf("sensor_msgs/PointCloud2", keys);
  const auto boxes = [](const std::vector<std::vector<float>>& corners) {
    return cloudOf({"xmin", "xmax", "ymin", "ymax"}, corners);
  };
  const auto scan = adapt(boxes({{310.0F, 329.0F, 251.0F, 260.0F},
                                 {319.0F, 320.0F, 255.0F, 256.0F},
                                 {5.0F, 5.0F, 7.0F, 7.0F}}),
                          topic, &rays)
                        .scan;
  ASSERT_TRUE(scan);
  ASSERT_EQ(scan->sightings.size(), 3u);
  for (int i = 0; i < 2; ++i) {
    EXPECT_NEAR(scan->sightings[std::size_t(i)].azimuth, 0.0, 1e-9);
    EXPECT_NEAR(scan->sightings[std::size_t(i)].elevation, 0.0, 1e-9);
  }
  expectRefused(adapt(boxes({{329.0F, 310.0F, 251.0F, 260.0F}}), topic, &rays), "malformed", "xmin, xmax");
  const auto unused = adapt(boxes({{0.0F, 0.0F, 0.0F, 0.0F}}), topic, &rays);
  ASSERT_TRUE(unused.scan);
  EXPECT_TRUE(unused.scan->sightings.empty());

  // Corners that count pixels from their outer borders.
  const auto shifted = topicOf("sensor_msgs/PointCloud2",
                               "xmin: {field: xmin, offset: -0.5}, xmax: {field: xmax, offset: -0.5}, ymin: "
                               "{field: ymin, offset: -0.5}, "
                               "ymax: {field: ymax, offset: -0.5}, camera_info: /c, sigma_px: [2.0, 2.0]");
  EXPECT_NEAR(adapt(boxes({{310.0F, 330.0F, 251.0F, 261.0F}}), shifted, &rays).scan->sightings.at(0).azimuth,
              0.0, 1e-9);

  // The same of a message by its definition, with whole numbers as detectors publish them.
  const MessageLayout layout("acme/Boxes",
                             "Header header\nBox[] bounding_boxes\n===\nMSG: acme/Box\n"
                             "float64 probability\nint64 xmin\nint64 ymin\nint64 xmax\nint64 "
                             "ymax\nstring Class\n===\nMSG: std_msgs/Header\nuint32 seq\ntime "
                             "stamp\nstring frame_id\n");
  std::vector<std::uint8_t> bytes(200);
  ros::serialization::OStream out(bytes.data(), 200);
  std_msgs::Header header;
  header.stamp = kStamp;
  ros::serialization::serialize(out, header);
  ros::serialization::serialize(out, std::uint32_t{1});
  ros::serialization::serialize(out, 0.9);
  for (const std::int64_t corner : {310, 251, 329, 260}) ros::serialization::serialize(out, corner);
  ros::serialization::serialize(out, std::string("drone"));
  const auto any = topicOf("acme/Boxes", "each: bounding_boxes, " + keys);
  const auto read_by_path =
      adapt(read({bytes.data(), bytes.size() - out.getLength()}, layout, any, &rays), any, kArrival);
  ASSERT_TRUE(read_by_path.scan);
  EXPECT_EQ(read_by_path.scan->header.frame_id, "camera_optical_boresight");
  EXPECT_NEAR(read_by_path.scan->sightings.at(0).azimuth, 0.0, 1e-9);
}

TEST(AdapterMessages, UnusedSlotsOfAListMeanThatNothingIsThere) {
  auto message = stamped<geometry_msgs::PoseArray>();
  message.poses.resize(4);
  const std::string keys =
      "each: poses, x: {field: position.x}, y: {field: position.y}, z: {field: position.z}, sigma: [0.1, "
      "0.1]";
  const auto topic = topicOf("acme/Sources", keys);
  const auto known = topicOf("geometry_msgs/PoseArray", "sigma: [0.1, 0.1], zeros: nothing");
  EXPECT_EQ(read(message, known, nullptr).unused_slots, 4u)
      << "of types that are known, too, where it is said";
  const auto empty = adaptAny(message, topic);
  ASSERT_TRUE(empty.scan) << "all slots unused: looked, and saw nothing";
  EXPECT_TRUE(empty.scan->sightings.empty());
  EXPECT_TRUE(empty.refusals.empty());
  message.poses[2].position.y = 1.0;
  const auto one = adaptAny(message, topic);
  ASSERT_EQ(one.scan->sightings.size(), 1u);
  EXPECT_NEAR(one.scan->sightings[0].azimuth, 90.0 * sightline::core::kDegree, 1e-12);
  EXPECT_TRUE(one.refusals.empty());
  message.poses[2].position.y = 0.0;
  expectRefused(adaptAny(message, topicOf("acme/Sources", keys + ", zeros: refused")), "no direction",
                "points nowhere");

  const auto cloud = topicOf("sensor_msgs/PointCloud2", "sigma: [0.01, 0.01]");
  const auto points = adapt(cloudOf({"x", "y", "z"}, {{0.0F, 0.0F, 0.0F}, {0.0F, 0.0F, 0.0F}}), cloud);
  ASSERT_TRUE(points.scan);
  EXPECT_TRUE(points.scan->sightings.empty());
}

TEST(AdapterMessages, AMessageWithoutHeaderNeedsFrameAndTimeOfArrival) {
  geometry_msgs::Point message;
  message.y = 2.0;
  const auto topic = topicOf("geometry_msgs/Point",
                             "x: {field: x}, y: {field: y}, z: {field: z}, sigma: [0.1, 0.1], frame: base, "
                             "stamp: arrival");
  const auto scan = adaptAny(message, topic).scan;
  ASSERT_TRUE(scan);
  EXPECT_EQ(scan->header.stamp, kArrival);
  EXPECT_NEAR(scan->sightings.at(0).azimuth, 90.0 * sightline::core::kDegree, 1e-12);
}

}  // namespace
}  // namespace sightline_ros
