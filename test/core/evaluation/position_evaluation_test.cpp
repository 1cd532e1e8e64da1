#include "sightline/core/evaluation/position_evaluation.h"

#include <cmath>
#include <map>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "support/times.h"

namespace sightline::core {
namespace {

using test::at;

using Vector = Eigen::Vector3d;

Vector circle(double t) {
  return {20.0 * std::cos(t), 20.0 * std::sin(t), 5.0};
}

/// One target on a circle for 10 s, sampled every 0.2 s, without samples from `gap_from` to `gap_to`.
std::map<std::string, TruePath> onCircle(double gap_from = 20.0, double gap_to = 20.0) {
  std::map<std::string, TruePath> paths;
  TruePath& path = paths.try_emplace("drone", 0.5).first->second;
  for (int i = 0; i <= 50; ++i) {
    const double t = 0.2 * i;
    if (t < gap_from || t > gap_to) path.add(at(t), circle(t));
  }
  return paths;
}

EstimatedPosition estimate(std::uint32_t id, const Vector& position, double sigma = 1.0) {
  EstimatedPosition it;
  it.id = id;
  it.position = position;
  it.covariance = sigma * sigma * Eigen::Matrix3d::Identity();
  return it;
}

TEST(TruePath, IsSmoothBetweenItsSamplesAndEndsAtItsGaps) {
  const auto paths = onCircle(4.1, 6.1);
  const TruePath& path = paths.at("drone");
  // A slope from the neighbours is off by h^2 |x'''| / 6, and the path by 0.0963 h times that: 2.57 mm. A
  // straight line: 0.1 m.
  const double most = 0.0963 * 0.2 * 0.2 * 0.2 * 20.0 / 6.0 * 1.02;
  for (double t = 1.0; t < 3.8; t += 0.037) {
    const auto truth = path.at(at(t));
    ASSERT_TRUE(truth) << t;
    EXPECT_LT((truth->position - circle(t)).norm(), most) << t;
    const Vector velocity(-20.0 * std::sin(t), 20.0 * std::cos(t), 0.0);
    EXPECT_LT((truth->velocity - velocity).norm(), 0.2) << t;
  }
  EXPECT_TRUE(path.at(at(4.0)));
  EXPECT_FALSE(path.at(at(5.0)));
  EXPECT_FALSE(path.at(at(-0.1)));
  EXPECT_FALSE(path.at(at(10.1)));
}

TEST(PositionEvaluation, FiguresAreThoseOfKnownErrors) {
  const auto truth = onCircle();
  PositionEvaluation evaluation(truth, {});
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  for (int i = 0; i <= 1000; ++i) {
    const double a = normal(random), b = normal(random), c = normal(random);
    EstimatedPosition track = estimate(1, circle(0.01 * i) + 0.5 * Vector(a, b, c), 0.5);
    track.velocity = Vector(-20.0 * std::sin(0.01 * i), 20.0 * std::cos(0.01 * i), 3.0);
    evaluation.add(at(0.01 * i), {track});
  }
  const PositionRow row = evaluation.row();
  EXPECT_EQ(row.reports, 1001u);
  EXPECT_EQ(row.all.samples, 1001u);
  EXPECT_NEAR(row.all.rmse, 0.5 * std::sqrt(3.0), 0.04);
  EXPECT_NEAR(row.all.median, 0.5 * 1.538, 0.04);  // quantiles of chi with 3 degrees of freedom
  EXPECT_NEAR(row.all.p90, 0.5 * 2.500, 0.06);
  EXPECT_NEAR(row.all.anees, 1.0, 0.1);
  EXPECT_NEAR(row.all.median_velocity, 3.0, 0.1);
  EXPECT_EQ(row.alone.samples, 0u);
  EXPECT_EQ(row.coverage, 1.0);
  EXPECT_EQ(row.breaks, 0u);
  EXPECT_EQ(row.id_changes, 0u);
  EXPECT_EQ(row.false_tracks, 0u);
  EXPECT_NEAR(row.gospa, 0.8, 0.05);
}

TEST(PositionEvaluation, BreaksIdChangesAndGhostsAreCounted) {
  const auto truth = onCircle();
  PositionEvaluation evaluation(truth, {});
  for (int i = 0; i <= 100; ++i) {
    const double t = 0.1 * i;
    std::vector<EstimatedPosition> tracks;
    if (i < 40) tracks.push_back(estimate(1, circle(t)));
    if (i >= 50) tracks.push_back(estimate(2, circle(t)));
    if (i >= 80) tracks.push_back(estimate(3, circle(t) + Vector(0.0, 0.0, 100.0)));
    evaluation.add(at(t), tracks);
  }
  const PositionRow row = evaluation.row();
  EXPECT_EQ(row.breaks, 1u);
  EXPECT_EQ(row.id_changes, 1u);
  EXPECT_EQ(row.tracks, 3u);
  EXPECT_EQ(row.false_tracks, 1u);
  EXPECT_NEAR(row.false_share, 21.0 / 112.0, 1e-12);
  EXPECT_NEAR(row.coverage, 91.0 / 101.0, 1e-12);
  // A miss, or a ghost, costs c / sqrt(2) = 7.07 m.
  EXPECT_NEAR(row.gospa, 31.0 * 10.0 / std::sqrt(2.0) / 101.0, 1e-3);
}

TEST(PositionEvaluation, ATargetThatGoesBreaksNoTrackAndTimesWithoutTruthAreNotScored) {
  const auto truth = onCircle(4.1, 6.1);
  PositionEvaluation evaluation(truth, {});
  for (int i = 0; i <= 120; ++i) {
    const double t = 0.1 * i;
    std::vector<EstimatedPosition> tracks;
    if (t < 4.01 || t > 6.15) tracks.push_back(estimate(1, circle(t)));
    evaluation.add(at(t), tracks);
  }
  const PositionRow row = evaluation.row();
  EXPECT_EQ(row.reports, 101u);
  EXPECT_EQ(row.breaks, 0u);
  EXPECT_EQ(row.false_tracks, 0u);
}

TEST(PositionEvaluation, FarButHonestTrackOfOneStationIsItsTargetsAndCountedApart) {
  const auto truth = onCircle();
  PositionEvaluation evaluation(truth, {});
  EstimatedPosition track = estimate(1, circle(1.0) + Vector(15.0, 0.0, 0.0), 1.0);
  EXPECT_TRUE(evaluation.add(at(1.0), {track}).empty()) << "15 m off at a claimed metre";
  track.covariance(0, 0) = 100.0;
  track.is_alone = true;
  const auto pairs = evaluation.add(at(1.0), {track});
  ASSERT_EQ(pairs.size(), 1u);
  EXPECT_EQ(pairs[0].target, "drone");
  EXPECT_NEAR(pairs[0].nees, 2.25 / 3.0, 1e-6);
  EXPECT_EQ(evaluation.row().alone.samples, 1u);
  EXPECT_NEAR(evaluation.row().alone.rmse, 15.0, 1e-6);
}

}  // namespace
}  // namespace sightline::core
