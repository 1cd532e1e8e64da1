#include "sightline/report/residual_comparison.h"

#include <cmath>

#include <gtest/gtest.h>

#include "sightline/core/model/sighting.h"
#include "sightline/report/residual_text.h"

using namespace sightline::report;
namespace core = sightline::core;

namespace {

constexpr double kSigma = 0.01;  // [rad]

core::Time at(double seconds) {
  return core::timeOf(1'000'000'000'000) + core::durationOf(seconds);
}

/// A track along the horizon at 0.1 rad/s, established from `source`.
core::TrackReport report(const std::string& tracker, const std::string& source, double seconds) {
  core::TrackReport result;
  result.time = at(seconds);
  result.tracker = tracker;
  core::Track track;
  track.id = 4;
  track.status = core::TrackStatus::confirmed;
  track.state.mean << 0.1 * seconds, 0.0, 0.1, 0.0;
  track.state.covariance.setIdentity();
  track.sources = {source};
  result.tracks = {track};
  return result;
}

core::Scan scan(const std::string& sensor, double seconds, double offset) {
  core::Scan result;
  result.time = at(seconds);
  result.sensor = sensor;
  result.sightings = {
      core::sightingOf({0.1 * seconds + offset, 0.0}, Eigen::Matrix2d::Identity() * kSigma * kSigma)};
  return result;
}

/// Topic "tracks" is made of sensor "eye"; topic "fused" of the tracker on "tracks".
ResidualComparison compared(const core::ScoreListener& listener = {}) {
  ResidualComparison comparison({}, listener);
  for (int i = 0; i <= 10; ++i) {
    comparison.addTracks("tracks", report("tracker", "eye", 0.1 * i));
    comparison.addTracks("fused", report("fusion", "tracker", 0.1 * i));
  }
  for (int i = 1; i < 10; ++i) {
    comparison.addScan("sightings", scan("eye", 0.1 * i + 0.05, 0.002));
    comparison.addScan("others", scan("another_eye", 0.1 * i + 0.05, 0.0));
  }
  return comparison;
}

TEST(ResidualComparison, ResidualsAreThoseOfTheSensorsThatSupportTheTrack) {
  const ResidualComparison comparison = compared();
  const auto rows = comparison.topics().at("tracks").evaluation.rows();
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_EQ(rows[0].name, "eye");
  EXPECT_EQ(rows[0].samples, 9u);
  EXPECT_NEAR(rows[0].rmse, 0.002 / std::sqrt(2.0), 1e-6);
}

TEST(ResidualComparison, AFusedTrackIsComparedWithTheSensorsOfItsTrackers) {
  const auto rows = compared().topics().at("fused").evaluation.rows();
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_EQ(rows[0].samples, 9u);
}

TEST(ResidualComparison, PairsAreReportedUnderTheTopicOfTheTracks) {
  std::map<std::string, int> pairs;
  compared({[&](const core::ScoredPair& pair) { ++pairs[pair.topic]; }, {}});
  EXPECT_EQ(pairs, (std::map<std::string, int>{{"fused", 9}, {"tracks", 9}}));
}

TEST(ResidualText, RowsHoldResidualsAndSpans) {
  const auto rows = residualRows(compared());
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[1].topic, "tracks");
  EXPECT_EQ(rows[1].samples, 9u);
  EXPECT_EQ(rows[1].tracks, 1u);
  EXPECT_NEAR(rows[1].coverage, 1.0, 1e-12);
}

TEST(ResidualText, TablesHaveALineForEachTopic) {
  const ResidualComparison comparison = compared();
  EXPECT_NE(residualTable(comparison).find("  tracks < eye"), std::string::npos) << residualTable(comparison);
  EXPECT_NE(residualTable(comparison).find("0.001414"), std::string::npos) << residualTable(comparison);
  const std::string spans = spanTable(comparison);
  EXPECT_NE(spans.find("100.0 %"), std::string::npos) << spans;
  EXPECT_NE(spans.find("1.00"), std::string::npos) << spans;
}

}  // namespace
