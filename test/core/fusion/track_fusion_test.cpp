#include "sightline/core/fusion/track_fusion.h"

#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>

#include "sightline/core/model/chi_square.h"
#include "sightline/core/model/sphere.h"

#include "support/local_tracks.h"

namespace sightline::core {
namespace {

using Eigen::Vector2d;
using test::at;
using test::localTrack;
using test::reasonsOf;
using test::reportOf;
using test::sourcesOf;
using Names = std::vector<std::string>;

Track withStatus(Track track, TrackStatus status) {
  track.status = status;
  return track;
}

Track lastSeen(Track track, double t) {
  track.last_sighting = at(t);
  return track;
}

Track seenBy(Track track, const Names& sensors) {
  track.sources = sensors;
  return track;
}

TEST(TrackFusion, TwoTracksOfOneTargetBecomeOneThatIsSurerThanBoth) {
  TrackFusion fusion({});
  fusion.onReport(reportOf("a", 1.0, {localTrack(1, {0.1, 0.2}, 1e-3)}));
  const FusionReport report = fusion.onReport(reportOf("b", 1.0, {localTrack(5, {0.1005, 0.2}, 2e-3)}));
  ASSERT_EQ(report.tracks.size(), 1u);
  const FusedTrack& fused = report.tracks[0];
  EXPECT_EQ(report.time, at(1.0));
  EXPECT_EQ(fused.track.id, 1u);
  EXPECT_EQ(fused.track.status, TrackStatus::confirmed);
  EXPECT_EQ(fused.track.sources, (Names{"a", "b"}));
  EXPECT_EQ(sourcesOf(fused), (Names{"a 1", "b 5"}));
  EXPECT_GT(fused.sources[0].weight, fused.sources[1].weight);
  EXPECT_NEAR(fused.sources[0].weight + fused.sources[1].weight, 1.0, 1e-12);
  EXPECT_GT(fused.sources[0].distance_squared, 0.0);
  EXPECT_LT(fused.track.state.covariance(0, 0), 1e-6);
  EXPECT_GT(fused.track.state.mean(0), 0.1);
  EXPECT_LT(fused.track.state.mean(0), 0.1005);
  EXPECT_TRUE(report.left_out.empty());
  EXPECT_FALSE(report.refusal);
}

TEST(TrackFusion, SingleSourcePassesThroughToTheLastBit) {
  for (const double elevation : {0.2, 1.0, 1.5, 1.5707}) {
    TrackFusion fusion({});
    const Track local = localTrack(3, {3.1, elevation}, 1e-4, {0.02, -0.01});
    const FusionReport report = fusion.onReport(reportOf("a", 1.0, {local}));
    ASSERT_EQ(report.tracks.size(), 1u);
    EXPECT_EQ(report.tracks[0].track.state.mean, local.state.mean);
    EXPECT_EQ(report.tracks[0].track.state.covariance, local.state.covariance);
    EXPECT_EQ(report.tracks[0].sources[0].weight, 1.0);
    EXPECT_TRUE(std::isnan(report.tracks[0].sources[0].distance_squared)) << "nobody to compare with";
  }
}

TEST(TrackFusion, OlderReportIsPredictedToTheCommonTimeWithGrowingCovariance) {
  TrackFusion fusion({});
  const Vector2d rates(0.3, -0.1);
  fusion.onReport(reportOf("a", 1.0, {localTrack(1, {0.1, 0.2}, 1e-3, rates)}));
  const FusionReport report =
      fusion.onReport(reportOf("b", 1.2, {localTrack(1, Vector2d(0.1, 0.2) + 0.2 * rates, 1e-3, rates)}));
  ASSERT_EQ(report.tracks.size(), 1u);
  const FusedTrack& fused = report.tracks[0];
  ASSERT_EQ(sourcesOf(fused), (Names{"a 1", "b 1"}));
  EXPECT_TRUE(fused.track.state.angles().isApprox(Vector2d(0.16, 0.18), 1e-9)) << fused.track.state.angles();
  EXPECT_NEAR(fused.sources[0].age, 0.2, 1e-9);
  EXPECT_NEAR(fused.sources[1].age, 0.0, 1e-9);
  EXPECT_LT(fused.sources[0].weight, 0.3) << "a prediction over a memory's length counts less";
}

TEST(TrackFusion, ARoundIsFusedOnceToWhatFusingAtEveryReportGives) {
  TrackFusionParams params;
  params.rule = FusionRule::weighted_covariance;  // of states alone, without memory
  TrackFusion in_rounds(params), at_once(params);
  std::mt19937_64 random(5);
  std::normal_distribution<double> noise(0.0, 1e-3);
  int rounds = 0;
  for (int k = 0; k < 30; ++k) {
    for (const char* tracker : {"a", "b", "c"}) {
      Track track = localTrack(1, Vector2d(0.1 + noise(random), 0.2), 1e-3);
      const LocalReport report = reportOf(tracker, 1.0 + 0.1 * k, {track});
      const FusionReport last = at_once.onReport(report);
      ASSERT_FALSE(in_rounds.take(report));
      if (!in_rounds.isDue()) continue;
      const FusionReport fused = in_rounds.fuse();
      EXPECT_FALSE(in_rounds.hasNewReports());
      if (k < 2) continue;
      ++rounds;
      ASSERT_EQ(fused.tracks.size(), 1u);
      EXPECT_EQ(fused.time, at(1.0 + 0.1 * k));
      EXPECT_EQ(sourcesOf(fused.tracks[0]), (Names{"a 1", "b 1", "c 1"})) << k;
      EXPECT_EQ(fused.tracks[0].track.id, last.tracks.at(0).track.id);
      EXPECT_EQ(fused.tracks[0].track.hits, last.tracks[0].track.hits) << "every report is a hit";
      EXPECT_TRUE(fused.tracks[0].track.state.mean.isApprox(last.tracks[0].track.state.mean, 1e-9));
      EXPECT_TRUE(
          fused.tracks[0].track.state.covariance.isApprox(last.tracks[0].track.state.covariance, 1e-9));
    }
  }
  EXPECT_EQ(rounds, 28);
}

TEST(TrackFusion, TwoTargetsStayTwo) {
  TrackFusion fusion({});
  fusion.onReport(reportOf("a", 1.0, {localTrack(1, {0.1, 0.2}), localTrack(2, {0.13, 0.2})}));
  const FusionReport report =
      fusion.onReport(reportOf("b", 1.0, {localTrack(1, {0.13, 0.2}), localTrack(2, {0.1, 0.2})}));
  ASSERT_EQ(report.tracks.size(), 2u);
  EXPECT_EQ(sourcesOf(report.tracks[0]), (Names{"a 1", "b 2"}));
  EXPECT_EQ(sourcesOf(report.tracks[1]), (Names{"a 2", "b 1"}));
}

TEST(TrackFusion, AssociationIsOptimalNotGreedy) {
  // b 1 is nearest to a 1, but so is b 2, which fits nothing else.
  TrackFusion fusion({});
  fusion.onReport(reportOf("a", 1.0, {localTrack(1, {0.0, 0.0}), localTrack(2, {4e-3, 0.0})}));
  const FusionReport report =
      fusion.onReport(reportOf("b", 1.0, {localTrack(1, {1.5e-3, 0.0}), localTrack(2, {-2.5e-3, 0.0})}));
  ASSERT_EQ(report.tracks.size(), 2u);
  EXPECT_EQ(sourcesOf(report.tracks[0]), (Names{"a 1", "b 2"}));
  EXPECT_EQ(sourcesOf(report.tracks[1]), (Names{"a 2", "b 1"}));
}

TEST(TrackFusion, TracksOfOneTrackerAreNeverFused) {
  TrackFusion fusion({});
  const FusionReport report =
      fusion.onReport(reportOf("a", 1.0, {localTrack(1, {0.1, 0.2}), localTrack(2, {0.1001, 0.2})}));
  EXPECT_EQ(report.tracks.size(), 2u);
}

TEST(TrackFusion, TentativeTrackStartsNothingAndIsLeftOut) {
  TrackFusion fusion({});
  const Track tentative = withStatus(localTrack(1, {0.1, 0.2}), TrackStatus::tentative);
  FusionReport report = fusion.onReport(reportOf("a", 1.0, {tentative}));
  EXPECT_TRUE(report.tracks.empty());
  EXPECT_EQ(reasonsOf(report.left_out), (Names{"a 1 tentative"}));

  fusion.onReport(reportOf("b", 1.0, {localTrack(1, {0.1, 0.2})}));
  report = fusion.onReport(reportOf("a", 1.1, {tentative}));
  ASSERT_EQ(report.tracks.size(), 1u);
  EXPECT_EQ(sourcesOf(report.tracks[0]), (Names{"b 1"}));
  EXPECT_EQ(reasonsOf(report.left_out), (Names{"a 1 tentative"}));
}

TEST(TrackFusion, SupporterStaysBeyondTheGateUntilItContradictsClearlyAndForLong) {
  TrackFusion fusion({});
  const auto bReportsAt = [&fusion](double t, double azimuth) {
    fusion.onReport(reportOf("a", t, {localTrack(1, {0.0, 0.0})}));
    return fusion.onReport(reportOf("b", t, {localTrack(1, {azimuth, 0.0})})).tracks;
  };
  const double threshold = chiSquareQuantile4(TrackFusionParams{}.gate_probability);
  // Along azimuth alone the distance squared of two equal sources is azimuth^2 / (2 sigma^2) * 2.
  const auto azimuthFor = [](double distance_squared) { return 1e-3 * std::sqrt(distance_squared); };
  EXPECT_EQ(bReportsAt(1.0, azimuthFor(1.4 * threshold)).size(), 2u) << "outside the gate: no joining";
  EXPECT_EQ(bReportsAt(1.1, azimuthFor(0.5 * threshold)).size(), 1u);
  EXPECT_EQ(bReportsAt(1.2, azimuthFor(1.4 * threshold)).at(0).sources.size(), 2u)
      << "outside the gate: staying";

  for (const double t : {1.3, 1.5, 1.7}) {  // contradicting, but not for half a second
    const auto tracks = bReportsAt(t, azimuthFor(2.4 * threshold));
    ASSERT_EQ(tracks.size(), 1u);
    EXPECT_EQ(sourcesOf(tracks[0]), (Names{"a 1"}));
    EXPECT_EQ(reasonsOf(tracks[0].left_out), (Names{"b 1 contradiction"}));
    EXPECT_NEAR(tracks[0].left_out[0].distance_squared, 2.4 * threshold, 1e-6);
  }
  EXPECT_EQ(bReportsAt(1.75, azimuthFor(1.4 * threshold)).at(0).sources.size(), 2u) << "it agrees again";
  EXPECT_EQ(bReportsAt(1.8, azimuthFor(2.4 * threshold)).size(), 1u);
  EXPECT_EQ(bReportsAt(2.2, azimuthFor(2.4 * threshold)).size(), 1u) << "counted from the new beginning";
  EXPECT_EQ(bReportsAt(2.3, azimuthFor(2.4 * threshold)).size(), 2u);
}

TEST(TrackFusion, WorstOfThreeIsTheOneThatIsLeftOutAndGoes) {
  TrackFusion fusion({});
  FusionReport report;
  for (const char* tracker : {"a", "b", "c"})
    fusion.onReport(reportOf(tracker, 1.0, {localTrack(1, {0.0, 0.0})}));
  for (int k = 0; k < 7; ++k) {
    // The good tracks report after the bad one; none of them may be taken for the culprit.
    const double t = 1.1 + 0.1 * k;
    fusion.onReport(reportOf("a", t, {localTrack(1, {0.02, 0.0})}));
    fusion.onReport(reportOf("b", t, {localTrack(1, {0.0, 0.0})}));
    report = fusion.onReport(reportOf("c", t, {localTrack(1, {0.0, 0.0})}));
    EXPECT_EQ(sourcesOf(report.tracks.at(0)), (Names{"b 1", "c 1"})) << t;
    EXPECT_EQ(report.tracks.size(), k < 5 ? 1u : 2u) << t;
  }
  EXPECT_EQ(sourcesOf(report.tracks[1]), (Names{"a 1"}));
}

TEST(TrackFusion, TracksThatTurnOutToBeOneKeepTheOlderId) {
  TrackFusion fusion({});
  fusion.onReport(reportOf("a", 1.0, {localTrack(1, {0.0, 0.0})}));
  EXPECT_EQ(fusion.onReport(reportOf("b", 1.0, {localTrack(1, {0.02, 0.0})})).tracks.size(), 2u);
  fusion.onReport(reportOf("a", 1.1, {localTrack(1, {0.019, 0.0})}));
  const FusionReport report = fusion.onReport(reportOf("b", 1.1, {localTrack(1, {0.02, 0.0})}));
  ASSERT_EQ(report.tracks.size(), 1u);
  EXPECT_EQ(report.tracks[0].track.id, 1u);
  EXPECT_EQ(sourcesOf(report.tracks[0]), (Names{"a 1", "b 1"}));
}

TEST(TrackFusion, TrackThatFitsBetterTakesThePlaceOfOneThatStrayedAndStartsNothingMeanwhile) {
  // c 1 strays, not so far that it contradicts; then c 2 appears where the target is.
  TrackFusion fusion({});
  FusionReport report;
  for (int k = 0; k <= 8; ++k) {
    const double t = 1.0 + 0.1 * k;
    for (const char* tracker : {"a", "b"}) fusion.onReport(reportOf(tracker, t, {localTrack(1, {0.0, 0.0})}));
    std::vector<Track> tracks{localTrack(1, {k == 0 ? 0.0 : 4e-3, 0.0})};
    if (k > 1) tracks.push_back(localTrack(2, {0.0, 0.0}));
    report = fusion.onReport(reportOf("c", t, tracks));
    if (k < 7) {
      ASSERT_EQ(report.tracks.size(), 1u) << t;
      EXPECT_EQ(sourcesOf(report.tracks[0]), (Names{"a 1", "b 1", "c 1"})) << t;
    }
    if (k > 1 && k < 7) {
      EXPECT_EQ(reasonsOf(report.left_out), (Names{"c 2 contested"})) << t;
    }
  }
  ASSERT_EQ(report.tracks.size(), 2u);
  EXPECT_EQ(report.tracks[0].track.id, 1u);
  EXPECT_EQ(sourcesOf(report.tracks[0]), (Names{"a 1", "b 1", "c 2"}));
  EXPECT_EQ(sourcesOf(report.tracks[1]), (Names{"c 1"}));
}

TEST(TrackFusion, TracksOfATrackerThatTookOneTargetForTheOtherChangePlacesWithoutNewIds) {
  TrackFusion fusion({});
  const double apart = 5e-3;  // sigma 1 mrad: they contradict, but not so much that they leave by themselves
  FusionReport report;
  for (int k = 0; k <= 8; ++k) {
    const double t = 1.0 + 0.1 * k;
    for (const char* tracker : {"a", "b"}) {
      fusion.onReport(reportOf(tracker, t, {localTrack(1, {0.0, 0.0}), localTrack(2, {apart, 0.0})}));
    }
    const bool exchanged = k > 0;
    report = fusion.onReport(reportOf(
        "c", t,
        {localTrack(1, {exchanged ? apart : 0.0, 0.0}), localTrack(2, {exchanged ? 0.0 : apart, 0.0})}));
    ASSERT_EQ(report.tracks.size(), 2u) << t;
    EXPECT_EQ(report.tracks[1].track.id, 2u);
  }
  EXPECT_EQ(sourcesOf(report.tracks[0]), (Names{"a 1", "b 1", "c 2"}));
  EXPECT_EQ(sourcesOf(report.tracks[1]), (Names{"a 2", "b 2", "c 1"}));
}

TEST(TrackFusion, VagueTrackDoesNotPushOutASharpOneThatIsAlittleOff) {
  TrackFusion fusion({});
  FusionReport report;
  for (int k = 0; k <= 12; ++k) {
    const double t = 1.0 + 0.1 * k;
    for (const char* tracker : {"a", "b"}) fusion.onReport(reportOf(tracker, t, {localTrack(1, {0.0, 0.0})}));
    report =
        fusion.onReport(reportOf("c", t, {localTrack(1, {3e-3, 0.0}), localTrack(2, {1e-3, 0.0}, 2e-2)}));
  }
  EXPECT_EQ(sourcesOf(report.tracks[0]), (Names{"a 1", "b 1", "c 1"}));
}

TEST(TrackFusion, CrossingTargetsAreNotExchanged) {
  TrackFusion fusion({});
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal(0.0, 1e-3);
  const double speed = 0.05;
  FusionReport report;
  for (int k = 0; k <= 200; ++k) {
    const double t = 1.0 + 0.03 * k, x = speed * (t - 4.0);
    for (const char* tracker : {"a", "b"}) {
      const Vector2d up(x + normal(random), x + normal(random)),
          down(x + normal(random), -x + normal(random));
      report = fusion.onReport(reportOf(
          tracker, t, {localTrack(1, up, 1e-3, {speed, speed}), localTrack(2, down, 1e-3, {speed, -speed})}));
    }
    ASSERT_EQ(report.tracks.size(), 2u) << t;
    EXPECT_EQ(sourcesOf(report.tracks[0]), (Names{"a 1", "b 1"})) << t;
    EXPECT_EQ(sourcesOf(report.tracks[1]), (Names{"a 2", "b 2"})) << t;
  }
}

TEST(TrackFusion, DeadSourceIsLeftOutAsStaleAndTheOtherGoesOn) {
  TrackFusion fusion({});
  FusionReport report;
  for (int k = 0; k <= 30; ++k) {
    const double t = 1.0 + 0.1 * k;
    if (k < 10) fusion.onReport(reportOf("dead", t, {localTrack(1, {0.1, 0.2})}));
    report = fusion.onReport(reportOf("live", t, {localTrack(1, {0.1, 0.2})}));
    ASSERT_EQ(report.tracks.size(), 1u);
    EXPECT_EQ(report.tracks[0].track.id, 1u);
  }
  EXPECT_EQ(sourcesOf(report.tracks[0]), (Names{"live 1"}));
  EXPECT_EQ(reasonsOf(report.tracks[0].left_out), (Names{"dead 1 stale"}));
  EXPECT_NEAR(report.tracks[0].left_out[0].age, 2.1, 1e-9);

  report = fusion.onReport(reportOf("dead", 4.0, {localTrack(1, {0.1, 0.2})}));
  ASSERT_EQ(report.tracks.size(), 1u);
  EXPECT_EQ(sourcesOf(report.tracks[0]), (Names{"dead 1", "live 1"})) << "it came back";
}

TEST(TrackFusion, ATrackThatNobodyReportsIsNotShownAndItsIdIsNotUsedAgain) {
  TrackFusion fusion({});
  fusion.onReport(reportOf("a", 1.0, {localTrack(1, {0.1, 0.2}, 1e-3, {0.1, 0.0})}));
  EXPECT_TRUE(fusion.onReport(reportOf("a", 1.5, {})).tracks.empty());
  EXPECT_TRUE(fusion.onReport(reportOf("a", 2.1, {})).tracks.empty());
  const FusionReport report = fusion.onReport(reportOf("a", 2.2, {localTrack(2, {0.1, 0.2})}));
  ASSERT_EQ(report.tracks.size(), 1u);
  EXPECT_EQ(report.tracks[0].track.id, 2u);
}

TEST(TrackFusion, ALocalTrackThatReturnsUnderItsIdGoesOnWithItsGlobalTrack) {
  for (const double gap : {0.5, 3.0, 6.0}) {
    TrackFusion fusion({});
    fusion.onReport(reportOf("a", 1.0, {localTrack(1, {0.1, 0.2}, 1e-3, {0.1, 0.0})}));
    for (double t = 1.1; t < 1.0 + gap - 0.05; t += 0.1)
      EXPECT_TRUE(fusion.onReport(reportOf("a", t, {})).tracks.empty());
    Track returned = localTrack(1, {0.1 + 0.1 * gap, 0.25}, 1e-3, {0.1, 0.0});
    ++returned.hits;
    const FusionReport report = fusion.onReport(reportOf("a", 1.0 + gap, {returned}));
    ASSERT_EQ(report.tracks.size(), 1u);
    EXPECT_EQ(report.tracks[0].track.id, 1u) << gap << " s, also after the global track was deleted";
    EXPECT_NEAR(report.tracks[0].track.state.mean(1), 0.25, 1e-9);
  }
}

TEST(TrackFusion, LocalTrackReplacedByAnotherIdContinuesTheGlobalTrack) {
  TrackFusion fusion({});
  fusion.onReport(reportOf("a", 1.0, {localTrack(1, {0.1, 0.2}, 1e-3, {0.1, 0.0})}));
  const FusionReport report =
      fusion.onReport(reportOf("a", 1.5, {localTrack(2, {0.15, 0.2}, 1e-3, {0.1, 0.0})}));
  ASSERT_EQ(report.tracks.size(), 1u);
  EXPECT_EQ(report.tracks[0].track.id, 1u);
  EXPECT_EQ(sourcesOf(report.tracks[0]), (Names{"a 2"}));
}

TEST(TrackFusion, CoastingSourceCountsForAWhileThenOnlyIfItIsAlone) {
  TrackFusion fusion({});
  const auto coastingSince = [](double t) {
    return lastSeen(withStatus(localTrack(1, {0.1, 0.2}, 2e-3), TrackStatus::coasting), t);
  };
  fusion.onReport(reportOf("a", 1.0, {localTrack(1, {0.1, 0.2})}));
  fusion.onReport(reportOf("b", 1.0, {localTrack(1, {0.1, 0.2})}));
  FusionReport report = fusion.onReport(reportOf("b", 1.3, {coastingSince(1.0)}));
  EXPECT_EQ(sourcesOf(report.tracks[0]), (Names{"a 1", "b 1"}));

  fusion.onReport(reportOf("a", 1.7, {localTrack(1, {0.1, 0.2})}));
  report = fusion.onReport(reportOf("b", 1.7, {coastingSince(1.0)}));
  EXPECT_EQ(sourcesOf(report.tracks[0]), (Names{"a 1"}));
  EXPECT_EQ(reasonsOf(report.tracks[0].left_out), (Names{"b 1 coasting"}));
  EXPECT_EQ(report.tracks[0].track.status, TrackStatus::confirmed);

  fusion.onReport(reportOf("a", 1.8, {}));
  for (double t = 1.9; t < 6.0; t += 0.1) report = fusion.onReport(reportOf("b", t, {coastingSince(1.0)}));
  ASSERT_EQ(report.tracks.size(), 1u) << "as long as a local track lives, so does the global one";
  EXPECT_EQ(sourcesOf(report.tracks[0]), (Names{"b 1"}));
  EXPECT_EQ(report.tracks[0].track.status, TrackStatus::coasting);
}

TEST(TrackFusion, WhereNoMajorityAgreesNobodyIsLeftOut) {
  // Five sharp local tracks that differ by many of their sigmas, and a vague one far off: to leave out the
  // worst, one after the other, would end with the vague one alone.
  TrackFusion fusion({});
  const char* names[] = {"a", "b", "c", "d", "e"};
  for (const char* name : names) fusion.onReport(reportOf(name, 1.0, {localTrack(1, {0.1, 0.2}, 3e-4)}));
  fusion.onReport(reportOf("f", 1.0, {localTrack(1, {0.1, 0.2}, 5e-3)}));
  FusionReport report;
  for (int i = 0; i < 5; ++i)
    report = fusion.onReport(reportOf(names[i], 1.05, {localTrack(1, {0.1 + 0.003 * i, 0.2}, 3e-4)}));
  report = fusion.onReport(reportOf("f", 1.05, {localTrack(1, {0.13, 0.2}, 5e-3)}));
  ASSERT_FALSE(report.tracks.empty());
  EXPECT_NEAR(report.tracks[0].track.state.mean(0), 0.106, 0.003);
}

TEST(TrackFusion, CoastingTrackStartsNothing) {
  TrackFusion fusion({});
  const Track coasting = lastSeen(withStatus(localTrack(1, {0.1, 0.2}), TrackStatus::coasting), 0.9);
  const FusionReport report = fusion.onReport(reportOf("a", 1.0, {coasting}));
  EXPECT_TRUE(report.tracks.empty());
  EXPECT_EQ(reasonsOf(report.left_out), (Names{"a 1 coasting"}));
}

TEST(TrackFusion, GarbageCovarianceIsLeftOutWithItsReasonAndTheTrackGoesOn) {
  Track garbage = localTrack(1, {0.1, 0.2});
  for (const double value : {std::nan(""), -1e-6, 1e-4, std::numeric_limits<double>::infinity()}) {
    garbage.state.covariance(0, 2) = garbage.state.covariance(2, 0) =
        value;  // not finite, or correlation above one
    if (value < 0.0) garbage.state.covariance(1, 1) = value;
    TrackFusion fusion({});
    fusion.onReport(reportOf("a", 1.0, {localTrack(1, {0.1, 0.2})}));
    fusion.onReport(reportOf("b", 1.0, {localTrack(1, {0.1, 0.2})}));
    FusionReport report = fusion.onReport(reportOf("b", 1.1, {garbage}));
    ASSERT_EQ(report.tracks.size(), 1u);
    EXPECT_EQ(sourcesOf(report.tracks[0]), (Names{"a 1"}));
    EXPECT_EQ(reasonsOf(report.tracks[0].left_out), (Names{"b 1 invalid"}));
    report = fusion.onReport(reportOf("c", 1.1, {garbage}));
    EXPECT_EQ(reasonsOf(report.left_out), (Names{"c 1 invalid"}));
    report = fusion.onReport(reportOf("b", 1.2, {localTrack(1, {0.1, 0.2})}));
    EXPECT_EQ(sourcesOf(report.tracks[0]), (Names{"a 1", "b 1"})) << "mended";
  }
}

TEST(TrackFusion, LateReportIsRefusedAndChangesNothing) {
  TrackFusion fusion({});
  fusion.onReport(reportOf("a", 1.0, {localTrack(1, {0.1, 0.2})}));
  const FusionReport before = fusion.onReport(reportOf("b", 1.0, {localTrack(1, {0.1, 0.2})}));
  const FusionReport report = fusion.onReport(reportOf("b", 0.9, {localTrack(1, {0.3, 0.2})}));
  EXPECT_EQ(report.refusal.value_or(Refusal{}).kind, "late");
  EXPECT_EQ(report.time, before.time);
  ASSERT_EQ(report.tracks.size(), 1u);
  EXPECT_EQ(report.tracks[0].track.state.mean, before.tracks[0].track.state.mean);
  EXPECT_EQ(reasonsOf(report.left_out), (Names{"b 1 late"}));
}

TEST(TrackFusion, ReportOlderThanTheNewestIsStillUsed) {
  TrackFusion fusion({});
  fusion.onReport(reportOf("a", 1.0, {localTrack(1, {0.1, 0.2})}));
  const FusionReport report = fusion.onReport(reportOf("b", 0.8, {localTrack(1, {0.1, 0.2})}));
  EXPECT_EQ(report.time, at(1.0));
  ASSERT_EQ(report.tracks.size(), 1u);
  EXPECT_EQ(sourcesOf(report.tracks[0]), (Names{"a 1", "b 1"}));
}

TEST(TrackFusion, RestartedTrackerWithAnotherTargetUnderTheSameIdIsNotConfused) {
  TrackFusion fusion({});
  Track old = localTrack(1, {0.1, 0.2});
  old.hits = 500;
  fusion.onReport(reportOf("a", 1.0, {old}));
  fusion.onReport(reportOf("b", 1.0, {localTrack(1, {0.1, 0.2})}));
  // Alone it would drag its global track along; so b is silent about the target from now on.
  fusion.onReport(reportOf("b", 1.05, {}));
  Track other = localTrack(1, {0.9, -0.2});
  other.hits = 3;
  const FusionReport report = fusion.onReport(reportOf("a", 1.1, {other}));
  ASSERT_EQ(report.tracks.size(), 1u);  // the first target is not seen any more
  EXPECT_EQ(report.tracks[0].track.id, 2u);
  EXPECT_NEAR(report.tracks[0].track.state.mean(0), 0.9, 1e-9);
  EXPECT_EQ(sourcesOf(report.tracks[0]), (Names{"a 1"}));
}

TEST(TrackFusion, RestartedTrackerWithTheSameTargetContinuesIt) {
  TrackFusion fusion({});
  Track old = localTrack(1, {0.1, 0.2}),
        tentative = withStatus(localTrack(1, {0.1, 0.2}), TrackStatus::tentative);
  old.hits = 500, tentative.hits = 1;
  fusion.onReport(reportOf("a", 1.0, {old}));
  EXPECT_TRUE(fusion.onReport(reportOf("a", 1.1, {tentative})).tracks.empty());
  const FusionReport report = fusion.onReport(reportOf("a", 1.3, {localTrack(1, {0.1, 0.2})}));
  ASSERT_EQ(report.tracks.size(), 1u);
  EXPECT_EQ(report.tracks[0].track.id, 1u);
  EXPECT_EQ(sourcesOf(report.tracks[0]), (Names{"a 1"}));
}

TEST(TrackFusion, WhenAllStampsStartAgainSoDoesTheFusionWithNewIds) {
  TrackFusion fusion({});
  for (const char* tracker : {"a", "b"})
    fusion.onReport(reportOf(tracker, 100.0, {localTrack(1, {0.1, 0.2})}));
  FusionReport report = fusion.onReport(reportOf("a", 5.0, {localTrack(1, {0.1, 0.2})}));
  EXPECT_EQ(report.time, at(100.0));
  EXPECT_EQ(sourcesOf(report.tracks[0]), (Names{"b 1"})) << "a is 95 s behind";
  report = fusion.onReport(reportOf("b", 5.0, {localTrack(1, {0.1, 0.2})}));
  EXPECT_EQ(report.time, at(5.0));
  ASSERT_EQ(report.tracks.size(), 1u);
  EXPECT_EQ(report.tracks[0].track.id, 2u);
  EXPECT_EQ(sourcesOf(report.tracks[0]), (Names{"a 1", "b 1"}));
}

TEST(TrackFusion, SharedSensorContributesOnceThroughTheSurerTrack) {
  const auto report_of = [](TrackFusion& fusion) {
    fusion.onReport(reportOf("group", 1.0, {seenBy(localTrack(1, {0.1, 0.2}, 2e-3), {"s1", "s2"})}));
    fusion.onReport(reportOf("all", 1.0, {seenBy(localTrack(1, {0.1, 0.2}, 1e-3), {"s1", "s2", "s3"})}));
    return fusion.onReport(reportOf("other", 1.0, {seenBy(localTrack(1, {0.1, 0.2}, 4e-3), {"s4"})}));
  };
  TrackFusionParams params;
  for (const FusionRule rule : {FusionRule::weighted_covariance, FusionRule::cross_covariance}) {
    params.rule = rule;
    TrackFusion fusion(params);
    const FusionReport report = report_of(fusion);
    ASSERT_EQ(report.tracks.size(), 1u);
    EXPECT_EQ(sourcesOf(report.tracks[0]), (Names{"all 1", "other 1"}));
    EXPECT_EQ(reasonsOf(report.tracks[0].left_out), (Names{"group 1 shared sensor"}));
    EXPECT_NE(report.tracks[0].left_out[0].reason.value().detail.find("s1"), std::string::npos);
  }
  params.rule = FusionRule::covariance_intersection;
  TrackFusion intersection(params);
  EXPECT_EQ(report_of(intersection).tracks[0].sources.size(), 3u) << "holds for any correlation";
  params.rule = FusionRule::weighted_covariance;
  params.allow_shared_sensors = true;
  TrackFusion allowed(params);
  EXPECT_EQ(report_of(allowed).tracks[0].sources.size(), 3u);
}

TEST(TrackFusion, SurerOfTwoThatShareASensorChangesOnlyWhenItIsClearlySurer) {
  TrackFusionParams params;
  params.rule = FusionRule::weighted_covariance;
  TrackFusion fusion(params);
  const auto used = [&fusion](double t, double sigma_a, double sigma_b) {
    fusion.onReport(reportOf("a", t, {seenBy(localTrack(1, {0.1, 0.2}, sigma_a), {"s1"})}));
    return sourcesOf(
        fusion.onReport(reportOf("b", t, {seenBy(localTrack(1, {0.1, 0.2}, sigma_b), {"s1"})})).tracks[0]);
  };
  EXPECT_EQ(used(1.0, 1.0e-3, 1.1e-3), (Names{"a 1"}));
  EXPECT_EQ(used(1.1, 1.1e-3, 1.0e-3), (Names{"a 1"}));
  EXPECT_EQ(used(1.2, 2.0e-3, 1.0e-3), (Names{"b 1"}));
  EXPECT_EQ(used(1.3, 1.0e-3, 1.1e-3), (Names{"b 1"}));
}

TEST(TrackFusion, FusionIsNotFusedWithWhatItWasMadeOf) {
  TrackFusion fusion({});
  fusion.onReport(reportOf("a", 1.0, {localTrack(1, {0.1, 0.2}, 2e-3)}));
  const FusionReport report =
      fusion.onReport(reportOf("fusion", 1.0, {seenBy(localTrack(1, {0.1, 0.2}, 1e-3), {"a", "b"})}));
  EXPECT_EQ(sourcesOf(report.tracks[0]), (Names{"fusion 1"}));
  EXPECT_EQ(reasonsOf(report.tracks[0].left_out), (Names{"a 1 shared sensor"}));
}

TEST(TrackFusion, RegistrationSigmaWidensTheGateAlone) {
  TrackFusionParams params;
  const auto tracks = [](const TrackFusionParams& p) {
    TrackFusion fusion(p);
    fusion.onReport(reportOf("a", 1.0, {localTrack(1, {0.0, 0.0})}));
    return fusion.onReport(reportOf("b", 1.0, {localTrack(1, {0.01, 0.0})})).tracks;
  };
  EXPECT_EQ(tracks(params).size(), 2u);
  params.registration_sigma = 5e-3;
  const auto fused = tracks(params);
  ASSERT_EQ(fused.size(), 1u);
  EXPECT_LT(fused[0].track.state.covariance(0, 0), 1e-6);
}

TEST(TrackFusion, TargetAtTheWrapOfAzimuthIsOneTarget) {
  TrackFusion fusion({});
  fusion.onReport(reportOf("a", 1.0, {localTrack(1, {kPi - 2e-4, 0.3})}));
  const FusionReport report = fusion.onReport(reportOf("b", 1.0, {localTrack(1, {-kPi + 6e-4, 0.3})}));
  ASSERT_EQ(report.tracks.size(), 1u);
  EXPECT_NEAR(report.tracks[0].track.state.mean(0), -kPi + 2e-4, 1e-9);
}

TEST(TrackFusion, TargetAtTheZenithIsOneTarget) {
  // Two local tracks on either side of the pole, 0.4 mrad from it, of sigma 1 mrad: the azimuths say nothing.
  TrackFusion fusion({});
  Chart chart = Chart::around(Eigen::Vector3d::UnitZ());
  const auto near = [&chart](double x, double y) {
    AngularState state;
    state.mean << x, y, 0.01, 0.0;
    state.covariance = test::steadyCovariance(1e-3);
    Track track = localTrack(1, {0.0, 0.0});
    track.state = chart.toTracking(state);
    return track;
  };
  fusion.onReport(reportOf("a", 1.0, {near(4e-4, 1e-4)}));
  const FusionReport report = fusion.onReport(reportOf("b", 1.0, {near(-4e-4, 1e-4)}));
  ASSERT_EQ(report.tracks.size(), 1u);
  EXPECT_EQ(report.tracks[0].sources.size(), 2u);
  const Eigen::Vector2d fused = chart.coordinatesOf(directionOf(report.tracks[0].track.state.angles()));
  EXPECT_LT((fused - Eigen::Vector2d(0.0, 1e-4)).norm(), 1e-7);
  EXPECT_TRUE(test::isPositiveDefinite(report.tracks[0].track.state.covariance));
}

TEST(TrackFusion, TargetThatCirclesAndPassesNearTheZenithStaysOneTrack) {
  for (const FusionRule rule :
       {FusionRule::weighted_covariance, FusionRule::cross_covariance, FusionRule::covariance_intersection}) {
    TrackFusionParams params;
    params.rule = rule;
    TrackFusion fusion(params);
    double settled = 0.0;
    for (int k = 0; k < 2000; ++k) {
      const double t = 1.0 + 0.01 * k;
      AngularState state;  // a great circle that passes 1 degree from the zenith, 0.6 rad/s
      state.mean << 0.6 * t, 0.0, 0.6, 0.0;
      state.covariance = test::steadyCovariance(1e-3);
      const double tilt = 89.0 * kPi / 180.0;
      Eigen::Matrix3d R;
      R << 1.0, 0.0, 0.0, 0.0, std::cos(tilt), -std::sin(tilt), 0.0, std::sin(tilt), std::cos(tilt);
      Track track = localTrack(1, {0.0, 0.0});
      track.state = rotateState(state, R);
      const FusionReport report = fusion.onReport(reportOf(k % 2 ? "a" : "b", t, {track}));
      ASSERT_EQ(report.tracks.size(), 1u) << t;
      ASSERT_EQ(report.tracks[0].track.id, 1u) << t;
      ASSERT_EQ(report.tracks[0].sources.size(), k == 0 ? 1u : 2u) << t;
      const AngularState& fused = report.tracks[0].track.state;
      ASSERT_LT(angleBetween(directionOf(fused.angles()), directionOf(track.state.angles())), 2e-4) << t;
      ASSERT_TRUE(test::isPositiveDefinite(fused.covariance)) << t;
      // Seen along the circle every instant is like every other, through all changes of the chart.
      if (k < 100) continue;
      const double variance = rotateState(fused, R.transpose()).covariance(0, 0);
      if (k == 100) settled = variance;
      ASSERT_NEAR(variance / settled, 1.0, 0.02) << t;
    }
  }
}

TEST(TrackFusion, LimitsHold) {
  TrackFusionParams params;
  params.max_tracks = 5;
  TrackFusion fusion(params);
  std::vector<Track> many;
  for (std::uint32_t id = 1; id <= 20; ++id) many.push_back(localTrack(id, {0.1 * id, 0.0}));
  const FusionReport report = fusion.onReport(reportOf("a", 1.0, many));
  EXPECT_EQ(report.tracks.size(), 5u);
  ASSERT_EQ(report.left_out.size(), 15u);
  EXPECT_EQ(report.left_out[0].reason.value().kind, "limit");
}

TEST(TrackFusion, ResetForgetsEverythingButTheIds) {
  TrackFusion fusion({});
  fusion.onReport(reportOf("a", 100.0, {localTrack(1, {0.1, 0.2})}));
  fusion.reset();
  const FusionReport report = fusion.onReport(reportOf("a", 1.0, {localTrack(1, {0.1, 0.2})}));
  ASSERT_EQ(report.tracks.size(), 1u);
  EXPECT_EQ(report.tracks[0].track.id, 2u);
}

TEST(TrackFusion, SameReportsGiveTheSameResultToTheBit) {
  const auto run = [] {
    TrackFusion fusion({});
    std::mt19937_64 random(5);
    std::normal_distribution<double> normal(0.0, 1e-3);
    FusionReport report;
    for (int k = 0; k < 100; ++k) {
      for (const char* tracker : {"a", "b", "c"}) {
        report = fusion.onReport(
            reportOf(tracker, 1.0 + 0.03 * k, {localTrack(1, {normal(random), normal(random)})}));
      }
    }
    return report.tracks.at(0).track.state;
  };
  EXPECT_EQ(run().mean, run().mean);
  EXPECT_EQ(run().covariance, run().covariance);
}

TEST(TrackFusion, SurvivesAnyInput) {
  std::mt19937_64 random(17);
  const auto pick = [&random](int n) { return static_cast<int>(random() % static_cast<std::uint64_t>(n)); };
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (const FusionRule rule :
       {FusionRule::weighted_covariance, FusionRule::cross_covariance, FusionRule::covariance_intersection}) {
    TrackFusionParams params;
    params.rule = rule;
    TrackFusion fusion(params);
    double t = 50.0;
    std::uint32_t largest_id = 0;
    for (int k = 0; k < 4000; ++k) {
      t += 0.05 * uniform(random) + 0.03;
      if (pick(500) == 0) t = 50.0 * (1.0 + uniform(random));
      std::vector<Track> tracks;
      for (int n = pick(5); n > 0; --n) {
        const double sigma = std::pow(10.0, 3.0 * uniform(random) - 3.0);
        Track track =
            localTrack(static_cast<std::uint32_t>(pick(6)), {4.0 * uniform(random), 1.57 * uniform(random)},
                       sigma, {uniform(random), uniform(random)});
        track.status = static_cast<TrackStatus>(pick(4));
        track.hits = static_cast<std::uint32_t>(pick(100));
        if (pick(3) == 0) track.state.mean.head<2>() << 0.3, 0.4;  // now and then they agree
        if (pick(20) == 0)
          track.state.covariance(pick(4), pick(4)) = uniform(random) / static_cast<double>(pick(3));
        if (pick(40) == 0) track.state.mean(pick(4)) = std::nan("");
        if (pick(10) == 0) track.state.covariance *= 1e-12;
        tracks.push_back(track);
      }
      const FusionReport report = fusion.onReport(
          reportOf(std::string(1, static_cast<char>('a' + pick(4))), t + 0.1 * uniform(random), tracks));
      for (const FusedTrack& fused : report.tracks) {
        ASSERT_TRUE(test::isPositiveDefinite(fused.track.state.covariance)) << k;
        ASSERT_TRUE(fused.track.state.mean.allFinite()) << k;
        ASSERT_LE(std::abs(fused.track.state.mean(0)), kPi) << k;
        double sum = 0.0;
        for (const SourceTrack& source : fused.sources) sum += source.weight;
        if (!fused.sources.empty()) {
          ASSERT_NEAR(sum, 1.0, 1e-9) << k;
        }
        largest_id = std::max(largest_id, fused.track.id);
      }
    }
    EXPECT_GT(largest_id, 100u) << "tracks came and went";
  }
}

TEST(TrackFusion, ParametersOutOfRangeAreRefused) {
  const auto refused = [](auto spoil) {
    TrackFusionParams params;
    spoil(params);
    EXPECT_THROW(TrackFusion{params}, std::invalid_argument);
  };
  refused([](TrackFusionParams& p) { p.gate_probability = 1.0; });
  refused([](TrackFusionParams& p) { p.leave_factor = 0.5; });
  refused([](TrackFusionParams& p) { p.leave_after = -1.0; });
  refused([](TrackFusionParams& p) { p.registration_sigma = -1.0; });
  refused([](TrackFusionParams& p) { p.process_noise = std::nan(""); });
  refused([](TrackFusionParams& p) { p.reports.max_age = 0.0; });
  refused([](TrackFusionParams& p) { p.reports.forget_after = 0.5; });
  refused([](TrackFusionParams& p) { p.max_tracks = 0; });
}

TEST(TrackFusion, GateThresholdIsTheQuantileOfChiSquareWithFourDegreesOfFreedom) {
  EXPECT_NEAR(chiSquareQuantile4(0.95), 9.487729036781154, 1e-9);
  EXPECT_NEAR(chiSquareQuantile4(0.999), 18.46682695290317, 1e-9);
}

}  // namespace
}  // namespace sightline::core
