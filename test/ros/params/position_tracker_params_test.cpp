#include "sightline/ros/params/position_tracker_params.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <tf2/buffer_core.h>

#include "sightline/ros/components/component_params.h"
#include "sightline/ros/components/position_tracker_component.h"
#include "sightline/ros/components/position_tracker_health.h"

#include "support/paths.h"
#include "support/scratch_folder.h"

namespace {

namespace core = sightline::core;
using sightline_ros::ParamError;
using sightline_ros::ParamReader;
using sightline_ros::PositionTrackerComponent;
using sightline_ros::PositionTrackerHealth;

core::PositionTrackerParams positionParamsOf(const std::string& yaml) {
  const ScratchFolder folder;
  const ParamReader reader = ParamReader::fromYaml(folder.write("params.yaml", yaml));
  const core::PositionTrackerParams params = sightline_ros::loadPositionTrackerParams(reader);
  reader.finish();
  return params;
}

TEST(PositionTrackerParams, ShippedFileSaysTheDefaultsAndNothingElse) {
  const ParamReader reader =
      ParamReader::fromYaml(sightline::test::sourceDirectory() + "/config/position_tracker.yaml");
  const tf2::BufferCore transforms;
  const PositionTrackerComponent component(reader, "node", transforms);
  silenceFrom(reader);
  EXPECT_NO_THROW(reader.finish());
  EXPECT_EQ(reader.differences(), std::vector<std::string>{});
  EXPECT_EQ(component.name(), "node");
  EXPECT_EQ(component.trackingFrame(), "world");
}

TEST(PositionTrackerParams, EveryKeyReachesItsField) {
  const core::PositionTrackerParams params = positionParamsOf(
      "{max_lag: 0.2, max_relative_sigma: 0.25, decision_interval: 0.4, claim_gate: 9.0, claim_decisions: 4,"
      " contradiction: 20.0, contradiction_time: 0.6, merge_gate: 12.0, confirm_after: 0.7,"
      " confirm_pair_after: 0.9, coast_after: 0.8,"
      " delete_after: 3.0, remember_for: 4.0, max_local_tracks: 50, max_targets: 60}");
  const core::PositionSceneParams& scene = params.scene;
  EXPECT_EQ(params.max_lag, 0.2);
  EXPECT_EQ(scene.estimator.max_relative_sigma, 0.25);
  EXPECT_EQ(scene.hypotheses.max_relative_sigma, 0.25);
  EXPECT_EQ(scene.decision_interval, 0.4);
  EXPECT_EQ(scene.claim_gate, 9.0);
  EXPECT_EQ(scene.claim_decisions, 4);
  EXPECT_EQ(scene.contradiction, 20.0);
  EXPECT_EQ(scene.contradiction_time, 0.6);
  EXPECT_EQ(scene.merge_gate, 12.0);
  EXPECT_EQ(scene.confirm_after, 0.7);
  EXPECT_EQ(scene.confirm_pair_after, 0.9);
  EXPECT_EQ(scene.coast_after, 0.8);
  EXPECT_EQ(scene.delete_after, 3.0);
  EXPECT_EQ(scene.remember_for, 4.0);
  EXPECT_EQ(scene.max_local_tracks, 50);
  EXPECT_EQ(scene.max_targets, 60);
}

TEST(PositionTrackerParams, EveryKeyOfTheSectionsReachesItsField) {
  const core::PositionSceneParams scene =
      positionParamsOf(
          "{estimator: {dwell: 5.0, scale_memory: 2.0, outlier_distance: 3.0, alone_after: 0.2,"
          " alone_intervals: 4.0, start_window: 0.9, lost_relative_sigma: 2.0, fast_share: 0.1, fast_time: "
          "0.02},"
          " hypotheses: {gate: 4.0, detection_probability: 0.8, memory: 3.0, correlation_time: 0.7,"
          " least_score: 1.0, least_margin: 2.0, least_fit_margin: 5.0, most_candidates: 10},"
          " station_noise: {slow_scale: 2.0, time_constant: 5.0, safety: 1.5, memory: 30.0, prior_weight: "
          "20.0,"
          " least_scale: 0.2, most_scale: 10.0, least_time: 1.0, most_time: 20.0, learn_time: true},"
          " station_correction: {enabled: false, normal_clock_sigma: 2.0e-03, normal_orientation_sigma: "
          "3.0e-04,"
          " significance: 6.0, release: 2.0, least_margin: 4.0}}")
          .scene;
  EXPECT_FALSE(scene.correction.enabled);
  EXPECT_EQ(scene.correction.normal_clock_sigma, 2e-3);
  EXPECT_EQ(scene.correction.normal_orientation_sigma, 3e-4);
  EXPECT_EQ(scene.correction.significance, 6.0);
  EXPECT_EQ(scene.correction.release, 2.0);
  EXPECT_EQ(scene.correction.least_margin, 4.0);
  EXPECT_EQ(scene.estimator.dwell, 5.0);
  EXPECT_EQ(scene.estimator.scale_memory, 2.0);
  EXPECT_EQ(scene.estimator.outlier_distance, 3.0);
  EXPECT_EQ(scene.estimator.alone_after, 0.2);
  EXPECT_EQ(scene.estimator.alone_intervals, 4.0);
  EXPECT_EQ(scene.estimator.start_window, 0.9);
  EXPECT_EQ(scene.estimator.lost_relative_sigma, 2.0);
  EXPECT_EQ(scene.estimator.fast_share, 0.1);
  EXPECT_EQ(scene.estimator.fast_time, 0.02);
  EXPECT_EQ(scene.hypotheses.gate, 4.0);
  EXPECT_EQ(scene.hypotheses.detection_probability, 0.8);
  EXPECT_EQ(scene.hypotheses.memory, 3.0);
  EXPECT_EQ(scene.hypotheses.correlation_time, 0.7);
  EXPECT_EQ(scene.hypotheses.least_score, 1.0);
  EXPECT_EQ(scene.hypotheses.least_margin, 2.0);
  EXPECT_EQ(scene.hypotheses.least_fit_margin, 5.0);
  EXPECT_EQ(scene.hypotheses.most_candidates, 10);
  EXPECT_EQ(scene.noise.slow_scale, 2.0);
  EXPECT_EQ(scene.noise.time_constant, 5.0);
  EXPECT_EQ(scene.noise.safety, 1.5);
  EXPECT_EQ(scene.noise.memory, 30.0);
  EXPECT_EQ(scene.noise.prior_weight, 20.0);
  EXPECT_EQ(scene.noise.least_scale, 0.2);
  EXPECT_EQ(scene.noise.most_scale, 10.0);
  EXPECT_EQ(scene.noise.least_time, 1.0);
  EXPECT_EQ(scene.noise.most_time, 20.0);
  EXPECT_TRUE(scene.noise.learn_time);
}

TEST(PositionTrackerParams, ListOfModelsReplacesTheDefaultBank) {
  const auto models =
      positionParamsOf("estimator: {models: [{kind: white_jerk, ratio: 7.0}]}").scene.estimator.models;
  ASSERT_EQ(models.size(), 1u);
  EXPECT_EQ(models[0].kind, core::PositionModel::Kind::white_jerk);
  EXPECT_EQ(models[0].ratio, 7.0);
  EXPECT_THROW(positionParamsOf("estimator: {models: []}"), ParamError);
  EXPECT_THROW(positionParamsOf("estimator: {models: [{kind: magic, ratio: 1.0}]}"), ParamError);
}

/// What is said about `fields_of_view`; empty when it is taken.
std::string complaintAboutViews(const std::string& views) {
  const ScratchFolder folder;
  const ParamReader reader =
      ParamReader::fromYaml(folder.write("params.yaml", "fields_of_view: " + views + "\n"));
  const tf2::BufferCore transforms;
  try {
    const PositionTrackerComponent component(reader, "node", transforms);
    reader.finish();
  } catch (const ParamError& error) {
    return error.what();
  }
  return "";
}

TEST(PositionTrackerParams, FieldsOfViewAreReadAndBadOnesAreRefused) {
  const std::string good = "{tracker: a, frame: eye, azimuth_half_width: deg(40), elevation_half_width: 0.3}";
  EXPECT_EQ(complaintAboutViews("[]"), "");
  EXPECT_EQ(
      complaintAboutViews("[" + good + ", {tracker: a, azimuth_half_width: 0.5, elevation_half_width: 0.3}]"),
      "");
  EXPECT_NE(complaintAboutViews("[" + good + ", " + good + "]").find("is given twice"), std::string::npos);
  for (const char* bad : {"{frame: eye, azimuth_half_width: 0.5, elevation_half_width: 0.3}",
                          "{tracker: a, frame: /eye, azimuth_half_width: 0.5, elevation_half_width: 0.3}",
                          "{tracker: a, azimuth_half_width: 3.2, elevation_half_width: 0.3}",
                          "{tracker: a, azimuth_half_width: 0.5, elevation_half_width: 1.6}",
                          "{tracker: a, azimuth_half_width: 0.0, elevation_half_width: 0.3}",
                          "{tracker: a, azimuth_half_width: 0.5}",
                          "{tracker: a, sensor: b, azimuth_half_width: 0.5, elevation_half_width: 0.3}"})
    EXPECT_NE(complaintAboutViews(std::string("[") + bad + "]"), "") << bad;
  EXPECT_NE(complaintAboutViews("{a: 1}"), "");
}

TEST(PositionTrackerParams, BadValuesAreRefused) {
  for (const char* yaml :
       {"max_relative_sigma: 1.0", "max_relative_sigma: 0.0", "max_lag: -1.0", "decision_interval: 0.0",
        "claim_decisions: 0", "max_targets: 0", "estimator: {lost_relative_sigma: 0.2}",
        "hypotheses: {detection_probability: 1.0}", "station_noise: {least_scale: 5.0, most_scale: 4.0}",
        "estimator: {outlier_distance: 0.5}", "unknown_key: 1"}) {
    EXPECT_THROW(positionParamsOf(yaml), ParamError) << yaml;
  }
}

}  // namespace
