#include "sightline/core/fusion/fusion_report.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "sightline/core/fusion/global_tracks.h"

#include "support/local_tracks.h"

namespace sightline::core {
namespace {

using test::at;
using test::localTrack;
using test::reasonsOf;
using test::reportOf;
using Names = std::vector<std::string>;

LocalTrack reported(const Track& track, double t = 1.0) {
  return {track, at(t), {}};
}

GlobalTrack twoSupporters() {
  GlobalTrack track(7, at(1.0), {"a", 1}, reported(localTrack(1, {0.1, 0.2})), 0.0);
  track.join({"b", 4}, reported(localTrack(4, {0.1, 0.2})));
  track.compareSupporters(TrackerMisalignment(0.0));
  return track;
}

AngularState stateOf(double position_sigma, double elevation = 0.2) {
  AngularState state;
  state.mean << 0.1, elevation, 0.0, 0.0;
  state.covariance = test::steadyCovariance(position_sigma);
  return state;
}

TEST(FusionReport, SharesAreThoseOfThePositionGainsAndSumToOne) {
  std::vector<Eigen::Matrix4d> gains(2, Eigen::Matrix4d::Zero());
  gains[0].topLeftCorner<2, 2>().diagonal().setConstant(0.75);
  gains[1].topLeftCorner<2, 2>().diagonal().setConstant(0.25);
  gains[1].bottomRightCorner<2, 2>().diagonal().setConstant(1.0);
  const std::vector<double> shares = positionShares(gains);
  EXPECT_DOUBLE_EQ(shares[0], 0.75);
  EXPECT_DOUBLE_EQ(shares[1], 0.25);
  gains[1].topLeftCorner<2, 2>().diagonal().setConstant(-0.5);
  EXPECT_EQ(positionShares(gains), (std::vector<double>{1.0, 0.0})) << "no share is negative";
}

TEST(FusionReport, ContributorsAreListedWithTheirSharesAndTheTrackHasTheirStatus) {
  const GlobalTrack track = twoSupporters();
  FusedTrack description;
  describeFusion(track, {0, 1}, {0.6, 0.4}, {{"b", 1}}, description);
  ASSERT_EQ(test::sourcesOf(description), (Names{"a 1", "b 4"}));
  EXPECT_EQ(description.sources[0].weight, 0.6);
  EXPECT_FALSE(description.sources[0].reason);
  EXPECT_EQ(description.track.sources, (Names{"a", "b"}));
  EXPECT_EQ(description.track.status, TrackStatus::confirmed);
  EXPECT_EQ(description.track.hits, 1u) << "b reported";
  EXPECT_FALSE(description.withheld);
  describeFusion(track, {0}, {1.0}, {{"b", 1}}, description);
  EXPECT_EQ(description.track.hits, 1u) << "b did not contribute";
}

TEST(FusionReport, WithoutContributorsTheTrackCoasts) {
  FusedTrack description;
  describeFusion(twoSupporters(), {0}, {1.0}, {{"a", 1}}, description);
  describeCoasting(twoSupporters(), description);
  EXPECT_TRUE(description.sources.empty());
  EXPECT_EQ(description.track.status, TrackStatus::coasting);
  EXPECT_EQ(description.track.misses, 1u);
}

TEST(FusionReport, LeftOutSupportersAreListedWithTheirReasons) {
  FusedTrack description;
  describeLeftOut(twoSupporters(), {{1, Refusal{"stale", "long ago"}}}, description);
  EXPECT_EQ(reasonsOf(description.left_out), (Names{"b 4 stale"}));
  EXPECT_EQ(textOf(*description.left_out[0].reason), "stale: long ago");
}

TEST(FusionReport, ADistanceThatCannotBeComputedIsNotKnown) {
  Track no_number = localTrack(4, {0.1, 0.2});
  no_number.state.covariance(0, 1) = no_number.state.covariance(1, 0) = 1e3;  // indefinite
  GlobalTrack track(7, at(1.0), {"a", 1}, reported(localTrack(1, {0.1, 0.2})), 0.0);
  track.join({"b", 4}, reported(no_number));
  track.compareSupporters(TrackerMisalignment(0.0));
  FusedTrack fused;
  describeFusion(track, {0, 1}, {0.5, 0.5}, {{"b", 1}}, fused);
  ASSERT_EQ(fused.sources.size(), 2u);
  for (const SourceTrack& source : fused.sources) EXPECT_TRUE(std::isnan(source.distance_squared));
}

TEST(FusionReport, AStateThatMayBeAnywhereOrIsNotDeterminedIsNoTrack) {
  EXPECT_FALSE(whyNoTrack(stateOf(1e-3)));
  EXPECT_FALSE(whyNoTrack(stateOf(3.0)));
  EXPECT_EQ(whyNoTrack(stateOf(134.0)).value_or(Refusal{}).kind, "too uncertain");
  EXPECT_FALSE(whyNoTrack(stateOf(0.5, 1.57))) << "an azimuth says little near the zenith";
  AngularState one_axis = stateOf(1e-3);
  one_axis.covariance(1, 1) = 100.0;
  EXPECT_EQ(whyNoTrack(one_axis).value_or(Refusal{}).kind, "too uncertain");
  AngularState endless = stateOf(1e-3);
  endless.covariance(3, 3) = std::numeric_limits<double>::infinity();
  EXPECT_EQ(whyNoTrack(endless).value_or(Refusal{}).kind, "undetermined");
  AngularState negative = stateOf(1e-3);
  negative.covariance(2, 2) =
      0.1 * negative.covariance(0, 2) * negative.covariance(0, 2) / negative.covariance(0, 0);
  EXPECT_EQ(whyNoTrack(negative).value_or(Refusal{}).kind, "undetermined");
}

/// Reports of "a" with these tracks, and global tracks of them.
struct Fusion {
  explicit Fusion(const std::vector<Track>& tracks) {
    params.max_tracks = 1;
    reports.take(reportOf("a", 1.0, tracks));
    global.follow(reports, {{"a", 1}});
  }

  TrackFusionParams params;
  LocalReports reports{params.reports};
  GlobalTracks global{params};
};

TEST(FusionReport, LocalTracksThatSupportNothingAreListedWithTheReason) {
  Track tentative = localTrack(2, {0.3, 0.2}), coasting = localTrack(3, {0.5, 0.2});
  tentative.status = TrackStatus::tentative;
  coasting.status = TrackStatus::coasting;
  Fusion fusion(
      {localTrack(1, {0.1, 0.2}), tentative, coasting, localTrack(4, {0.7, 0.2}), localTrack(5, {0.9, 0.2})});
  fusion.global.start({"a", 1}, *fusion.reports.find({"a", 1}));
  FusedTrack& description = fusion.global.entries()[0].report;
  describeFusion(fusion.global.entries()[0].track, {0}, {1.0}, {{"a", 1}}, description);
  const FusionReport report = describe(fusion.global, fusion.reports, {{{"a", 5}, 1u}});
  EXPECT_EQ(report.time, at(1.0));
  EXPECT_EQ(report.tracks.size(), 1u);
  EXPECT_EQ(reasonsOf(report.left_out),
            (Names{"a 2 tentative", "a 3 coasting", "a 4 limit", "a 5 contested"}));
}

TEST(FusionReport, ATrackThatIsWithheldIsNotShownAndItsSourcesAreLeftOut) {
  Fusion fusion({localTrack(1, {0.1, 0.2})});
  fusion.global.start({"a", 1}, *fusion.reports.find({"a", 1}));
  GlobalTrackEntry& entry = fusion.global.entries()[0];
  describeFusion(entry.track, {0}, {1.0}, {{"a", 1}}, entry.report);
  entry.report.withheld = Refusal{"too uncertain", "134 rad"};
  const FusionReport report = describe(fusion.global, fusion.reports, {});
  EXPECT_TRUE(report.tracks.empty());
  EXPECT_EQ(reasonsOf(report.left_out), (Names{"a 1 too uncertain"}));
}

TEST(FusionReport, ARefusedReportIsAddedToTheLatestOneAndChangesNothingElse) {
  FusionReport latest;
  latest.time = at(2.0);
  latest.tracks.resize(1);
  latest.tracks[0].sensor_changes.resize(1);
  const LocalReport refused = reportOf("b", 1.5, {localTrack(1, {0.1, 0.2}), localTrack(2, {0.2, 0.2})});
  const FusionReport report = describeRefused(latest, refused, {"late", "0.5 s"}, 1);
  EXPECT_EQ(textOf(report.refusal.value()), "late: 0.5 s");
  EXPECT_TRUE(report.tracks.at(0).sensor_changes.empty()) << "said already";
  EXPECT_EQ(reasonsOf(report.left_out), (Names{"b 1 late"})) << "one at most";
  EXPECT_NEAR(report.left_out[0].age, 0.5, 1e-9);
}

}  // namespace
}  // namespace sightline::core
