#include "sightline/core/tracking/tracklet_builder.h"

#include <stdexcept>

#include <gtest/gtest.h>

#include "sightline/core/model/sphere.h"

#include "support/times.h"

namespace sightline::core {
namespace {

using test::at;

constexpr double kSigma = 1e-3;  // [rad]

Sighting sightingAt(double azimuth) {
  return sightingOf({azimuth, 0.0}, kSigma * kSigma * Eigen::Matrix2d::Identity());
}

Scan scanOf(double t, const std::string& sensor = "camera", const std::vector<double>& azimuths = {0.1}) {
  Scan scan;
  scan.time = at(t);
  scan.sensor = sensor;
  for (const double azimuth : azimuths) scan.sightings.push_back(sightingAt(azimuth));
  return scan;
}

/// A tracker's answer in which the k-th sighting went to the k-th of `tracks` (0 = to nobody).
ScanReport tracked(const Scan& scan, const std::vector<std::uint32_t>& tracks = {1}) {
  ScanReport report;
  report.time = scan.time;
  for (std::size_t k = 0; k < tracks.size(); ++k) {
    Association association;
    association.sighting = static_cast<std::uint32_t>(k);
    association.track = tracks[k];
    association.decision = tracks[k] == 0 ? Decision::outside_gate : Decision::accepted;
    report.associations.push_back(association);
  }
  return report;
}

TEST(TrackletBuilder, EverySightingThatWasTakenIsReportedOnce) {
  TrackletBuilder builder({});
  const Scan scan = scanOf(1.0, "camera", {0.1, 0.2, 0.3});
  ScanReport answer = tracked(scan, {4, 0, 7});
  answer.associations[2].decision = Decision::started_track;
  const auto report = builder.onScan(scan, answer);
  ASSERT_TRUE(report);
  EXPECT_EQ(report->time, at(1.0));
  EXPECT_FALSE(report->since);
  ASSERT_EQ(report->tracklets.size(), 2u);
  EXPECT_EQ(report->tracklets[0].track, 4u);
  EXPECT_EQ(report->tracklets[1].track, 7u);
  EXPECT_EQ(report->tracklets[1].tracklet.sighting.direction, scan.sightings[2].direction);
  EXPECT_EQ(report->tracklets[1].tracklet.sighting.covariance, scan.sightings[2].covariance);
  EXPECT_EQ(report->tracklets[1].tracklet.sensor, "camera");

  const Scan empty = scanOf(1.1, "camera", {});
  const auto next = builder.onScan(empty, tracked(empty, {}));
  ASSERT_TRUE(next) << "that nothing was seen is news too";
  EXPECT_TRUE(next->tracklets.empty());
  EXPECT_EQ(next->since, at(1.0));
}

TEST(TrackletBuilder, ReportsComeAtTheirIntervalAndNameTheOneBefore) {
  TrackletParams params;
  params.interval = 0.3;
  TrackletBuilder builder(params);
  std::vector<TrackletReport> reports;
  for (int k = 0; k <= 100; ++k) {
    const Scan scan = scanOf(1.0 + 0.03 * k);
    if (auto report = builder.onScan(scan, tracked(scan))) reports.push_back(*report);
  }
  ASSERT_EQ(reports.size(), 11u);
  double sightings = 0.0;
  for (std::size_t i = 0; i < reports.size(); ++i) {
    if (i > 0) {
      EXPECT_NEAR(seconds(reports[i].time - reports[i - 1].time), 0.3, 0.031);
      EXPECT_EQ(reports[i].since, reports[i - 1].time);
      EXPECT_EQ(reports[i].tracklets.size(), 4u) << "two spans of two nodes";
    }
    for (const TrackTracklet& it : reports[i].tracklets) sightings += it.tracklet.sightings;
  }
  EXPECT_NEAR(sightings, 1.0 + 10.0 * std::round((sightings - 1.0) / 10.0), 1e-9);
  EXPECT_GE(sightings, 90.0);
}

TEST(TrackletBuilder, SlowSensorDoesNotWaitForItsNextScan) {
  TrackletParams params;
  params.interval = 0.3;
  TrackletBuilder builder(params);
  for (double t = 1.0; t < 5.0; t += 1.0) {
    const auto report = builder.onScan(scanOf(t), tracked(scanOf(t)));
    ASSERT_TRUE(report) << t;
    EXPECT_EQ(report->tracklets.size(), 1u);
  }
}

TEST(TrackletBuilder, WhatWaitsIsReportedByTheClockWhenScansEnd) {
  TrackletParams params;
  params.interval = 0.3;
  TrackletBuilder builder(params);
  EXPECT_FALSE(builder.onTime(at(9.0))) << "nothing waits";
  for (const double t : {1.0, 1.03, 1.06}) builder.onScan(scanOf(t), tracked(scanOf(t)));
  EXPECT_FALSE(builder.onTime(at(1.2)));
  const auto report = builder.onTime(at(1.31));
  ASSERT_TRUE(report);
  EXPECT_EQ(report->time, at(1.06));
  EXPECT_EQ(report->since, at(1.0));
  EXPECT_EQ(report->tracklets.size(), 2u);
  EXPECT_FALSE(builder.onTime(at(2.0)));
}

TEST(TrackletBuilder, LateScanMakesALaterTracklet) {
  TrackletBuilder builder({});
  builder.onScan(scanOf(1.0), tracked(scanOf(1.0)));
  const Scan late = scanOf(0.9, "other");
  ScanReport answer = tracked(late);
  answer.time = at(1.0);
  const auto report = builder.onScan(late, answer);
  ASSERT_TRUE(report);
  EXPECT_EQ(report->time, at(1.0));
  EXPECT_EQ(report->since, at(1.0));
  ASSERT_EQ(report->tracklets.size(), 1u);
  EXPECT_EQ(report->tracklets[0].tracklet.time, at(0.9));
}

TEST(TrackletBuilder, NoiseScaleOfTheTrackerIsInTheCovariance) {
  TrackletBuilder builder({});
  const Scan scan = scanOf(1.0);
  ScanReport answer = tracked(scan);
  answer.use.noise_scale = 4.0;
  const auto report = builder.onScan(scan, answer);
  EXPECT_TRUE(report->tracklets.at(0).tracklet.sighting.covariance.isApprox(
      4.0 * scan.sightings[0].covariance, 1e-12));
  answer.use.is_excluded = true;
  answer.time = at(1.1);
  EXPECT_TRUE(builder.onScan(scan, answer)->tracklets.empty()) << "the sensor is excluded";
}

TEST(TrackletBuilder, WhatIsAsWideAsTheSphereByTheNoiseFoundIsNotReported) {
  const auto reported = [](double noise_scale) {
    TrackletBuilder builder({});
    const Scan scan = scanOf(1.0);
    ScanReport answer = tracked(scan);
    answer.use.noise_scale = noise_scale;
    return builder.onScan(scan, answer)->tracklets.size();
  };
  EXPECT_EQ(reported(1e6), 1u);  // a sigma of 1 rad
  EXPECT_EQ(reported(1e8), 0u);
}

TEST(TrackletBuilder, SensorsOfOneTrackStayApart) {
  TrackletParams params;
  params.interval = 1.0;
  params.compression.span = 1.0;
  TrackletBuilder builder(params);
  std::optional<TrackletReport> report;
  for (int k = 0; k < 40 && (!report || k == 1); ++k) {
    const Scan scan = scanOf(1.0 + 0.05 * k, k % 2 == 0 ? "a" : "b");
    report = builder.onScan(scan, tracked(scan));
  }
  ASSERT_TRUE(report);
  ASSERT_EQ(report->tracklets.size(), 4u);
  EXPECT_EQ(report->tracklets[0].tracklet.sensor, "a");
  EXPECT_EQ(report->tracklets[3].tracklet.sensor, "b");
}

TEST(TrackletBuilder, DroppedScanIsNotReported) {
  TrackletBuilder builder({});
  ScanReport answer = tracked(scanOf(1.0));
  answer.refusal = Refusal{"late", "too late"};
  EXPECT_FALSE(builder.onScan(scanOf(1.0), answer));
}

TEST(TrackletBuilder, ClockThatWentBackStartsAnew) {
  TrackletBuilder builder({});
  builder.onScan(scanOf(100.0), tracked(scanOf(100.0)));
  const auto report = builder.onScan(scanOf(1.0), tracked(scanOf(1.0)));
  ASSERT_TRUE(report);
  EXPECT_FALSE(report->since);
  EXPECT_EQ(report->time, at(1.0));
}

TEST(TrackletBuilder, ImpossibleParametersAreRefused) {
  TrackletParams params;
  params.interval = -1.0;
  EXPECT_THROW(TrackletBuilder{params}, std::invalid_argument);
  params = {};
  params.compression.nodes = 5;
  EXPECT_THROW(TrackletBuilder{params}, std::invalid_argument);
  params = {};
  params.compression.span = -0.1;
  EXPECT_THROW(TrackletBuilder{params}, std::invalid_argument);
}

}  // namespace
}  // namespace sightline::core
