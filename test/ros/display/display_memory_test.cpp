#include "sightline/ros/display/display_memory.h"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

namespace {

namespace core = sightline::core;
using sightline_ros::SightingMemory;
using sightline_ros::TrackMemory;

sightline::Track smallTrack(std::uint32_t id, double azimuth, double elevation) {
  sightline::Track track;
  track.id = id;
  track.azimuth = azimuth;
  track.elevation = elevation;
  track.azimuth_rate = 0.5;
  return track;
}

sightline::TrackArray reportAt(double time, const std::vector<sightline::Track>& tracks) {
  sightline::TrackArray report;
  report.header.stamp.fromSec(time);
  report.tracks = tracks;
  return report;
}

core::Scan scanOf(std::size_t sightings, double time = 1.0) {
  core::Scan scan;
  scan.time = core::Time(core::durationOf(time));
  scan.sightings.resize(sightings);
  for (core::Sighting& sighting : scan.sightings) {
    sighting.direction = Eigen::Vector3d::UnitX();
    sighting.covariance = Eigen::Matrix3d::Identity();
  }
  return scan;
}

TEST(TrackMemory, ThinnedPathKeepsItsLengthAndItsNewestPoint) {
  TrackMemory memory(4.0);
  for (int i = 0; i <= 10000; ++i) memory.add(reportAt(1.0 + 1e-3 * i, {smallTrack(1, 1e-4 * i, 0.0)}), 0.0);
  const auto& path = memory.pathOf(1);
  EXPECT_LE(path.size(), 220U);
  EXPECT_NEAR(core::seconds(path.back().time - path.front().time), 4.0, 0.05);
  EXPECT_NEAR(path.back().motion.x(), 1.0, 1e-9);
}

TEST(TrackMemory, AnglesBetweenReportsFollowTheMotion) {
  TrackMemory memory(4.0);
  for (int i = 0; i < 5; ++i) {
    sightline::Track moving = smallTrack(1, std::sin(0.1 * i), 0.0);
    moving.azimuth_rate = std::cos(0.1 * i);
    memory.add(reportAt(1.0 + 0.1 * i, {moving}), 0.0);
  }
  const auto at = [&](double time) { return memory.anglesAt(1, core::timeOf(0) + core::durationOf(time)); };
  ASSERT_TRUE(at(1.25).has_value());
  EXPECT_NEAR(at(1.25)->x(), std::sin(0.25), 1e-6);
  ASSERT_TRUE(at(1.4).has_value());
  EXPECT_FALSE(at(0.99).has_value());
  EXPECT_FALSE(at(1.41).has_value());
  EXPECT_FALSE(memory.anglesAt(2, core::timeOf(0) + core::durationOf(1.2)).has_value());
}

TEST(TrackMemory, TracksThatAReportDoesNotHoldAndThoseNotFiniteAreForgotten) {
  TrackMemory memory(4.0);
  memory.add(reportAt(1.0, {smallTrack(1, 0.1, 0.0), smallTrack(2, 0.2, 0.0)}), 0.0);
  memory.add(reportAt(1.1, {smallTrack(2, 0.2, 0.0), smallTrack(3, std::nan(""), 0.0)}), 0.1);
  EXPECT_TRUE(memory.pathOf(1).empty());
  EXPECT_EQ(memory.pathOf(2).size(), 2U);
  ASSERT_EQ(memory.newest().tracks.size(), 1U);
  EXPECT_EQ(memory.arrival(), 0.1);
}

TEST(TrackMemory, ReportFromBeforeTheLastOneStartsAnew) {
  TrackMemory memory(4.0);
  memory.add(reportAt(5.0, {smallTrack(1, 0.1, 0.0)}), 0.0);
  memory.add(reportAt(1.0, {smallTrack(1, 0.2, 0.0)}), 1.0);
  EXPECT_EQ(memory.pathOf(1).size(), 1U);
}

TEST(TrackMemory, ClaimsAreThoseOfTheLastDecisions) {
  TrackMemory memory(4.0);
  sightline::AssociationArray decisions;
  decisions.associations.resize(2);
  decisions.associations[0].track = 7;
  decisions.associations[0].decision = sightline::Association::CLAIMED_BY_OTHER;
  decisions.associations[1].track = 8;
  decisions.associations[1].decision = sightline::Association::ACCEPTED;
  memory.add(decisions);
  EXPECT_TRUE(memory.wasClaimed(7));
  EXPECT_FALSE(memory.wasClaimed(8));
  memory.add(sightline::AssociationArray());
  EXPECT_FALSE(memory.wasClaimed(7));
}

TEST(SightingMemory, SightingsThatATrackerWouldRejectAreLeftOut) {
  SightingMemory memory;
  core::Scan scan = scanOf(3);
  scan.sightings[1].covariance.setConstant(std::nan(""));
  memory.add(scan, 0.5);
  EXPECT_EQ(memory.seen().size(), 2U);
}

TEST(SightingMemory, ForgetsWhatArrivedEarlierAndIsBounded) {
  SightingMemory memory;
  memory.add(scanOf(2), 1.0);
  memory.add(scanOf(3), 2.0);
  memory.forgetBefore(2.0);
  EXPECT_EQ(memory.seen().size(), 3U);
  memory.add(scanOf(10000), 3.0);
  EXPECT_LE(memory.seen().size(), 500U);
  EXPECT_EQ(memory.seen().front().arrival, 3.0);
}

}  // namespace
