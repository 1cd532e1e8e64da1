#include "sightline/ros/adapters/adapter_reading.h"

#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "sightline/core/model/sphere.h"

namespace {

namespace core = sightline::core;
using sightline_ros::AdapterTopic;
using sightline_ros::Reading;

AdapterTopic topic() {
  AdapterTopic topic;
  topic.topic = "/driver";
  topic.sensor = "eye";
  topic.sigma = Eigen::Vector2d(2e-3, 1e-3);
  return topic;
}

std_msgs::Header header() {
  std_msgs::Header header;
  header.stamp = ros::Time(10.0);
  header.frame_id = "mast";
  return header;
}

TEST(AdapterReading, EveryRefusalNamesItsTopicAndCountsAsOffered) {
  const AdapterTopic of = topic();
  Reading reading(of, header());
  reading.addDirection({0.0, 0.0, 0.0});
  reading.addDirection({3.0, 0.0, 0.0});
  ASSERT_EQ(reading.refusals.size(), 1u);
  EXPECT_EQ(reading.refusals[0].kind, "no direction");
  EXPECT_EQ(reading.refusals[0].detail.find("topic /driver: "), 0u) << reading.refusals[0].detail;
  EXPECT_EQ(reading.offered(), 2u);
}

TEST(AdapterReading, AnglesInDegreesAreRefusedWithTheRemedy) {
  const AdapterTopic of = topic();
  Reading reading(of, header());
  reading.addAngles({90.0, 0.0}, std::nullopt);
  ASSERT_EQ(reading.refusals.size(), 1u);
  EXPECT_EQ(reading.refusals[0].kind, "angle out of range");
  EXPECT_NE(reading.refusals[0].detail.find("unit: deg"), std::string::npos);
}

TEST(AdapterReading, AnUnusableCovarianceIsReplacedByTheSigmaAndTheFirstIsKept) {
  const AdapterTopic of = topic();
  Reading reading(of, header());
  reading.addAngles({0.1, 0.2}, Eigen::Matrix2d(Eigen::Matrix2d::Zero()));
  reading.addAngles({0.1, 0.2}, Eigen::Matrix2d(Eigen::Vector2d(-1.0, 1.0).asDiagonal()));
  EXPECT_EQ(reading.unknown_covariances, 2u);
  EXPECT_EQ(reading.first_unknown, "variances (0, 0) rad^2");
  ASSERT_EQ(reading.sightings.size(), 2u);
  EXPECT_NEAR(core::anglesCovariance(reading.sightings[0])(1, 1), 1e-6, 1e-12);
}

TEST(AdapterReading, TheStampOffsetIsAddedAndOneBefore1970IsRefused) {
  AdapterTopic of = topic();
  of.stamp_offset = 0.25;
  Reading reading(of, header());
  reading.addDirection({1.0, 0.0, 0.0});
  EXPECT_EQ(adapt(reading, of, ros::Time(99.0)).scan->header.stamp, ros::Time(10.25));
  of.stamp_on_arrival = true;
  EXPECT_EQ(adapt(reading, of, ros::Time(99.0)).scan->header.stamp, ros::Time(99.25));
  of.stamp_on_arrival = false;
  of.stamp_offset = -11.0;
  const auto early = adapt(reading, of, ros::Time(99.0));
  EXPECT_FALSE(early.scan);
  EXPECT_EQ(early.refusals.back().kind, "no stamp");
}

TEST(AdapterReading, AMessageThatOffersNothingIsAnEmptyScan) {
  const AdapterTopic of = topic();
  const auto adapted = adapt(Reading(of, header()), of, ros::Time(10.0));
  ASSERT_TRUE(adapted.scan);
  EXPECT_TRUE(adapted.scan->sightings.empty());
  EXPECT_TRUE(adapted.refusals.empty());
}

TEST(AdapterReading, TooManySightingsAreNoDetections) {
  AdapterTopic of = topic();
  of.max_sightings = 2;
  Reading reading(of, header());
  for (int i = 0; i < 3; ++i) reading.addDirection({1.0, 0.1 * i, 0.0});
  const auto adapted = adapt(reading, of, ros::Time(10.0));
  EXPECT_FALSE(adapted.scan);
  EXPECT_EQ(adapted.refusals.at(0).kind, "too many sightings");
}

TEST(AdapterReading, NumbersThatDriversWriteForUnknownAreKnown) {
  for (const double marker : {99999.0, 999999.0, 1e5, 1e6, 1e9, 9999999.0, 1e12, 3.4e38}) {
    EXPECT_TRUE(sightline_ros::standsForUnknown(marker)) << marker;
  }
  for (const double variance : {0.0, -1.0, 1e-6, 1.0, 1000.0, 9999.0, 5e5, 123456.0, 999998.0}) {
    EXPECT_FALSE(sightline_ros::standsForUnknown(variance)) << variance;
  }
}

TEST(AdapterReading, NearAPoleTheConfiguredArcIsAsLongAsElsewhere) {
  const AdapterTopic of = topic();
  Reading reading(of, header());
  for (const double elevation : {0.0, 1.4, 1.57, 1.570796327}) {
    const auto sigma = reading.sigmaOfAngles(elevation);
    ASSERT_TRUE(sigma);
    EXPECT_NEAR(sigma->x() * std::max(std::cos(elevation), 1e-9), 2e-3, 1e-12) << elevation;
    EXPECT_EQ(sigma->y(), 1e-3);
    reading.addAngles({0.3, elevation}, Eigen::Matrix2d(Eigen::Vector2d(1e6, 4e-6).asDiagonal()));
  }
  ASSERT_EQ(reading.sightings.size(), 4u);
  for (const auto& sighting : reading.sightings) {
    const Eigen::Vector3d across(-std::sin(0.3), std::cos(0.3), 0.0);
    EXPECT_NEAR(std::sqrt(across.dot(sighting.covariance * across)), 2e-3, 1e-9);
  }
}

TEST(AdapterReading, ABoxWhoseCornersAreNotNumbersIsRefused) {
  AdapterTopic of = topic();
  of.sigma_px = Eigen::Vector2d(1.0, 1.0);
  of.camera_info = "/c";
  Reading reading(of, header());
  reading.addBox({0.0, Reading::kNotKnown}, {2.0, 2.0}, nullptr);
  reading.addBox({0.0, 0.0}, {2.0, 2.0}, nullptr);
  ASSERT_EQ(reading.refusals.size(), 2u);
  EXPECT_EQ(reading.refusals[0].kind, "malformed");
  EXPECT_EQ(reading.refusals[1].kind, "no calibration");
}

}  // namespace
