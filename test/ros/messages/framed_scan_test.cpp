#include "sightline/ros/messages/framed_scan.h"

#include <boost/make_shared.hpp>
#include <cmath>

#include <gtest/gtest.h>

#include "sightline/core/model/sphere.h"

#include "support/scans.h"

namespace {

namespace core = sightline::core;
using sightline_ros::FramedScan;
using sightline_ros::framedScan;
using sightline_ros::refusedScan;

sightline::SightingArray::Ptr sharedScan(const std::vector<std::pair<double, double>>& angles) {
  return boost::make_shared<sightline::SightingArray>(scanOf("eye", 10.0, angles));
}

TEST(FramedScan, SightingsKeepTheirOrderAndThoseThatCannotBeUsedAreMarked) {
  const FramedScan framed =
      framedScan(sharedScan({{0.1, 0.2}, {std::nan(""), 0.0}, {0.3, 0.0}}), std::nullopt, std::nullopt);
  EXPECT_FALSE(framed.refusal);
  ASSERT_EQ(framed.scan.sightings.size(), 3u);
  ASSERT_EQ(framed.rejections.size(), 1u);
  EXPECT_EQ(framed.rejections[0].first, 1u);
  EXPECT_TRUE(framed.scan.sightings[1].covariance.hasNaN());
  EXPECT_NEAR(core::anglesOf(framed.scan.sightings[2].direction).x(), 0.3, 1e-12);
}

TEST(FramedScan, AnglesThatAreRoundedBeyondTheEndOfTheirRangeAreTaken) {
  const FramedScan framed = framedScan(sharedScan({{static_cast<float>(2.0 * core::kPi), 0.2},
                                                   {0.1, static_cast<float>(0.5 * core::kPi)},
                                                   {0.1, -1.570796327}}),
                                       std::nullopt, std::nullopt);
  EXPECT_TRUE(framed.rejections.empty());
  ASSERT_EQ(framed.scan.sightings.size(), 3u);
  EXPECT_NEAR(core::anglesOf(framed.scan.sightings[0].direction).x(), 0.0, 1e-6);
  EXPECT_NEAR(framed.scan.sightings[1].direction.z(), 1.0, 1e-12);
  EXPECT_NEAR(framed.scan.sightings[2].direction.z(), -1.0, 1e-12);
}

TEST(FramedScan, UncertaintyOfTheAttitudeWidensTurnedSightings) {
  sightline_ros::Turn turn;
  turn.R_tracking_sensor.setIdentity();
  turn.attitude_covariance = 9e-6 * Eigen::Matrix3d::Identity();
  const FramedScan framed = framedScan(sharedScan({{0.0, 0.0}}), turn, std::nullopt);
  EXPECT_NEAR(core::anglesCovariance(framed.scan.sightings.at(0))(0, 0), 1e-6 + 9e-6, 1e-12);
}

TEST(FramedScan, WithNothingUsableItIsRefusedAndAnEmptyOneIsNot) {
  EXPECT_EQ(framedScan(sharedScan({{std::nan(""), 0.0}}), std::nullopt, std::nullopt).refusal.value().kind,
            "no usable sighting");
  EXPECT_FALSE(framedScan(sharedScan({}), std::nullopt, std::nullopt).refusal);
}

TEST(FramedScan, RefusedScanKeepsItsTimeAndItsSensor) {
  const FramedScan refused = refusedScan(sharedScan({{0.1, 0.2}}), {"late", "by 2 s"});
  EXPECT_EQ(refused.scan.sensor, "eye");
  EXPECT_EQ(refused.scan.time, core::Time(std::chrono::seconds(10)));
  EXPECT_TRUE(refused.scan.sightings.empty());
  EXPECT_EQ(core::textOf(refused.refusal.value()), "late: by 2 s");
}

TEST(FramedScan, HeadersAreRefusedByKind) {
  sightline::SightingArray scan = scanOf("eye", 10.0, {});
  EXPECT_FALSE(sightline_ros::refusalOf(scan));
  scan.sensor.clear();
  EXPECT_EQ(sightline_ros::refusalOf(scan).value().kind, "no sensor name");
  scan.header.stamp = ros::Time();
  EXPECT_EQ(sightline_ros::refusalOf(scan).value().kind, "no stamp");
}

}  // namespace
