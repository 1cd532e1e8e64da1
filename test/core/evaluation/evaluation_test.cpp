#include "sightline/core/evaluation/evaluation.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "sightline/core/model/sphere.h"

#include "core/evaluation/two_targets.h"

using namespace sightline::test;

namespace {

const Eigen::Vector4d kOffset(0.003, 0.004, 0.01, 0.02);

TEST(Evaluation, ConstantErrorsComeOutAsTheyWent) {
  Evaluation evaluation;
  evaluation.addTruth(at(0.0), {{1, {0.2, 0.0, 0.0, 0.0}}});
  evaluation.addTruth(at(1.0), {{1, {0.2, 0.0, 0.0, 0.0}}});
  for (int i = 0; i < 10; ++i) {
    evaluation.addScan("sightings", scan(0.1 * i, {sightingAt({0.2 + 0.006, 0.008}, 0.01)}));
    evaluation.addTracks("tracks", report(0.1 * i, {track(5, {0.203, 0.004, 0.01, 0.02}, 0.005)}));
  }
  const EvaluationRow sightings = rowOf(evaluation, "sightings"), tracks = rowOf(evaluation, "tracks");
  EXPECT_EQ(sightings.name, "camera");
  EXPECT_EQ(sightings.kind, EvaluationRow::Kind::sightings);
  EXPECT_EQ(sightings.samples, 10u);
  EXPECT_NEAR(sightings.rmse, 0.01 / std::sqrt(2.0), 1e-9);
  EXPECT_NEAR(sightings.relative_rmse, 1.0 / std::sqrt(2.0), 2e-5);
  EXPECT_NEAR(sightings.stated_sigma, 0.01, 1e-6);
  EXPECT_NEAR(sightings.anees_position, 0.5, 1e-4);
  EXPECT_TRUE(std::isnan(sightings.rate_rmse));
  EXPECT_TRUE(std::isnan(sightings.anees_state));
  EXPECT_TRUE(std::isnan(sightings.coverage));

  EXPECT_EQ(tracks.name, "tracker");
  EXPECT_EQ(tracks.samples, 10u);
  EXPECT_NEAR(tracks.rmse, 0.005 / std::sqrt(2.0), 1e-9);
  EXPECT_NEAR(tracks.relative_rmse, 0.5 / std::sqrt(2.0), 2e-5);
  EXPECT_NEAR(tracks.rate_rmse, std::sqrt((1e-4 + 4e-4) / 2.0), 1e-9);
  EXPECT_NEAR(tracks.anees_position, 0.5, 1e-9);
  EXPECT_NEAR(tracks.anees_state, (1.0 + 5e-4 / 25e-6) / 4.0, 1e-9);
  EXPECT_EQ(tracks.coverage, 1.0);
  EXPECT_EQ(tracks.breaks + tracks.id_switches, 0u);
  EXPECT_NEAR(tracks.gospa.distance(), 0.005, 1e-6);
  EXPECT_EQ(tracks.tracks_now, 1);
  EXPECT_NEAR(tracks.angles_now.x(), 0.203, 1e-12);
  EXPECT_NEAR(tracks.error_now, 0.005 / std::sqrt(2.0), 1e-9);
}

TEST(Evaluation, MessagesWaitUntilTheTruthHasCaughtUp) {
  Evaluation evaluation;
  evaluation.addTracks("tracks", report(0.55, {track(1, motion(1, 0.55))}));
  EXPECT_FALSE(evaluation.lastScored());
  evaluation.addTruth(at(0.5), both(0.5));
  EXPECT_EQ(rowOf(evaluation, "tracks").samples, 0u);
  evaluation.addTruth(at(0.6), both(0.6));
  EXPECT_EQ(rowOf(evaluation, "tracks").samples, 1u);
  EXPECT_LT(rowOf(evaluation, "tracks").rmse, 1e-6);  // interpolated, not held
  EXPECT_EQ(evaluation.lastScored(), at(0.55));
}

TEST(Evaluation, FalseSightingsAreCountedAndDoNotSpoilTheErrors) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal(0.0, 1e-3);
  std::uniform_real_distribution<double> anywhere(-0.4, 0.9);
  Evaluation evaluation;
  const int scans = 2000, false_ones = 5;
  for (int i = 0; i <= scans; ++i) {
    const double t = 0.02 * i;
    evaluation.addTruth(at(t), both(t));
    std::vector<Sighting> sightings;
    for (int k = 0; k < false_ones; ++k)
      sightings.push_back(sightingAt({anywhere(random), anywhere(random)}, 1e-3));
    for (const std::uint32_t target : {1u, 2u}) {
      const Eigen::Vector4d truth = motion(target, t);
      sightings.push_back(
          sightingAt({truth(0) + normal(random) / std::cos(truth(1)), truth(1) + normal(random)}, 1e-3));
    }
    evaluation.addScan("sightings", scan(t, sightings));
  }
  const EvaluationRow row = rowOf(evaluation, "sightings");
  EXPECT_EQ(row.samples, 2u * (scans + 1));
  EXPECT_EQ(row.unmatched, std::uint64_t(false_ones) * (scans + 1));
  EXPECT_NEAR(row.rmse, 1e-3, 4.0 * 1e-3 / std::sqrt(2.0 * 2.0 * row.samples));
}

TEST(Evaluation, AFloorAdmitsSightingsThatStateTooSmallASigma) {
  EvaluationParams params;
  for (const double floor : {0.0, 0.05}) {
    params.sighting_gate_floor = floor;
    Evaluation evaluation(params);
    evaluation.addTruth(at(0.0), both(0.0));
    evaluation.addScan("sightings",
                       scan(0.0, {sightingAt(motion(1, 0.0).head<2>() + Eigen::Vector2d(0.02, 0.0), 1e-4)}));
    EXPECT_EQ(rowOf(evaluation, "sightings").samples, floor > 0.0 ? 1u : 0u);
    EXPECT_EQ(rowOf(evaluation, "sightings").unmatched, floor > 0.0 ? 0u : 1u);
  }
}

TEST(Evaluation, OnlyEstablishedTracksCount) {
  Evaluation evaluation;
  evaluation.addTruth(at(0.0), both(0.0));
  evaluation.addTracks("tracks", report(0.0, {track(1, motion(1, 0.0), 0.01, TrackStatus::tentative),
                                              track(2, motion(2, 0.0), 0.01, TrackStatus::coasting)}));
  const EvaluationRow row = rowOf(evaluation, "tracks");
  EXPECT_EQ(row.samples, 1u);
  EXPECT_NEAR(row.coverage, 0.5, 1e-12);
  EXPECT_EQ(row.tracks_now, 1);
  EXPECT_EQ(row.unmatched, 0u);
}

TEST(Evaluation, ATrackThatIsNotFiniteHarmsNothing) {
  Evaluation evaluation;
  evaluation.addTruth(at(0.0), both(0.0));
  evaluation.addTracks(
      "tracks", report(0.0, {track(1, Eigen::Vector4d::Constant(std::nan(""))), track(2, motion(2, 0.0))}));
  EXPECT_EQ(rowOf(evaluation, "tracks").samples, 1u);
  EXPECT_TRUE(std::isfinite(rowOf(evaluation, "tracks").rmse));
}

TEST(Evaluation, FirstSecondsOfATargetDoNotCount) {
  EvaluationParams params;
  params.settle_time = 1.0;
  Evaluation evaluation(params);
  for (int i = 0; i <= 40; ++i) {
    const double t = 0.1 * i;
    Motions motions = {{1, motion(1, t)}};
    if (t > 1.95) motions[2] = motion(2, t);  // appears later
    evaluation.addTruth(at(t), motions);
    std::vector<Track> tracks;
    for (const auto& [id, mean] : motions) {
      const bool young = t < (id == 1 ? 0.95 : 2.95);
      tracks.push_back(track(id, mean + (young ? 10.0 : 1.0) * kOffset));
    }
    evaluation.addTracks("tracks", report(t, tracks));
    evaluation.addScan("sightings", scan(t, {sightingAt(motions.at(1).head<2>(), 0.01)}));
  }
  const EvaluationRow row = rowOf(evaluation, "tracks");
  EXPECT_EQ(row.samples, 31u + 11u);
  EXPECT_NEAR(row.rmse, 0.005 / std::sqrt(2.0), 2e-5);  // the sphere's cosine
  EXPECT_EQ(row.unmatched, 0u);
  EXPECT_EQ(row.coverage, 1.0);
  EXPECT_EQ(rowOf(evaluation, "sightings").samples, 31u);
  EXPECT_NEAR(row.gospa.missed() + row.gospa.extra(), 0.0, 1e-12);
}

TEST(Evaluation, BreaksAndChangesOfIdentityAreCounted) {
  Evaluation evaluation;
  for (int i = 0; i <= 50; ++i) {
    const double t = 0.1 * i;
    evaluation.addTruth(at(t), both(t));
    std::vector<Track> tracks = {track(2, motion(2, t))};
    if (i < 20 || i >= 30)
      tracks.push_back(track(i < 20 ? 1 : 3, motion(1, t)));  // lost, and found as another
    evaluation.addTracks("tracks", report(t, tracks));
  }
  const EvaluationRow row = rowOf(evaluation, "tracks");
  EXPECT_EQ(row.breaks, 1u);
  EXPECT_EQ(row.id_switches, 1u);
  EXPECT_NEAR(row.coverage, 1.0 - 10.0 / 102.0, 1e-12);
  EXPECT_NEAR(row.gospa.missed(), 10.0 / 51.0, 1e-12);
}

TEST(Evaluation, ATargetThatWasAwayMayComeBackAsAnotherTrack) {
  Evaluation evaluation;
  for (const double start : {0.0, 20.0}) {  // nothing is reported in between
    for (int i = 0; i < 10; ++i) {
      const double t = start + 0.1 * i;
      evaluation.addTruth(at(t), {{1, motion(1, t)}});
      evaluation.addTracks("tracks", report(t, {track(start > 0.0 ? 2 : 1, motion(1, t))}));
    }
  }
  EXPECT_EQ(rowOf(evaluation, "tracks").id_switches, 0u);
  EXPECT_EQ(rowOf(evaluation, "tracks").breaks, 0u);
  EXPECT_EQ(rowOf(evaluation, "tracks").samples, 20u);
}

TEST(Evaluation, CrossingTargetsKeepTheirTracks) {
  // Two targets meet; for some instants each track is nearer to the other's target.
  Evaluation evaluation;
  for (int i = -50; i <= 50; ++i) {
    const double t = 10.0 + 0.02 * i, x = 0.02 * i * 0.01;
    const Eigen::Vector4d up(x, x, 0.01, 0.01), down(x, -x, 0.01, -0.01);
    evaluation.addTruth(at(t), {{1, up}, {2, down}});
    const Eigen::Vector4d error(0.0, 0.001, 0.0, 0.0);
    evaluation.addTracks("tracks", report(t, {track(11, up - error), track(12, down + error)}));
  }
  const EvaluationRow row = rowOf(evaluation, "tracks");
  EXPECT_EQ(row.id_switches, 0u);
  EXPECT_NEAR(row.rmse, 0.001 / std::sqrt(2.0), 1e-7);
}

TEST(Evaluation, TracksThatExchangeTheirTargetsAreTwoSwitches) {
  EvaluationParams params;
  params.match_gate = 0.1;
  Evaluation evaluation(params);
  for (int i = 0; i < 20; ++i) {
    const double t = 0.1 * i;
    evaluation.addTruth(at(t), both(t));
    evaluation.addTracks(
        "tracks", report(t, {track(i < 10 ? 1 : 2, motion(1, t)), track(i < 10 ? 2 : 1, motion(2, t))}));
  }
  EXPECT_EQ(rowOf(evaluation, "tracks").id_switches, 2u);
  EXPECT_EQ(rowOf(evaluation, "tracks").breaks, 0u);
}

TEST(Evaluation, TracksThatExchangeTheirTargetsWhereTheseCrossAreTwoSwitchesAndNoBreak) {
  Evaluation evaluation;
  for (int i = -100; i <= 100; ++i) {
    const double t = 10.0 + 0.02 * i, x = 0.02 * i * 0.1;
    const Eigen::Vector4d up(x, x, 0.1, 0.1), down(x, -x, 0.1, -0.1);
    evaluation.addTruth(at(t), {{1, up}, {2, down}});
    evaluation.addTracks("tracks", report(t, {track(11, i < 0 ? up : down), track(12, i < 0 ? down : up)}));
  }
  const EvaluationRow row = rowOf(evaluation, "tracks");
  EXPECT_EQ(row.id_switches, 2u);
  EXPECT_EQ(row.breaks, 0u);
  EXPECT_EQ(row.coverage, 1.0);
  EXPECT_LT(row.error_now, 1e-9);
}

TEST(Evaluation, AFarTrackIsNoTrackOfTheTarget) {
  Evaluation evaluation;
  evaluation.addTruth(at(0.0), both(0.0));
  evaluation.addScan("sightings", scan(0.0, {sightingAt(motion(1, 0.0).head<2>(), 0.001)}));
  evaluation.addTracks("tracks", report(0.0, {track(1, motion(1, 0.0) + Eigen::Vector4d(0.011, 0, 0, 0)),
                                              track(2, motion(2, 0.0) + Eigen::Vector4d(0.009, 0, 0, 0))}));
  const EvaluationRow row = rowOf(evaluation, "tracks");  // ten sigmas are 0.01 rad
  EXPECT_EQ(row.samples, 1u);
  EXPECT_EQ(row.unmatched, 1u);
}

TEST(Evaluation, RelativeToTheBestSensorAndOrderedByKind) {
  Evaluation evaluation;
  evaluation.expectTracks("fused");
  evaluation.expectTracks("local");
  evaluation.expectSightings("fine");
  evaluation.expectSightings("silent");
  evaluation.addTruth(at(0.0), {{1, {0.0, 0.0, 0.0, 0.0}}});
  evaluation.addScan("coarse", scan(0.0, {sightingAt({0.02, 0.02}, 0.02)}, "a"));
  evaluation.addScan("fine", scan(0.0, {sightingAt({0.01, 0.01}, 0.01)}, "b"));
  evaluation.addScan("coarse", scan(0.0, {sightingAt({0.04, 0.04}, 0.04)}, "c"));  // two sensors on one topic
  TrackReport fused = report(0.0, {track(1, {0.005, 0.005, 0.0, 0.0})});
  fused.fused = true;
  evaluation.addTracks("fused", fused);
  evaluation.addTracks("local", report(0.0, {}));

  const auto rows = evaluation.rows();
  ASSERT_EQ(rows.size(), 6u);
  const std::vector<std::string> names = {"b", "", "a", "c", "tracker", "tracker"};
  for (std::size_t i = 0; i < names.size(); ++i) EXPECT_EQ(rows[i].name, names[i]) << i;
  EXPECT_EQ(rows[4].topic, "local");
  EXPECT_NEAR(rows[0].relative_rmse, 1.0, 1e-3);
  EXPECT_NEAR(rows[2].relative_rmse, 2.0, 1e-3);
  EXPECT_NEAR(rows[5].relative_rmse, 0.5, 1e-3);
  EXPECT_EQ(rows[4].coverage, 0.0);
  EXPECT_TRUE(std::isnan(rows[4].rmse));
  EXPECT_NEAR(evaluation.bestSigma(), 0.01, 1e-6);
}

TEST(Evaluation, WithAzimuthAloneTheElevationOfTheTruthIsNotUsed) {
  EvaluationParams params;
  params.channels = Channels::azimuth_only;
  Evaluation evaluation(params);
  evaluation.addTruth(at(0.0), {{1, {kPi - 0.01, 0.4, 0.1, 7.0}}});
  evaluation.addTracks("tracks", report(0.0, {track(1, {-kPi + 0.01, -0.2, 0.1, 0.0}, 0.02)}));
  Eigen::Matrix2d covariance = Eigen::Vector2d(0.01 * 0.01, 0.35 * 0.35).asDiagonal();
  evaluation.addScan("sightings", scan(0.0, {sightingOf({kPi - 0.02, 0.0}, covariance)}));
  const EvaluationRow tracks = rowOf(evaluation, "tracks"), sightings = rowOf(evaluation, "sightings");
  EXPECT_EQ(tracks.samples, 1u);
  EXPECT_NEAR(tracks.rmse, 0.02, 1e-9);
  EXPECT_NEAR(tracks.anees_position, 1.0, 1e-6);
  EXPECT_NEAR(tracks.gospa.missed(), 1.0, 1e-12);  // 20 mrad are beyond the cutoff of 10
  EXPECT_NEAR(sightings.rmse, 0.01, 1e-9);
  EXPECT_NEAR(sightings.stated_sigma, 0.01, 1e-9);
  EXPECT_EQ(tracks.dimensions, 1);
}

TEST(Evaluation, MessagesOutsideTheTruthAreCountedAsUnscored) {
  Evaluation evaluation;
  evaluation.addTruth(at(100.0), both(100.0));
  evaluation.addTracks("tracks", report(99.0, {track(1, motion(1, 99.0))}));  // before the truth
  evaluation.addTracks("tracks", report(100.0, {track(1, motion(1, 100.0))}));
  evaluation.addTracks("tracks", report(101.0, {track(1, motion(1, 101.0))}));  // waits in vain
  EXPECT_EQ(rowOf(evaluation, "tracks").samples, 1u);
  EXPECT_EQ(rowOf(evaluation, "tracks").unscored, 2u);
  EXPECT_EQ(rowOf(evaluation, "tracks").unmatched, 0u);
}

TEST(Evaluation, KeepsNoMoreThanItsMemory) {
  EvaluationParams params;
  params.truth_memory = 5.0;
  Evaluation evaluation(params);
  for (int i = 0; i <= 1000; ++i) evaluation.addTracks("tracks", report(0.1 * i, {}));
  // Without a truth all but the last five seconds were given up; they can still be scored.
  for (int i = 940; i <= 1000; ++i) evaluation.addTruth(at(0.1 * i), both(0.1 * i));
  EXPECT_EQ(rowOf(evaluation, "tracks").unscored, 1001u - 51u);
  evaluation.addTruth(at(200.0), both(200.0));
  evaluation.addTracks("tracks", report(100.0, {}));  // later than the memory reaches back
  EXPECT_EQ(rowOf(evaluation, "tracks").unscored, 1001u - 51u + 1u);
}

TEST(Evaluation, GoesOnWhenTimeJumpsBack) {
  Evaluation evaluation;
  for (int loop = 0; loop < 2; ++loop) {
    for (int i = 0; i <= 300; ++i) {
      const double t = 0.1 * i;
      evaluation.addTruth(at(t), both(t));
      evaluation.addTracks(
          "tracks", report(t, {track(10 * loop + 1, motion(1, t)), track(10 * loop + 2, motion(2, t))}));
    }
  }
  const EvaluationRow row = rowOf(evaluation, "tracks");
  EXPECT_EQ(row.samples, 2u * 2u * 301u);
  EXPECT_EQ(row.id_switches, 0u);  // another run: other ids are no switch
  EXPECT_EQ(row.breaks, 0u);
}

TEST(Evaluation, SilencesAreNoScoredTimeAndALoopStartsOtherTracks) {
  Evaluation evaluation;
  for (int loop = 0; loop < 2; ++loop) {
    for (const double t : {0.0, 1.0, 20.0, 21.5}) {
      evaluation.addTruth(at(t), {{1, motion(1, t)}});
      evaluation.addTracks("tracks", report(t, {track(1, loop == 0 ? motion(1, t) : motion(2, t))}));
    }
  }
  const EvaluationRow row = rowOf(evaluation, "tracks");
  EXPECT_NEAR(row.scored_time, 2.0 * 2.5, 1e-9);
  EXPECT_EQ(row.tracks, 2u);
  EXPECT_EQ(row.false_tracks, 1u);  // that of the second loop
  EXPECT_EQ(row.appearances, 4u);
  EXPECT_EQ(row.never_confirmed, 2u);
}

TEST(Evaluation, ListenersAreCalledForWhatIsScored) {
  Evaluation evaluation;
  int pairs = 0, reports = 0;
  evaluation.listen({[&](const ScoredPair& pair) {
                       ++pairs;
                       EXPECT_NEAR(pair.error.position.y(), 0.004, 1e-12);
                       EXPECT_EQ(pair.target, 1u);
                       EXPECT_EQ(pair.track, 9u);
                       EXPECT_EQ(pair.topic, "tracks");
                     },
                     [&](const ScoredReport& scored) {
                       ++reports;
                       EXPECT_EQ(scored.gospa.missed, 1);
                     }});
  evaluation.addTruth(at(0.0), both(0.0));
  evaluation.addTracks("tracks", report(0.0, {track(9, motion(1, 0.0) + kOffset)}));
  EXPECT_EQ(pairs, 1);
  EXPECT_EQ(reports, 1);
}

}  // namespace
