#include "sightline/core/evaluation/position_scores.h"

#include <chrono>

#include <gtest/gtest.h>

#include "support/times.h"

namespace sightline::core {
namespace {

using test::at;

Eigen::Vector3d truthAt(double time) {
  return {10.0 * time, 5.0, 20.0};
}

EstimatedPosition estimateAt(double time, const Eigen::Vector3d& error) {
  EstimatedPosition estimate;
  estimate.id = 3;
  estimate.position = truthAt(time) + error;
  estimate.velocity = {10.0, 0.0, 0.0};
  return estimate;
}

TEST(PositionScores, ReportsWaitForTheTruthAroundThem) {
  PositionScores scores(PositionEvaluationParams{}, 2.0);
  for (int i = 0; i <= 100; ++i) {
    const double time = 0.01 * i;
    // A report between two samples of the truth, ahead of the second.
    EXPECT_TRUE(scores.addTracks("/a", at(time + 0.005), {estimateAt(time + 0.005, {0.5, 0.0, 0.0})}));
    scores.addTruth(at(time), "1", truthAt(time));
  }
  const PositionRow row = scores.rows().at("/a");
  EXPECT_NEAR(static_cast<double>(row.reports), 75.0, 1.0);  // the last quarter of a second still waits
  EXPECT_NEAR(row.all.rmse, 0.5, 1e-9);
  EXPECT_NEAR(row.all.median_velocity, 0.0, 1e-9);
  EXPECT_EQ(row.coverage, 1.0);
}

TEST(PositionScores, OfSeveralReportsAtOneTimeTheLastCountsAndLateOnesAreLeftOut) {
  PositionScores scores(PositionEvaluationParams{}, 2.0);
  scores.addTruth(at(0.0), "1", truthAt(0.0));
  scores.addTracks("/a", at(0.1), {estimateAt(0.1, {3.0, 0.0, 0.0})});
  scores.addTracks("/a", at(0.1), {estimateAt(0.1, {1.0, 0.0, 0.0})});
  for (int i = 1; i <= 10; ++i) scores.addTruth(at(0.1 * i), "1", truthAt(0.1 * i));
  EXPECT_FALSE(scores.addTracks("/a", at(0.05), {}));
  EXPECT_EQ(scores.rows().at("/a").reports, 1U);
  EXPECT_NEAR(scores.rows().at("/a").all.rmse, 1.0, 1e-9);
}

TEST(PositionScores, TruthOfLongAgoIsForgottenAndTheFiguresStay) {
  PositionScores scores(PositionEvaluationParams{}, 2.0);
  for (int i = 0; i <= 3000; ++i) {
    const double time = 0.02 * i;
    scores.addTracks("/a", at(time), {estimateAt(time, {0.0, 2.0, 0.0})});
    scores.addTruth(at(time), "1", truthAt(time));
  }
  const PositionRow row = scores.rows().at("/a");
  EXPECT_GT(row.reports, 2900U);
  EXPECT_NEAR(row.all.rmse, 2.0, 1e-9);
  EXPECT_EQ(row.breaks, 0U);
}

}  // namespace
}  // namespace sightline::core
