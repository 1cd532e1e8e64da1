#include "sightline/ros/messages/tracklet_messages.h"

#include <cmath>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "sightline/core/model/sphere.h"

#include "support/times.h"

using sightline::test::at;

namespace {

namespace core = sightline::core;

core::TrackTracklet tracklet(std::uint32_t track, double time) {
  core::TrackTracklet it;
  it.track = track;
  it.tracklet.time = at(time);
  it.tracklet.sensor = "eye";
  it.tracklet.ifov = 1e-3;
  it.tracklet.sightings = 2.5;
  Eigen::Matrix2d covariance;
  covariance << 4e-6, 1e-6, 1e-6, 2e-6;
  it.tracklet.sighting = core::sightingOf({0.4, -0.2}, covariance);
  return it;
}

core::TrackletReport report() {
  core::TrackletReport report;
  report.tracker = "left";
  report.time = at(10.0);
  report.since = at(9.5);
  report.tracklets = {tracklet(3, 9.75), tracklet(4, 9.875)};
  return report;
}

TEST(TrackletMessages, ComeBackAsTheyWere) {
  const auto message = sightline_ros::toMessage(report(), "platform_enu");
  EXPECT_EQ(message.header.frame_id, "platform_enu");
  const auto read = sightline_ros::readTracklets(message);
  EXPECT_FALSE(read.refusal);
  EXPECT_EQ(read.report.tracker, "left");
  EXPECT_EQ(read.report.time, at(10.0));
  EXPECT_EQ(read.report.since, at(9.5));
  ASSERT_EQ(read.report.tracklets.size(), 2u);
  const core::TrackTracklet& first = read.report.tracklets[0];
  EXPECT_EQ(first.track, 3u);
  EXPECT_EQ(first.tracklet.time, at(9.75));
  EXPECT_EQ(first.tracklet.sightings, 2.5);
  EXPECT_LT((core::anglesOf(first.tracklet.sighting.direction) - Eigen::Vector2d(0.4, -0.2)).norm(), 1e-12);
  EXPECT_LT((core::anglesCovariance(first.tracklet.sighting) -
             core::anglesCovariance(tracklet(3, 9.75).tracklet.sighting))
                .norm(),
            1e-15);
}

TEST(TrackletMessages, FirstReportOfATrackerHasNothingBefore) {
  core::TrackletReport first = report();
  first.since.reset();
  EXPECT_TRUE(sightline_ros::toMessage(first, "f").since.isZero());
  EXPECT_FALSE(sightline_ros::readTracklets(sightline_ros::toMessage(first, "f")).report.since);
}

TEST(TrackletMessages, VeryElongatedSightingsGoThroughAMessageWhateverTheRounding) {
  int elongated = 0;
  for (int k = 0; k < 2000; ++k) {
    const double turn = 0.0031 * k, short_sigma = std::pow(10.0, -8.5 + 0.003 * k), long_sigma = 1.0;
    core::TrackletReport one = report();
    one.tracklets.resize(1);
    const Eigen::Matrix3d R =
        (Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitX()))
            .toRotationMatrix();
    const Eigen::Vector2d variances(long_sigma * long_sigma, short_sigma * short_sigma);
    one.tracklets[0].tracklet.sighting =
        core::rotate(core::sightingOf({0.0, 0.0}, variances.asDiagonal()), R);
    const auto message = sightline_ros::toMessage(one, "platform_enu");
    const auto& covariance = message.tracklets[0].covariance;
    if (covariance[0] * covariance[3] <= covariance[1] * covariance[2]) ++elongated;
    const auto read = sightline_ros::readTracklets(message);
    ASSERT_FALSE(read.refusal) << core::textOf(*read.refusal) << " turn " << turn << " sigma " << short_sigma;
  }
  EXPECT_GT(elongated, 0) << "of which rounding takes the positive determinant";
}

TEST(TrackletMessages, OneThatCannotBeUsedIsRefusedByNameAndTheOthersAreKept) {
  const auto refusalAfter = [](const auto& change) {
    auto message = sightline_ros::toMessage(report(), "platform_enu");
    change(message.tracklets[0]);
    const auto read = sightline_ros::readTracklets(message);
    EXPECT_EQ(read.report.tracklets.size(), 1u);
    return read.refusal ? core::textOf(*read.refusal) : "none";
  };
  EXPECT_NE(
      refusalAfter([](auto& row) { row.track = 0; }).find("invalid: tracklet of track 0 of \"left\" by"),
      std::string::npos);
  EXPECT_NE(refusalAfter([](auto& row) { row.sensor = ""; }).find("the sensor is not named"),
            std::string::npos);
  EXPECT_NE(refusalAfter([](auto& row) { row.stamp = ros::Time(11.0); }).find("after the message's"),
            std::string::npos);
  EXPECT_NE(refusalAfter([](auto& row) { row.sightings = 0.0; }).find("not a number > 0"), std::string::npos);
  EXPECT_NE(refusalAfter([](auto& row) { row.azimuth = std::nan(""); }).find("not finite"),
            std::string::npos);
}

}  // namespace
