#include "sightline/core/fusion/track_combination.h"

#include <cmath>

#include <gtest/gtest.h>

#include "support/local_tracks.h"

namespace sightline::core {
namespace {

using test::at;
using test::localTrack;
using test::reasonsOf;
using test::sourcesOf;
using Names = std::vector<std::string>;

LocalTrack reported(Track track, const std::string& sensor) {
  track.sources = {sensor};
  return {track, at(1.0), {}};
}

/// A global track that "a" and "b" support.
struct Combined {
  explicit Combined(FusionRule rule) {
    params.rule = rule;
    entry.track.join({"b", 1}, reported(localTrack(1, {0.1, 0.2}, 2e-3), "t"));
    entry.track.compareSupporters(TrackerMisalignment(0.0));
  }

  TrackletLosses fuseNow() { return fuse(entry, {{"b", 1}}, memory, params, thresholdsOf(params)); }

  TrackFusionParams params;
  TrackletMemory memory{memoryParamsOf(params)};
  GlobalTrackEntry entry{GlobalTrack(1, at(1.0), {"a", 1}, reported(localTrack(1, {0.1, 0.2}), "s"), 0.0),
                         TrackletFusion(params.tracklets),
                         {},
                         {}};
};

TEST(TrackCombination, EveryRuleForStatesMakesASurerTrackOfBothOrAsSureAsTheBest) {
  for (const FusionRule rule :
       {FusionRule::weighted_covariance, FusionRule::cross_covariance, FusionRule::covariance_intersection,
        FusionRule::inverse_covariance_intersection}) {
    Combined combined(rule);
    const TrackletLosses losses = combined.fuseNow();
    EXPECT_EQ(losses.late, 0u);
    EXPECT_EQ(losses.failed.count, 0u);
    const FusedTrack& report = combined.entry.report;
    EXPECT_EQ(report.rule, rule);
    EXPECT_EQ(sourcesOf(report), (Names{"a 1", "b 1"}));
    EXPECT_LE(report.track.state.covariance(0, 0), 1e-6 * (1.0 + 1e-6)) << nameOf(rule);
    EXPECT_FALSE(report.why_not_tracklets);
    EXPECT_FALSE(report.withheld);
  }
}

TEST(TrackCombination, BestTakesTheStatesWhereTrackletsAreMissingAndSaysWhy) {
  Combined combined(FusionRule::best);
  combined.fuseNow();
  EXPECT_EQ(combined.entry.report.rule, FusionRule::cross_covariance);
  EXPECT_EQ(combined.entry.report.why_not_tracklets.value_or(Refusal{}).detail, "no tracklets from a");
  TrackletReport tracklets{"a", at(1.0), std::nullopt, {}};
  Tracklet tracklet;
  tracklet.time = at(1.0);
  tracklet.sensor = "s";
  tracklet.sighting = sightingOf({0.1, 0.2}, 1e-6 * Eigen::Matrix2d::Identity());
  tracklets.tracklets = {{1, tracklet}};
  combined.memory.take(tracklets);
  combined.fuseNow();
  EXPECT_EQ(combined.entry.report.why_not_tracklets.value_or(Refusal{}).detail, "no tracklets from b");
}

TEST(TrackCombination, WithoutAUsableSupporterTheTrackCoasts) {
  Combined combined(FusionRule::weighted_covariance);
  for (const std::size_t number : {0u, 1u}) combined.entry.track.setUnusable(number, Refusal{"stale", "old"});
  combined.fuseNow();
  EXPECT_EQ(combined.entry.report.track.status, TrackStatus::coasting);
  EXPECT_EQ(reasonsOf(combined.entry.report.left_out), (Names{"a 1 stale", "b 1 stale"}));
}

TEST(TrackCombination, AStateThatIsNoTrackIsWithheld) {
  Combined combined(FusionRule::weighted_covariance);
  LocalTrack vague = reported(localTrack(1, {0.1, 0.2}), "s");
  vague.track.state.covariance.row(1) *= 134.0e3;
  vague.track.state.covariance.col(1) *= 134.0e3;
  GlobalTrackEntry entry{
      GlobalTrack(1, at(1.0), {"a", 1}, vague, 0.0), TrackletFusion(combined.params.tracklets), {}, {}};
  fuse(entry, {{"a", 1}}, combined.memory, combined.params, thresholdsOf(combined.params));
  EXPECT_EQ(entry.report.withheld.value_or(Refusal{}).kind, "too uncertain");
}

TEST(TrackCombination, TrackletsThatAnEstimatorCannotTakeAreCounted) {
  Combined combined(FusionRule::tracklets);
  combined.params.tracklets.estimator.kind = EstimatorKind::twbls;
  combined.params.tracklets.estimator.twbls_form = EstimatorForm::paper;
  combined.params.tracklets.estimator.twbls.sensor_weight = SensorWeight::ifov;  // throws without
  combined.entry.tracklets = TrackletFusion(combined.params.tracklets);
  Tracklet tracklet;
  tracklet.time = at(0.95);
  tracklet.sensor = "s";
  tracklet.ifov = std::nan("");
  tracklet.sighting = sightingOf({0.1, 0.2}, 1e-6 * Eigen::Matrix2d::Identity());
  combined.memory.take({"a", at(1.0), std::nullopt, {{1, tracklet}}});
  const TrackletLosses losses = combined.fuseNow();
  EXPECT_EQ(losses.failed.count, 1u);
  EXPECT_NE(losses.failed.latest.find("ifov"), std::string::npos) << losses.failed.latest;
  EXPECT_EQ(combined.fuseNow().failed.count, 0u) << "not at each later call";
  EXPECT_EQ(sourcesOf(combined.entry.report), (Names{"a 1", "b 1"}));
}

}  // namespace
}  // namespace sightline::core
