#include "sightline/ros/components/track_fusion_component.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <geometry_msgs/TransformStamped.h>

#include "sightline/ros/components/component_params.h"
#include "sightline/ros/components/track_fusion_health.h"
#include "sightline/ros/messages/conversions.h"
#include "sightline/ros/params/track_fusion_params.h"

#include "support/diagnostics.h"
#include "support/paths.h"
#include "support/scratch_folder.h"
#include "support/times.h"

namespace {

namespace core = sightline::core;
using sightline::test::at;
using sightline::test::valueOf;
using sightline_ros::FusionResult;
using sightline_ros::ParamError;
using sightline_ros::ParamReader;
using sightline_ros::TrackFusionComponent;
using sightline_ros::TrackFusionHealth;

std::string kindOf(const std::optional<core::Refusal>& refusal) {
  return refusal ? refusal->kind : "";
}

sightline::TrackArray tracksOf(const std::string& tracker, double stamp, double azimuth = 0.5) {
  sightline::TrackArray array;
  array.header.stamp = ros::Time(stamp);
  array.header.frame_id = "platform_enu";
  array.tracker = tracker;
  array.tracks.resize(1);
  sightline::Track& track = array.tracks[0];
  track.id = 7;
  track.status = sightline::Track::CONFIRMED;
  track.azimuth = azimuth;
  track.covariance[0] = track.covariance[5] = 1e-6;
  track.covariance[10] = track.covariance[15] = 1e-5;
  track.last_sighting = array.header.stamp;
  track.hits = 10;
  track.sources = {"sensor of " + tracker};
  return array;
}

core::TrackFusionParams paramsOf(const std::string& yaml) {
  const ScratchFolder folder;
  const ParamReader reader = ParamReader::fromYaml(folder.write("params.yaml", yaml));
  const core::TrackFusionParams params = sightline_ros::loadTrackFusionParams(reader);
  reader.finish();
  return params;
}

TEST(TrackFusionParams, ShippedFileSaysTheDefaultsAndNothingElse) {
  const ParamReader reader =
      ParamReader::fromYaml(sightline::test::sourceDirectory() + "/config/track_fusion.yaml");
  const TrackFusionComponent component(reader, "node");
  silenceFrom(reader);
  EXPECT_NO_THROW(reader.finish());
  // The settings of the estimators are those of local_tracker.yaml, and not repeated.
  for (const std::string& key : reader.differences()) {
    const std::string name = key.substr(reader.name().size() + 1);
    const std::string section = name.substr(0, name.find('/'));
    EXPECT_TRUE(section == "twbls" || section == "noga" || section == "kalman" || section == "imm" ||
                section == "noise_calibration")
        << key;
  }
  EXPECT_EQ(component.name(), "node");
}

TEST(TrackFusionParams, EveryKeyReachesItsField) {
  for (const core::FusionRuleEntry& entry : core::fusionRuleTable())
    EXPECT_EQ(paramsOf(std::string("rule: ") + entry.name).rule, entry.rule);
  EXPECT_EQ(paramsOf("estimator: noga").tracklets.estimator.kind, core::EstimatorKind::noga);
  EXPECT_EQ(paramsOf("kalman: {process_noise: 0.3}").tracklets.estimator.kalman.process_noise, 0.3);
  const core::TrackletFusionParams tracklets =
      paramsOf("tracklets: {max_lag: 3.0, memory: 2.0, max_missing: 0.1}").tracklets;
  EXPECT_EQ(tracklets.max_lag, 3.0);
  EXPECT_EQ(tracklets.memory, 2.0);
  EXPECT_EQ(tracklets.max_missing, 0.1);
  EXPECT_FALSE(paramsOf("guard: {enabled: false}").tracklets.guard.enabled);
  EXPECT_EQ(paramsOf("guard: {roll_back: 0.7}").tracklets.guard.roll_back, 0.7);
  EXPECT_EQ(paramsOf("intersection_weights: trace").intersection_weights, core::IntersectionWeights::trace);
  const core::TrackFusionParams params = paramsOf(
      "gate: {probability: 0.9, leave_factor: 3.0, leave_after: 0.7, registration_sigma: "
      "0.01}\nprocess_noise: 0.3\n"
      "max_age: 2.0\ncoasting_age: 0.6\ndelete_after: 4.0\nforget_after: 20.0\nallow_shared_sensors: true\n"
      "max_trackers: 5\nmax_local_tracks: 6\nmax_tracks: 7\n");
  EXPECT_EQ(params.gate_probability, 0.9);
  EXPECT_EQ(params.leave_factor, 3.0);
  EXPECT_EQ(params.leave_after, 0.7);
  EXPECT_EQ(params.registration_sigma, 0.01);
  EXPECT_EQ(params.process_noise, 0.3);
  EXPECT_EQ(params.reports.max_age, 2.0);
  EXPECT_EQ(params.coasting_age, 0.6);
  EXPECT_EQ(params.delete_after, 4.0);
  EXPECT_EQ(params.reports.forget_after, 20.0);
  EXPECT_TRUE(params.allow_shared_sensors);
  EXPECT_EQ(params.reports.max_trackers, 5);
  EXPECT_EQ(params.reports.max_tracks, 6);
  EXPECT_EQ(params.max_tracks, 7);
}

TEST(TrackFusionParams, BadValuesAreRefused) {
  for (const char* yaml : {"rule: kalman", "gate: {probability: 1.0}", "gate: {leave_factor: 0.5}",
                           "gate: {registration_sigma: -1.0}", "process_noise: -1.0", "max_age: 0.0",
                           "{max_age: 3.0, forget_after: 2.0}", "max_tracks: 0", "allow_shared_sensors: 1",
                           "intersection_weights: best", "estimator: best", "tracklets: {max_lag: 0.0}",
                           "tracklets: {max_missing: 1.5}", "unknown_key: 1"}) {
    EXPECT_THROW(paramsOf(yaml), ParamError) << yaml;
  }
}

/// What comes of a report for which no other follows.
FusionResult fusedNow(TrackFusionComponent& component, FusionResult result) {
  return component.isWaiting() ? *component.fuseWaiting() : result;
}

class FusionComponent : public testing::Test {
 protected:
  FusionResult fuse(const sightline::TrackArray& local, const std::string& topic = "") {
    return component_.onTracks(local, topic.empty() ? "/" + local.tracker + "/tracks" : topic,
                               sightline_ros::toCore(local.header.stamp));
  }

  ParamReader reader_{XmlRpc::XmlRpcValue(), "/test"};
  TrackFusionComponent component_{reader_, "my_fusion"};
};

TEST_F(FusionComponent, TracksOfTwoTrackersBecomeOneAndTheReportNamesThem) {
  fuse(tracksOf("a", 10.0));
  const FusionResult result = fuse(tracksOf("b", 10.1));
  ASSERT_TRUE(result.tracks);
  EXPECT_EQ(result.tracks->header.stamp, ros::Time(10.1));
  EXPECT_EQ(result.tracks->header.frame_id, "platform_enu");
  EXPECT_EQ(result.tracks->tracker, "my_fusion");
  EXPECT_EQ(result.tracks->estimator, "best");
  ASSERT_EQ(result.tracks->tracks.size(), 1u);
  EXPECT_EQ(result.tracks->tracks[0].id, 1u);
  EXPECT_EQ(result.tracks->tracks[0].sources, (std::vector<std::string>{"a", "b"}));
  EXPECT_LT(result.tracks->tracks[0].covariance[0], 1e-6);
  EXPECT_EQ(result.tracks->tracks[0].last_sighting, ros::Time(10.1));

  EXPECT_EQ(result.report->header.stamp, result.tracks->header.stamp);
  EXPECT_EQ(result.report->header.frame_id, "platform_enu");
  ASSERT_EQ(result.report->tracks.size(), 1u);
  const sightline::FusedTrack& fused = result.report->tracks[0];
  EXPECT_EQ(fused.id, 1u);
  EXPECT_EQ(fused.rule, "cross_covariance");
  EXPECT_EQ(fused.why_not_tracklets, "no tracklets from a");
  ASSERT_EQ(fused.sources.size(), 2u);
  EXPECT_EQ(fused.sources[0].tracker, "a");
  EXPECT_EQ(fused.sources[0].id, 7u);
  EXPECT_NEAR(fused.sources[0].age, 0.1, 1e-9);
  EXPECT_NEAR(fused.sources[0].weight + fused.sources[1].weight, 1.0, 1e-12);
  EXPECT_NEAR(fused.sources[0].distance_squared, 0.0, 1e-9);
  EXPECT_TRUE(fused.left_out.empty());
}

TEST_F(FusionComponent, ReportWaitsForTheOtherThatIsExpectedAndBothAreFusedOnce) {
  for (int k = 0; k < 3; ++k) {
    fuse(tracksOf("a", 10.0 + 0.1 * k));
    fuse(tracksOf("b", 10.0 + 0.1 * k));
  }
  const FusionResult waiting = fuse(tracksOf("a", 10.3));
  EXPECT_FALSE(waiting.tracks);
  EXPECT_FALSE(waiting.report);
  EXPECT_FALSE(waiting.refusal);
  EXPECT_TRUE(component_.isWaiting());
  const FusionResult both = fuse(tracksOf("b", 10.3));
  ASSERT_TRUE(both.tracks);
  EXPECT_EQ(both.tracks->header.stamp, ros::Time(10.3));
  EXPECT_EQ(both.tracks->tracks.at(0).sources, (std::vector<std::string>{"a", "b"}));
  EXPECT_FALSE(component_.isWaiting());
  EXPECT_FALSE(component_.fuseWaiting());
}

TEST_F(FusionComponent, WhatWaitsForOneThatDoesNotComeIsFusedAtTheEndOfTheWait) {
  for (int k = 0; k < 3; ++k) {
    fuse(tracksOf("a", 10.0 + 0.1 * k));
    fuse(tracksOf("b", 10.0 + 0.1 * k));
  }
  ASSERT_FALSE(fuse(tracksOf("a", 10.3)).tracks);
  const auto result = component_.fuseWaiting();
  ASSERT_TRUE(result);
  ASSERT_TRUE(result->tracks);
  EXPECT_EQ(result->tracks->header.stamp, ros::Time(10.3));
  EXPECT_EQ(result->tracks->tracks.at(0).last_sighting, ros::Time(10.3));
  ASSERT_EQ(result->report->tracks.size(), 1u);
}

/// Two sightings of one sensor, as tracklets of the track of `tracksOf`.
sightline::TrackletArray trackletsOf(const std::string& tracker, double stamp, double since) {
  sightline::TrackletArray array;
  array.header.stamp = ros::Time(stamp);
  array.header.frame_id = "platform_enu";
  array.tracker = tracker;
  if (since > 0.0) array.since = ros::Time(since);
  array.tracklets.resize(2);
  for (std::size_t i = 0; i < 2; ++i) {
    sightline::Tracklet& tracklet = array.tracklets[i];
    tracklet.track = 7;
    tracklet.sensor = "sensor of " + tracker;
    tracklet.stamp = ros::Time(stamp - (i == 0 ? 0.05 : 0.0));
    tracklet.azimuth = 0.5;
    tracklet.covariance[0] = tracklet.covariance[3] = 2e-6;
    tracklet.sightings = 1.0;
    tracklet.ifov = std::numeric_limits<double>::quiet_NaN();
  }
  return array;
}

TEST_F(FusionComponent, TrackletsOfAllTrackersMakeTheTrackAndTheReportSaysSo) {
  FusionResult result;
  for (int k = 0; k < 30; ++k) {
    const double stamp = 10.0 + 0.1 * k;
    for (const char* tracker : {"a", "b"}) {
      EXPECT_FALSE(component_.onTracklets(trackletsOf(tracker, stamp, k == 0 ? 0.0 : stamp - 0.1),
                                          std::string("/") + tracker + "/tracklets", at(stamp)));
      result = fuse(tracksOf(tracker, stamp));
    }
  }
  ASSERT_EQ(result.report->tracks.size(), 1u);
  EXPECT_EQ(result.report->tracks[0].rule, "tracklets");
  EXPECT_EQ(result.report->tracks[0].why_not_tracklets, "");
  EXPECT_NEAR(result.report->tracks[0].sources.at(0).weight, 0.5, 0.05) << "one message apart";
  EXPECT_NEAR(result.tracks->tracks.at(0).azimuth, 0.5, 1e-9);
  EXPECT_EQ(component_.lateTracklets(), 0u);
}

TEST_F(FusionComponent, TrackletsThatCannotBeUsedAreRefusedWithTheReason) {
  const auto refusal = [this](const sightline::TrackletArray& array,
                              const std::string& topic = "/a/tracklets") {
    return kindOf(component_.onTracklets(array, topic, at(10.0)));
  };
  sightline::TrackletArray array = trackletsOf("a", 10.0, 0.0);
  array.header.frame_id = "other_ship";
  EXPECT_EQ(refusal(array), "frame");
  EXPECT_EQ(refusal(trackletsOf("a", 11.0, 0.0)), "future");
  EXPECT_EQ(refusal(trackletsOf("my_fusion", 10.0, 0.0)), "feedback");
  EXPECT_EQ(refusal(trackletsOf("a", 10.0, 0.0)), "");
  EXPECT_EQ(refusal(trackletsOf("a", 10.0, 9.9), "/elsewhere"), "name");
  const auto spoilt = [&](auto spoil) {
    sightline::TrackletArray bad = trackletsOf("a", 10.0, 9.9);
    spoil(bad.tracklets[0]);
    return refusal(bad);
  };
  EXPECT_EQ(spoilt([](auto& it) { it.covariance[0] = 0.0; }), "invalid");
  EXPECT_EQ(spoilt([](auto& it) { it.azimuth = 90.0; }), "invalid");
  EXPECT_EQ(spoilt([](auto& it) { it.sightings = 0.0; }), "invalid");
  EXPECT_EQ(spoilt([](auto& it) { it.track = 0; }), "invalid");
  EXPECT_EQ(spoilt([](auto& it) { it.sensor.clear(); }), "invalid");
  EXPECT_EQ(spoilt([](auto& it) { it.stamp = ros::Time(10.01); }), "invalid");
}

TEST_F(FusionComponent, ARateThatBecomesAbsurdIsLeftOutAndTheOthersGoOnUnderEveryRule) {
  for (const core::FusionRuleEntry& rule : core::fusionRuleTable()) {
    XmlRpc::XmlRpcValue values;
    values["rule"] = std::string(rule.name);
    TrackFusionComponent component{ParamReader(values, "/test"), "fusion"};
    int published = 0;
    for (int k = 0; k < 60; ++k) {
      const double stamp = 10.0 + 0.1 * k, spoilt = std::pow(10.0, 6.0 * (k - 10));
      for (const char* tracker : {"a", "b", "c"}) {
        sightline::TrackArray tracks = tracksOf(tracker, stamp);
        sightline::Track& track = tracks.tracks[0];
        if (k > 10 && tracker == std::string("c")) {
          if (k % 3 == 0) track.azimuth_rate = spoilt;
          if (k % 3 == 1) {
            for (double& entry : track.covariance) entry *= spoilt;
          }
          if (k % 3 == 2) track.azimuth = spoilt;
        }
        const FusionResult result =
            fusedNow(component, component.onTracks(tracks, "/" + tracks.tracker + "/tracks", at(stamp)));
        ASSERT_TRUE(result.tracks) << rule.name << " " << k;
        ASSERT_EQ(result.tracks->tracks.size(), 1u) << rule.name << " " << k;
        EXPECT_EQ(result.tracks->tracks[0].id, 1u) << rule.name;
        EXPECT_NEAR(result.tracks->tracks[0].azimuth, 0.5, 1e-3) << rule.name;
        EXPECT_LE(result.tracks->tracks[0].covariance[0], 1e-6 * (1.0 + 1e-9)) << rule.name;
        ++published;
      }
    }
    EXPECT_EQ(published, 180);
  }
}

TEST_F(FusionComponent, TrackletsAtWhichTheEstimatorFailsAreCountedAndTheNodeGoesOn) {
  XmlRpc::XmlRpcValue values;
  values["estimator"] = std::string("twbls");
  values["twbls"]["form"] = std::string("paper");
  values["twbls"]["paper"]["sensor_weight"] = std::string("ifov");  // which these do not state
  TrackFusionComponent component{ParamReader(values, "/test"), "fusion"};
  TrackFusionHealth health({"/a/tracks", "/b/tracks"}, 2.0);
  FusionResult result;
  for (int k = 0; k < 30; ++k) {
    const double stamp = 10.0 + 0.1 * k;
    for (const char* tracker : {"a", "b"}) {
      const auto tracklets = trackletsOf(tracker, stamp, k == 0 ? 0.0 : stamp - 0.1);
      const auto refusal =
          component.onTracklets(tracklets, std::string("/") + tracker + "/tracklets", at(stamp));
      EXPECT_FALSE(refusal);
      health.noteTracklets(tracklets, refusal, component.lateTracklets());
      const auto tracks = tracksOf(tracker, stamp);
      result = component.onTracks(tracks, std::string("/") + tracker + "/tracks", at(stamp));
      ASSERT_FALSE(result.refusal) << core::textOf(*result.refusal);
      health.note(tracks, std::string("/") + tracker + "/tracks", result);
      health.noteFailures(component.failedTracklets());
    }
  }
  EXPECT_EQ(result.report->tracks.at(0).rule, "cross_covariance");
  EXPECT_GT(component.failedTracklets().count, 50u);
  diagnostic_updater::DiagnosticStatusWrapper status;
  health.diagnose(at(12.9), status);
  EXPECT_EQ(valueOf(status, "tracklets that an estimator could not take"),
            std::to_string(component.failedTracklets().count));
  EXPECT_NE(status.message.find("failed: "), std::string::npos) << status.message;
}

TEST_F(FusionComponent, ABacklogThatComesAtOnceKeepsTheIdAndTheTime) {
  for (const double held_for : {5.0, 15.0}) {
    TrackFusionComponent component{reader_, "fusion"};
    const auto take = [&](const char* tracker, double stamp, double arrival) {
      return fusedNow(component, component.onTracks(tracksOf(tracker, stamp),
                                                    std::string("/") + tracker + "/tracks", at(arrival)));
    };
    double now = 100.0;
    for (; now < 110.0; now += 0.1) {
      take("a", now, now);
      take("b", now, now);
    }
    const double begin = now;
    for (; now < begin + held_for; now += 0.1) take("a", now, now);
    for (double stamp = begin; stamp < now; stamp += 0.1) {
      const FusionResult result = take("b", stamp, now + 1e-4 * (stamp - begin));
      ASSERT_TRUE(result.tracks);
      ASSERT_EQ(result.tracks->tracks.size(), 1u) << held_for;
      EXPECT_EQ(result.tracks->tracks[0].id, 1u) << held_for;
      EXPECT_NEAR(result.tracks->header.stamp.toSec(), now - 0.1, 1e-6) << held_for;
    }
    const FusionResult result = take("a", now, now + 0.01);
    EXPECT_EQ(result.tracks->tracks.at(0).sources, (std::vector<std::string>{"a", "b"})) << held_for;
    EXPECT_EQ(result.tracks->tracks.at(0).id, 1u);
  }
}

TEST_F(FusionComponent, GarbageIsLeftOutInTheReportWithItsReason) {
  fuse(tracksOf("a", 10.0));
  sightline::TrackArray garbage = tracksOf("b", 10.0);
  garbage.tracks[0].covariance[5] = std::numeric_limits<double>::quiet_NaN();
  const FusionResult result = fuse(garbage);
  ASSERT_TRUE(result.tracks);
  EXPECT_EQ(result.tracks->tracks.at(0).sources, std::vector<std::string>{"a"});
  ASSERT_EQ(result.report->left_out.size(), 1u);
  EXPECT_EQ(result.report->left_out[0].tracker, "b");
  EXPECT_EQ(result.report->left_out[0].reason, "invalid: state or covariance is not finite");
}

TEST_F(FusionComponent, TracksFromAnotherFrameAreRefusedWithTheReason) {
  fuse(tracksOf("a", 10.0));
  sightline::TrackArray elsewhere = tracksOf("b", 10.0);
  elsewhere.header.frame_id = "other_ship";
  const FusionResult result = fuse(elsewhere);
  EXPECT_FALSE(result.tracks);
  ASSERT_TRUE(result.refusal);
  EXPECT_NE(result.refusal->detail.find("\"other_ship\", not in \"platform_enu\""), std::string::npos)
      << result.refusal->detail;
  ASSERT_EQ(result.report->left_out.size(), 1u);
  EXPECT_EQ(result.report->left_out[0].reason, core::textOf(*result.refusal));
  EXPECT_EQ(result.report->tracks.size(), 1u) << "the rest is as it was";
}

TEST_F(FusionComponent, StampsFromTheFutureAreRefusedUnlessTheClockIsNotKnown) {
  const FusionResult result = component_.onTracks(tracksOf("a", 10.5), "/a/tracks", at(10.0));
  EXPECT_EQ(kindOf(result.refusal), "future");
  EXPECT_FALSE(result.tracks);
  EXPECT_TRUE(component_.onTracks(tracksOf("a", 10.05), "/a/tracks", at(10.0)).tracks);
  EXPECT_TRUE(component_.onTracks(tracksOf("a", 99.0), "/a/tracks", core::Time{}).tracks);
}

TEST_F(FusionComponent, OwnTracksAreRefused) {
  EXPECT_EQ(kindOf(fuse(tracksOf("my_fusion", 10.0)).refusal), "feedback");
}

TEST_F(FusionComponent, NameThatAnotherTopicUsesIsRefusedUntilThatFallsSilent) {
  EXPECT_EQ(kindOf(fuse(tracksOf("tracker", 10.0), "/a").refusal), "");
  EXPECT_EQ(kindOf(fuse(tracksOf("tracker", 10.1), "/b").refusal), "name");
  EXPECT_EQ(kindOf(fuse(tracksOf("tracker", 10.2), "/a").refusal), "");
  EXPECT_EQ(kindOf(fuse(tracksOf("tracker", 11.3), "/b").refusal), "") << "moved";
}

TEST_F(FusionComponent, LateTracksAreRefused) {
  fuse(tracksOf("a", 10.0));
  const FusionResult result = fuse(tracksOf("a", 9.9));
  EXPECT_EQ(kindOf(result.refusal), "late");
  EXPECT_FALSE(result.tracks);
}

TEST_F(FusionComponent, SimulatedTimeThatStepsBackALittleForgetsNothingAndALotEverything) {
  EXPECT_FALSE(component_.onSimulatedTime(at(100.0)));
  EXPECT_EQ(fuse(tracksOf("a", 100.0)).tracks->tracks.at(0).id, 1u);
  for (const double now : {99.73, 100.1, 99.83, 99.2, 100.2})
    EXPECT_FALSE(component_.onSimulatedTime(at(now)));
  EXPECT_EQ(fuse(tracksOf("a", 100.2)).tracks->tracks.at(0).id, 1u);
  for (const double now : {99.9, 99.6, 99.3}) EXPECT_FALSE(component_.onSimulatedTime(at(now)));
  EXPECT_NEAR(component_.onSimulatedTime(at(99.1)).value_or(0.0), 1.1, 1e-9) << "little by little is a lot";
  EXPECT_FALSE(component_.onSimulatedTime(at(99.0)));
  EXPECT_EQ(fuse(tracksOf("a", 99.0)).tracks->tracks.at(0).id, 2u);
  EXPECT_NEAR(component_.onSimulatedTime(at(10.0)).value_or(0.0), 89.1, 1e-9);
}

TEST_F(FusionComponent, AReportRefusedBeforeAllOthersHasItsOwnStamp) {
  sightline::TrackArray elsewhere = tracksOf("b", 10.0);
  elsewhere.header.frame_id = "other_ship";
  EXPECT_EQ(fuse(elsewhere).report->header.stamp, ros::Time(10.0));
}

TEST_F(FusionComponent, ResetStartsAgainWithNewIds) {
  fuse(tracksOf("a", 100.0));
  component_.reset();
  const FusionResult result = fuse(tracksOf("a", 10.0));
  ASSERT_TRUE(result.tracks);
  EXPECT_EQ(result.tracks->tracks.at(0).id, 2u);
}

TEST_F(FusionComponent, HealthShowsRatesAgesTracksAndReasons) {
  TrackFusionHealth health({"/a/tracks", "/b/tracks"}, 2.0);
  diagnostic_updater::DiagnosticStatusWrapper before;
  health.diagnose(at(10.0), before);
  EXPECT_EQ(before.level, diagnostic_msgs::DiagnosticStatus::WARN);
  EXPECT_NE(before.message.find("nothing yet on /a/tracks"), std::string::npos) << before.message;

  const auto note = [&](const sightline::TrackArray& local) {
    health.note(local, "/" + local.tracker + "/tracks", fuse(local));
  };
  for (int i = 0; i < 20; ++i) {
    note(tracksOf("a", 10.0 + 0.05 * i));
    note(tracksOf("b", 10.0 + 0.05 * i));
  }
  sightline::TrackArray elsewhere = tracksOf("b", 11.0);
  elsewhere.header.frame_id = "other_ship";
  note(elsewhere);
  diagnostic_updater::DiagnosticStatusWrapper status;
  health.diagnose(at(11.0), status);
  EXPECT_EQ(valueOf(status, "/a/tracks: tracker"), "a");
  EXPECT_EQ(valueOf(status, "/a/tracks: rate [Hz]"), "20.0");
  EXPECT_EQ(valueOf(status, "/b/tracks: age of last report [s]"), "0.050");
  EXPECT_EQ(valueOf(status, "/b/tracks: tracks"), "1");
  EXPECT_EQ(valueOf(status, "global tracks confirmed"), "1");
  EXPECT_EQ(valueOf(status, "complaints, frame"), "1");
  EXPECT_EQ(status.level, diagnostic_msgs::DiagnosticStatus::WARN);
  EXPECT_NE(status.message.find("frame: 1 new"), std::string::npos) << status.message;

  for (int i = 0; i < 40; ++i) note(tracksOf("a", 11.0 + 0.05 * i));  // b is silent
  diagnostic_updater::DiagnosticStatusWrapper silent;
  health.diagnose(at(13.0), silent);
  EXPECT_EQ(silent.level, diagnostic_msgs::DiagnosticStatus::WARN);
  EXPECT_NE(silent.message.find("no tracks on /b/tracks for"), std::string::npos) << silent.message;
  EXPECT_EQ(valueOf(silent, "local tracks left out now, stale"), "1");

  note(tracksOf("b", 13.0));
  note(tracksOf("a", 13.0));
  diagnostic_updater::DiagnosticStatusWrapper calm;
  health.diagnose(at(13.1), calm);
  EXPECT_EQ(calm.level, diagnostic_msgs::DiagnosticStatus::OK) << calm.message;
  EXPECT_EQ(calm.message, "1 confirmed");
}

TEST_F(FusionComponent, BiasedSensorIsInTheReportTheDiagnosticsAndTheLog) {
  TrackFusionHealth health({"/a/tracks", "/b/tracks", "/c/tracks"}, 2.0);
  FusionResult result;
  std::vector<sightline::SensorHealth> changes;
  std::vector<std::string> lines;
  double stamp = 0.0;
  for (int k = 0; k < 60; ++k) {
    stamp = 10.0 + 0.1 * k;
    for (const char* tracker : {"a", "b", "c"}) {
      const double azimuth = tracker == std::string("c") && k >= 20 ? 0.506 : 0.5;
      sightline::TrackletArray tracklets = trackletsOf(tracker, stamp, k == 0 ? 0.0 : stamp - 0.1);
      for (auto& tracklet : tracklets.tracklets) tracklet.azimuth = azimuth;
      component_.onTracklets(tracklets, std::string("/") + tracker + "/tracklets", at(stamp));
      const sightline::TrackArray tracks = tracksOf(tracker, stamp, azimuth);
      result = fuse(tracks);
      health.note(tracks, std::string("/") + tracker + "/tracks", result);
      for (const std::string& line : health.sensorLines(result, at(stamp))) lines.push_back(line);
      if (!result.report) continue;  // a and b wait for c
      for (const auto& change : result.report->tracks.at(0).sensor_changes) changes.push_back(change);
    }
  }
  ASSERT_EQ(changes.size(), 1u);
  EXPECT_EQ(changes[0].sensor, "sensor of c");
  EXPECT_EQ(changes[0].verdict, "biased");
  EXPECT_FALSE(changes[0].undecided);
  EXPECT_NEAR(changes[0].since.toSec(), 12.0, 0.11);
  EXPECT_GT(changes[0].noticed, changes[0].since);
  EXPECT_GT(changes[0].bias[0], 1.0);
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_NE(lines[0].find("sensor \"sensor of c\" off by"), std::string::npos) << lines[0];

  ASSERT_EQ(result.report->tracks.size(), 1u);
  const sightline::FusedTrack& fused = result.report->tracks[0];
  ASSERT_EQ(fused.left_out.size(), 1u);
  EXPECT_EQ(fused.left_out[0].tracker, "c");
  EXPECT_EQ(fused.left_out[0].reason.substr(0, 7), "biased:");
  EXPECT_EQ(fused.sensors.size(), 3u);
  EXPECT_NEAR(result.tracks->tracks.at(0).azimuth, 0.5, 1e-6) << "the bias is out of the state";

  diagnostic_updater::DiagnosticStatusWrapper status;
  health.diagnose(at(stamp), status);
  EXPECT_EQ(status.level, diagnostic_msgs::DiagnosticStatus::WARN);
  EXPECT_NE(status.message.find("sensor of c: track 1: off by"), std::string::npos) << status.message;
  EXPECT_NE(valueOf(status, "guard of sensor of c").find("not used"), std::string::npos);
  EXPECT_EQ(valueOf(status, "guard of sensor of a"), "track 1: healthy");
}

TEST_F(FusionComponent, WarningsOfOneKindComeAtMostEveryFiveSeconds) {
  TrackFusionHealth health({"/a/tracks"}, 2.0);
  sightline::TrackArray garbage = tracksOf("a", 10.0);
  garbage.tracks[0].covariance.fill(0.0);
  std::vector<std::string> lines;
  for (int i = 0; i < 120; ++i) {
    garbage.header.stamp = ros::Time(10.0 + 0.1 * i);
    health.note(garbage, "/a/tracks", fuse(garbage));
    for (const std::string& line : health.warnings(at(10.0 + 0.1 * i))) lines.push_back(line);
  }
  ASSERT_EQ(lines.size(), 3u);
  EXPECT_NE(lines[0].find("covariance is zero"), std::string::npos) << lines[0];
  EXPECT_NE(lines[0].find("track 7 of \"a\""), std::string::npos) << lines[0];
  EXPECT_NE(lines[1].find("(50 new, 51 in all)"), std::string::npos) << lines[1];
}

TEST(TrackFusionComponent, TrackerWhoseSensorStandsApartIsRefusedInTheReportAndNotFused) {
  tf2::BufferCore transforms;
  for (const auto& [frame, x] : std::vector<std::pair<std::string, double>>{{"west", 0.0}, {"east", 80.0}}) {
    geometry_msgs::TransformStamped transform;
    transform.header.frame_id = "world";
    transform.child_frame_id = frame;
    transform.transform.translation.x = x;
    transform.transform.rotation.w = 1.0;
    transforms.setTransform(transform, "test", true);
  }
  const ScratchFolder folder;
  const ParamReader reader = ParamReader::fromYaml(folder.write(
      "params.yaml", "max_baseline: 20.0\nsensor_frames: {sensor of a: west, sensor of b: east}\n"));
  TrackFusionComponent component(reader, "fusion", &transforms);
  reader.finish();
  EXPECT_FALSE(component.onTracks(tracksOf("a", 1.0), "/a/tracks", at(1.0)).refusal);
  const FusionResult result = component.onTracks(tracksOf("b", 1.0), "/b/tracks", at(1.0));
  EXPECT_EQ(kindOf(result.refusal), "apart");
  ASSERT_EQ(result.report->left_out.size(), 1u);
  EXPECT_NE(result.report->left_out[0].reason.find("position_tracker"), std::string::npos);
  EXPECT_FALSE(result.tracks);

  sightline::TrackletArray tracklets;
  tracklets.header.stamp = ros::Time(1.0);
  tracklets.header.frame_id = "platform_enu";
  tracklets.tracker = "b";
  tracklets.tracklets.resize(1);
  tracklets.tracklets[0].sensor = "sensor of b";
  EXPECT_EQ(kindOf(component.onTracklets(tracklets, "/b/tracklets", at(1.0))), "apart");
  EXPECT_NEAR(component.places()->spread(), 80.0, 1e-9);
}

}  // namespace
