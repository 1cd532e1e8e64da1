// Settings of a TrackFusion that change while it runs.
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "sightline/core/fusion/track_fusion.h"

#include "support/local_tracks.h"
#include "support/tracklet_platform.h"

namespace sightline::core {
namespace {

using test::localTrack;
using test::reportOf;
using test::sourcesOf;
using Names = std::vector<std::string>;

TrackFusionParams withRule(FusionRule rule) {
  TrackFusionParams params;
  params.rule = rule;
  return params;
}

TEST(TrackFusionSettings, AnotherRuleMakesTheNextFusionOfTheSameGlobalTracks) {
  TrackFusion fusion(withRule(FusionRule::weighted_covariance));
  fusion.onReport(reportOf("a", 1.0, {localTrack(1, {0.1, 0.2})}));
  const FusionReport before = fusion.onReport(reportOf("b", 1.0, {localTrack(5, {0.1, 0.2})}));
  ASSERT_EQ(before.tracks.size(), 1u);
  EXPECT_EQ(before.tracks[0].rule, FusionRule::weighted_covariance);
  ASSERT_FALSE(fusion.reconfigure(withRule(FusionRule::covariance_intersection)));
  fusion.onReport(reportOf("a", 1.1, {localTrack(1, {0.1, 0.2})}));
  const FusionReport now = fusion.onReport(reportOf("b", 1.1, {localTrack(5, {0.1, 0.2})}));
  ASSERT_EQ(now.tracks.size(), 1u);
  EXPECT_EQ(now.tracks[0].rule, FusionRule::covariance_intersection);
  EXPECT_EQ(now.tracks[0].track.id, before.tracks[0].track.id);
  EXPECT_EQ(sourcesOf(now.tracks[0]), (Names{"a 1", "b 5"}));
  EXPECT_GT(now.tracks[0].track.state.covariance(0, 0), 1.5 * before.tracks[0].track.state.covariance(0, 0))
      << "the intersection counts two equal tracks as one";
}

TEST(TrackFusionSettings, AnotherGateDecidesWhoJoinsAndThoseWhoHaveStay) {
  TrackFusionParams narrow;
  narrow.gate_probability = 0.05;
  const auto near = localTrack(5, {0.103, 0.2});  // about two sigmas of the difference from the first
  TrackFusion wide({}), narrowed({});
  for (TrackFusion* fusion : {&wide, &narrowed})
    fusion->onReport(reportOf("a", 1.0, {localTrack(1, {0.1, 0.2})}));
  ASSERT_FALSE(narrowed.reconfigure(narrow));
  EXPECT_EQ(wide.onReport(reportOf("b", 1.0, {near})).tracks.size(), 1u);
  EXPECT_EQ(narrowed.onReport(reportOf("b", 1.0, {near})).tracks.size(), 2u);
  const std::uint32_t id =
      wide.onReport(reportOf("a", 1.1, {localTrack(1, {0.1, 0.2})})).tracks.at(0).track.id;
  ASSERT_FALSE(wide.reconfigure(narrow));
  const FusionReport after = wide.onReport(reportOf("a", 1.2, {localTrack(1, {0.1, 0.2})}));
  EXPECT_EQ(after.tracks.at(0).track.id, id);
}

TEST(TrackFusionSettings, OnlyWhatMayChangeInFlightIsTaken) {
  using Change = std::function<void(TrackFusionParams&)>;
  const std::vector<std::pair<std::string, Change>> fixed = {
      {"registration_sigma", [](auto& p) { p.registration_sigma = 1e-3; }},
      {"process_noise", [](auto& p) { p.process_noise = 1e-3; }},
      {"max_wait", [](auto& p) { p.max_wait = 0.2; }},
      {"max_tracks", [](auto& p) { p.max_tracks = 5; }},
      {"reports.max_age", [](auto& p) { p.reports.max_age = 0.5; }},
      {"reports.forget_after", [](auto& p) { p.reports.forget_after = 20.0; }},
      {"reports.max_trackers", [](auto& p) { p.reports.max_trackers = 5; }},
      {"reports.max_tracks", [](auto& p) { p.reports.max_tracks = 5; }},
      {"tracklets.estimator", [](auto& p) { p.tracklets.estimator.kind = EstimatorKind::imm; }},
      {"tracklets.max_lag", [](auto& p) { p.tracklets.max_lag = 2.0; }},
      {"tracklets.memory", [](auto& p) { p.tracklets.memory = 2.0; }},
      {"tracklets.guard.enabled", [](auto& p) { p.tracklets.guard.enabled = false; }},
  };
  TrackFusion fusion({});
  for (const auto& [name, change] : fixed) {
    TrackFusionParams wanted;
    wanted.coasting_age = 3.0;
    change(wanted);
    const auto why = fusion.reconfigure(wanted);
    ASSERT_TRUE(why) << name;
    EXPECT_EQ(why->kind, "fixed");
    EXPECT_EQ(why->detail.rfind(name, 0), 0u) << why->detail;
    EXPECT_EQ(fusion.params().coasting_age, TrackFusionParams{}.coasting_age) << "all or nothing";
  }
  TrackFusionParams bad;
  bad.gate_probability = 1.0;
  EXPECT_EQ(fusion.reconfigure(bad)->kind, "invalid");
  TrackFusionParams good = withRule(FusionRule::inverse_covariance_intersection);
  good.intersection_weights = IntersectionWeights::trace;
  good.allow_shared_sensors = true;
  good.leave_factor = 3.0;
  good.leave_after = 1.0;
  good.coasting_age = good.delete_after = good.remember = 2.0;
  good.tracklets.max_missing = 0.5;
  good.tracklets.guard.health.bias_threshold = 20.0;
  EXPECT_FALSE(fusion.reconfigure(good));
}

/// Messages of two trackers that see one target, in order, at 33 Hz for four seconds.
struct TwoTrackers {
  test::Platform platform;
  std::vector<std::pair<LocalReport, TrackletReport>> messages;

  TwoTrackers() {
    platform.sensors = {{"west", "west"}, {"east", "east", 0.03, 0.015}};
    platform.path = [](double t) { return Eigen::Vector2d(0.1 * t, 0.2); };
    std::map<std::string, LocalTracker> trackers;
    std::map<std::string, TrackletBuilder> builders;
    for (const auto& [sensor, scan] : test::scansOf(platform)) {
      const ScanReport report =
          trackers.try_emplace(sensor->tracker, platform.tracker).first->second.onScan(scan);
      auto tracklets =
          builders.try_emplace(sensor->tracker, TrackletParams{}).first->second.onScan(scan, report);
      if (!tracklets) continue;
      tracklets->tracker = sensor->tracker;
      messages.emplace_back(LocalReport{sensor->tracker, report.time, report.tracks}, *tracklets);
    }
  }
};

TEST(TrackFusionSettings, ARuleWithTrackletsBeginsWithThoseThatComeFromThenOn) {
  const TwoTrackers trackers;
  ASSERT_GT(trackers.messages.size(), 100u);
  TrackFusion fusion(withRule(FusionRule::covariance_intersection));
  const std::size_t change = trackers.messages.size() / 3;
  std::uint32_t id = 0;
  bool was_by_states = false;
  FusionReport last;
  for (std::size_t k = 0; k < trackers.messages.size(); ++k) {
    if (k == change) {
      id = last.tracks.at(0).track.id;
      EXPECT_EQ(last.tracks[0].rule, FusionRule::covariance_intersection);
      ASSERT_FALSE(fusion.reconfigure(withRule(FusionRule::best)));
    }
    fusion.onTracklets(trackers.messages[k].second);
    last = fusion.onReport(trackers.messages[k].first);
    ASSERT_LE(last.tracks.size(), 1u);
    if (k >= change && last.tracks.at(0).rule != FusionRule::tracklets) was_by_states = true;
  }
  EXPECT_TRUE(was_by_states) << "until tracklets are complete, the best rule is another one";
  EXPECT_EQ(last.tracks.at(0).rule, FusionRule::tracklets);
  EXPECT_EQ(last.tracks[0].track.id, id);
  EXPECT_FALSE(last.tracks[0].sensors.empty());
  ASSERT_FALSE(fusion.reconfigure(withRule(FusionRule::cross_covariance)));
  last = fusion.onReport(trackers.messages.back().first);
  EXPECT_EQ(last.tracks.at(0).rule, FusionRule::cross_covariance);
  EXPECT_EQ(last.tracks[0].track.id, id);
  EXPECT_TRUE(last.tracks[0].sensors.empty()) << "without tracklets no sensor is watched";
}

}  // namespace
}  // namespace sightline::core
