// The figures of the evaluation's rows, against those worked by hand.
#include <cmath>

#include <gtest/gtest.h>

#include "sightline/core/evaluation/evaluation.h"

#include "core/evaluation/two_targets.h"

using namespace sightline::test;

namespace {

/// 101 reports a tenth of a second apart, 10 s. Target 1 is there throughout; target 2 from 2 s to 5 s (31
/// reports) and again from 8 s (21 reports: the gap is longer than truth_gap).
///  - track 1: on target 1 from 0.5 s to 6 s (56 reports); from 6.1 s on nowhere, to 7 s (10 reports)
///  - track 2: on target 2 from 2.4 s to 5 s (27 reports)
///  - track 3: on target 1 from 6.5 s (36 reports)
///  - track 9: nowhere, from 1 s to 1.9 s (10 reports)
/// Target 2's return is never followed.
Evaluation workedByHand() {
  Evaluation evaluation;
  const auto between = [](int i, int first, int last) { return i >= first && i <= last; };
  for (int i = 0; i <= 100; ++i) {
    const double t = 0.1 * i;
    Motions truth = {{1, motion(1, t)}};
    if (between(i, 20, 50) || i >= 80) truth[2] = motion(2, t);
    evaluation.addTruth(at(t), truth);
    const Eigen::Vector4d nowhere(-1.0, 0.5, 0.0, 0.0);
    std::vector<Track> tracks;
    if (between(i, 5, 60)) tracks.push_back(track(1, motion(1, t) + Eigen::Vector4d(0.0, 0.003, 0.0, 0.0)));
    if (between(i, 61, 70)) tracks.push_back(track(1, nowhere));
    if (between(i, 24, 50)) tracks.push_back(track(2, motion(2, t) + Eigen::Vector4d(0.0, 0.004, 0.0, 0.0)));
    if (i >= 65) tracks.push_back(track(3, motion(1, t) + Eigen::Vector4d(0.0, 0.003, 0.0, 0.0)));
    if (between(i, 10, 19)) tracks.push_back(track(9, nowhere));
    evaluation.addTracks("tracks", report(t, tracks));
  }
  return evaluation;
}

TEST(Evaluation, LivesOfTracksAreThoseWorkedByHand) {
  const EvaluationRow row = rowOf(workedByHand(), "tracks");
  EXPECT_EQ(row.tracks, 4u);
  EXPECT_EQ(row.false_tracks, 1u);  // track 9; track 1 was on a target in 56 of 66 reports
  EXPECT_NEAR(row.scored_time, 10.0, 1e-9);
  EXPECT_NEAR(row.false_tracks_per_hour, 360.0, 1e-6);
  EXPECT_NEAR(row.purity, (56.0 + 27.0 + 36.0 + 0.0) / (66.0 + 27.0 + 36.0 + 10.0), 1e-12);
  // Target 1: 56 of 101 with track 1; target 2: 27 of 31 with track 2, then 0 of 21.
  EXPECT_NEAR(row.completeness, (56.0 + 27.0 + 0.0) / (101.0 + 31.0 + 21.0), 1e-12);
  EXPECT_EQ(row.appearances, 3u);
  EXPECT_EQ(row.never_confirmed, 1u);
  EXPECT_NEAR(row.confirm_median, 0.45, 1e-9);  // between 0.5 s of target 1 and 0.4 s of target 2
  EXPECT_NEAR(row.confirm_worst, 0.5, 1e-9);
}

TEST(Evaluation, GospaAndOspaAreThoseWorkedByHand) {
  const EvaluationRow row = rowOf(workedByHand(), "tracks");
  // Targets missed: 1 in 5 reports at the start and 4 at 6.1 to 6.4 s; 2 in 4 reports and in 21. False: track
  // 1 in 10 reports, track 9 in 10.
  EXPECT_NEAR(row.gospa.missed(), (5.0 + 4.0 + 4.0 + 21.0) / 101.0, 1e-12);
  EXPECT_NEAR(row.gospa.extra(), 20.0 / 101.0, 1e-12);
  EXPECT_NEAR(row.gospa.missedCost(), 1e-3 * std::sqrt(34.0 / 101.0 * 50.0), 1e-9);
  EXPECT_NEAR(row.gospa.localisationCost(), 1e-3 * std::sqrt((92.0 * 9.0 + 27.0 * 16.0) / 101.0), 1e-9);
  // Reports and their OSPA [mrad], c = 10, p = 2, target 1's pair 3 apart and target 2's 4 apart:
  //  5  at the start, target 1 without a track: 10
  //  5  to 0.9 s, one pair: 3
  // 10  to 1.9 s, one pair and a false track: sqrt((9 + 100) / 2)
  //  4  to 2.3 s, one pair and one missed: the same
  // 27  to 5 s, two pairs: sqrt((9 + 16) / 2)
  // 10  to 6 s, one pair: 3
  //  4  to 6.4 s, a missed and a false one: 10
  //  6  to 7 s, one pair and a false track
  //  9  to 7.9 s, one pair: 3
  // 21  to 10 s, one pair and one missed
  const double one_more = std::sqrt(109.0 / 2.0);
  const double sum = 9 * 10.0 + 24 * 3.0 + (10 + 4 + 6 + 21) * one_more + 27 * std::sqrt(12.5);
  EXPECT_NEAR(row.ospa, 1e-3 * sum / 101.0, 1e-9);
}

TEST(Evaluation, EachTargetHasARowOfItsOwn) {
  const auto rows = workedByHand().targetRows();
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].topic, "tracks");
  EXPECT_EQ(rows[0].name, "tracker");
  EXPECT_EQ(rows[0].target, 1u);
  EXPECT_EQ(rows[0].samples, 92u);
  EXPECT_NEAR(rows[0].rmse, 0.003 / std::sqrt(2.0), 1e-9);
  EXPECT_NEAR(rows[0].anees_position, 0.09 / 2.0, 1e-9);  // the tracks state 0.01 rad
  EXPECT_NEAR(rows[0].coverage, 92.0 / 101.0, 1e-12);
  EXPECT_EQ(rows[0].breaks, 1u);
  EXPECT_EQ(rows[0].id_switches, 1u);
  EXPECT_EQ(rows[1].target, 2u);
  EXPECT_NEAR(rows[1].rmse, 0.004 / std::sqrt(2.0), 1e-9);
  EXPECT_NEAR(rows[1].coverage, 27.0 / 52.0, 1e-12);
  EXPECT_EQ(rows[1].breaks, 0u);  // it left with its track
}

}  // namespace
