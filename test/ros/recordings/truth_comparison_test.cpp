#include "sightline/ros/recordings/truth_comparison.h"

#include <cmath>

#include <gtest/gtest.h>

#include "sightline/core/model/sighting.h"

using namespace sightline_ros;
namespace core = sightline::core;

namespace {

core::Time at(double seconds) {
  return core::timeOf(1'000'000'000'000) + core::durationOf(seconds);
}

/// One target, at rest at this azimuth for ten seconds.
Motions atRest(double azimuth) {
  Motions motions;
  for (int i = 0; i <= 10; ++i) motions[at(i)] = {{1, {azimuth, 0.0, 0.0, 0.0}}};
  return motions;
}

core::Scan scan(const std::string& sensor, double azimuth) {
  core::Scan result;
  result.time = at(5.5);
  result.sensor = sensor;
  result.sightings = {core::sightingOf({azimuth, 0.0}, Eigen::Matrix2d::Identity() * 1e-4)};
  return result;
}

core::TrackReport report(const std::string& tracker, double azimuth) {
  core::TrackReport result;
  result.time = at(5.5);
  result.tracker = tracker;
  result.tracks.resize(1);
  result.tracks[0].id = 3;
  result.tracks[0].status = core::TrackStatus::confirmed;
  result.tracks[0].state.mean << azimuth, 0.0, 0.0, 0.0;
  result.tracks[0].state.covariance.setIdentity();
  return result;
}

TEST(TruthComparison, OneTruthIsThatOfAllSensors) {
  TruthComparison comparison({{{"", atRest(0.5)}}, ""}, {}, {});
  comparison.addScan("/sensors/a/sightings", scan("a", 0.502));
  comparison.addScan("/sensors/b/sightings", scan("b", 0.504));
  comparison.addTracks("/sensors/a/tracks", report("a", 0.501));
  const auto rows = comparison.rows();
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_NEAR(rows[0].rmse, 0.002 / std::sqrt(2.0), 1e-9);
  EXPECT_NEAR(rows[1].rmse, 0.004 / std::sqrt(2.0), 1e-9);
  EXPECT_EQ(rows[2].kind, core::EvaluationRow::Kind::tracks);
  EXPECT_NEAR(comparison.bestSigma(), 0.01, 1e-9);
  ASSERT_EQ(comparison.targetRows().size(), 1u);
  EXPECT_NEAR(comparison.targetRows()[0].rmse, 0.001 / std::sqrt(2.0), 1e-9);
}

TEST(TruthComparison, EachSensorIsComparedWithItsOwnTruth) {
  TruthComparison comparison({{{"a", atRest(0.1)}, {"b", atRest(0.9)}}, ""}, {}, {});
  comparison.addScan("/sensors/a/sightings", scan("a", 0.1));
  comparison.addScan("/sensors/b/sightings", scan("b", 0.9));
  comparison.addTracks("/sensors/b/tracks", report("tracker of b", 0.9));  // by a part of the topic
  const auto rows = comparison.rows();
  ASSERT_EQ(rows.size(), 3u);
  for (const auto& row : rows) EXPECT_EQ(row.samples, 1u) << row.topic;
  EXPECT_TRUE(std::isnan(comparison.bestSigma()));
  EXPECT_TRUE(comparison.withoutTruth().empty());
}

TEST(TruthComparison, MessagesWithoutATruthAreCountedByTopic) {
  TruthComparison comparison({{{"a", atRest(0.1)}, {"b", atRest(0.9)}}, ""}, {}, {});
  comparison.addScan("/sensors/c/sightings", scan("c", 0.1));
  comparison.addTracks("/fusion/tracks", report("fusion", 0.1));
  comparison.addTracks("/fusion/tracks", report("fusion", 0.1));
  EXPECT_TRUE(comparison.rows().empty());
  EXPECT_EQ(comparison.withoutTruth(),
            (std::map<std::string, std::size_t>{{"/fusion/tracks", 2}, {"/sensors/c/sightings", 1}}));
}

}  // namespace
