#include "sightline/ros/params/tracker_params.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <tf2/buffer_core.h>

#include "sightline/ros/components/component_params.h"
#include "sightline/ros/components/local_tracker_component.h"
#include "sightline/ros/components/local_tracker_health.h"

#include "support/paths.h"
#include "support/scratch_folder.h"

namespace {

namespace core = sightline::core;
using sightline_ros::loadLocalTrackerParams;
using sightline_ros::LocalTrackerComponent;
using sightline_ros::LocalTrackerHealth;
using sightline_ros::ParamError;
using sightline_ros::ParamReader;

TEST(TrackerParams, ShippedFileSaysTheDefaultsAndNothingElse) {
  const ParamReader reader =
      ParamReader::fromYaml(sightline::test::sourceDirectory() + "/config/local_tracker.yaml");
  const tf2::BufferCore transforms;
  const LocalTrackerComponent component(reader, "node", transforms);
  silenceFrom(reader);
  EXPECT_NO_THROW(reader.finish());
  EXPECT_EQ(reader.differences(), std::vector<std::string>{});
  EXPECT_EQ(component.name(), "node");
}

core::LocalTrackerParams trackerParamsOf(const std::string& yaml) {
  const ScratchFolder folder;
  const ParamReader reader = ParamReader::fromYaml(folder.write("params.yaml", yaml));
  const core::LocalTrackerParams params = loadLocalTrackerParams(reader);
  reader.finish();
  return params;
}

TEST(TrackerParams, EveryChoiceReachesItsField) {
  EXPECT_EQ(trackerParamsOf("estimator: noga").estimator.kind, core::EstimatorKind::noga);
  EXPECT_EQ(trackerParamsOf("estimator: imm").estimator.kind, core::EstimatorKind::imm);
  EXPECT_EQ(trackerParamsOf("gate: {shape: rectangle}").gate.shape, core::GateShape::rectangle);
  EXPECT_EQ(trackerParamsOf("twbls: {paper: {time_weight: linear}}").estimator.twbls.time_weight,
            core::TimeWeight::linear);
  EXPECT_EQ(trackerParamsOf("twbls: {paper: {sensor_weight: ifov}}").estimator.twbls.sensor_weight,
            core::SensorWeight::ifov);
  EXPECT_EQ(trackerParamsOf("twbls: {paper: {anchor: raw}}").estimator.twbls.anchor, core::TwblsAnchor::raw);
  EXPECT_EQ(trackerParamsOf("twbls: {paper: {covariance: fit_error}}").estimator.twbls.covariance,
            core::TwblsCovariance::fit_error);
  EXPECT_EQ(trackerParamsOf("noga: {paper: {covariance: printed}}").estimator.noga.covariance,
            core::NogaCovariance::printed);
  EXPECT_EQ(sightline_ros::nameOf(core::EstimatorKind::kalman), "kalman");
}

TEST(TrackerParams, ListOfModelsReplacesTheDefaultBank) {
  const auto models = trackerParamsOf("imm: {models: [{order: 1, process_noise: 0.5}]}").estimator.imm.models;
  ASSERT_EQ(models.size(), 1u);
  EXPECT_EQ(models[0].order, 1);
  EXPECT_EQ(models[0].noise.density, 0.5);
  EXPECT_THROW(trackerParamsOf("imm: {models: []}"), ParamError);
  EXPECT_THROW(trackerParamsOf("imm: {models: [{order: 3, process_noise: 0.5}]}"), ParamError);
  EXPECT_THROW(trackerParamsOf("imm: {models: [{order: 1, process_noise: 0, process_noise_ratio: 0}]}"),
               ParamError);
}

TEST(TrackerParams, WhatIsOutOfRangeIsRefused) {
  for (const char* wrong : {"max_lag: -0.1",
                            "max_tracks: 0",
                            "max_sightings: 0",
                            "estimator: best",
                            "gate: {probability: 1.0}",
                            "gate: {probability: 0.0}",
                            "gate: {min_half_width: 0.2, max_half_width: 0.1}",
                            "gate: {max_half_width: 0.0}",
                            "lifecycle: {confirm_hits: 6, confirm_scans: 5}",
                            "lifecycle: {coast_silence: 0.0}",
                            "lifecycle: {delete_misses: 0}",
                            "lifecycle: {confirm_existence: 1.0}",
                            "lifecycle: {show_existence: 1.0}",
                            "detection: {births: 0.0}",
                            "lifecycle: {mean_patience: 0.0}",
                            "lifecycle: {merge_scans: 0}",
                            "detection: {probability: 1.5}",
                            "detection: {memory: 1.0}",
                            "association: best",
                            "twbls: {paper: {window: 0}}",
                            "twbls: {paper: {max_sightings: 2}}",
                            "twbls: {consistent: {max_sightings: 2}}",
                            "twbls: {paper: {min_sightings: 200}}",
                            "twbls: {paper: {decay: 0.0}}",
                            "twbls: {consistent: {initial_rate_sigma: -0.1}}",
                            "noga: {paper: {rows: 2}}",
                            "noga: {form: best}",
                            "noga: {consistent: {outlier_share: 1.0}}",
                            "noga: {paper: {rows: 63}}",
                            "kalman: {process_noise: -1.0}",
                            "kalman: {process_noise_ratio: 0.0}",
                            "imm: {dwell: 0.0}",
                            "no_such_key: 1",
                            "gate: {probabilty: 0.9}"}) {
    EXPECT_THROW(trackerParamsOf(wrong), ParamError) << wrong;
  }
}

TEST(TrackerParams, FrameNamesAreChecked) {
  const ScratchFolder folder;
  const auto load = [&](const std::string& yaml) {
    sightline_ros::loadFrameChangeParams(ParamReader::fromYaml(folder.write("params.yaml", yaml)));
  };
  EXPECT_NO_THROW(load("tracking_frame: world"));
  EXPECT_THROW(load("tracking_frame: /world"), ParamError);
  EXPECT_THROW(load("tracking_frame: ''"), ParamError);
  EXPECT_THROW(load("tf_timeout: -1"), ParamError);
  EXPECT_THROW(load("max_waiting: 0"), ParamError);
}

TEST(TrackerParams, AttitudeSigmasAreReadAndChecked) {
  const ScratchFolder folder;
  const auto load = [&](const std::string& yaml) {
    const ParamReader reader = ParamReader::fromYaml(folder.write("params.yaml", yaml));
    const auto attitude = sightline_ros::loadTrackerFrameParams(reader).attitude;
    reader.finish();
    return attitude;
  };
  EXPECT_TRUE(load("tracking_frame: world").isExact());
  const auto attitude = load("{attitude_sigma: [0.001, 0.002, deg(1)], attitude_time_sigma: 0.005}");
  EXPECT_NEAR(attitude.sigma.z(), 0.0174533, 1e-6);
  EXPECT_EQ(attitude.sigma.head<2>(), Eigen::Vector2d(0.001, 0.002));
  EXPECT_EQ(attitude.time_sigma, 0.005);
  for (const char* wrong :
       {"attitude_sigma: 0.001", "attitude_sigma: [0.001]", "attitude_sigma: [0.0, 0.0, -0.1]",
        "attitude_sigma: [5, 5, 5]", "attitude_time_sigma: -0.1", "attitude_time_sigma: '5ms'"}) {
    EXPECT_THROW(load(wrong), ParamError) << wrong;
  }
}

TEST(TrackerParams, FieldsOfViewAreReadBySensor) {
  const ScratchFolder folder;
  const auto load = [&](const std::string& yaml) {
    const ParamReader reader = ParamReader::fromYaml(folder.write("params.yaml", yaml));
    const auto fields = sightline_ros::loadTrackerFrameParams(reader).fields_of_view;
    reader.finish();
    return fields;
  };
  EXPECT_TRUE(load("fields_of_view: []").empty());
  const auto fields = load(
      "fields_of_view: [{sensor: left, azimuth_half_width: deg(90), elevation_half_width: 0.4},"
      " {sensor: right, azimuth_half_width: 0.5, elevation_half_width: 1}]");
  ASSERT_EQ(fields.size(), 2u);
  EXPECT_NEAR(fields.at("left").x(), 1.5707963, 1e-6);
  EXPECT_EQ(fields.at("left").y(), 0.4);
  EXPECT_EQ(fields.at("right"), Eigen::Vector2d(0.5, 1.0));
  for (const char* wrong :
       {"fields_of_view: {left: [0.5, 0.4]}", "fields_of_view: [0.5, 0.4]",
        "fields_of_view: [{azimuth_half_width: 0.5, elevation_half_width: 0.4}]",
        "fields_of_view: [{sensor: left, azimuth_half_width: 0.5}]",
        "fields_of_view: [{sensor: left, azimuth_half_width: 20, elevation_half_width: 15}]",
        "fields_of_view: [{sensor: left, azimuth_half_width: 0.5, elevation_half_width: 1.6}]",
        "fields_of_view: [{sensor: left, azimuth_half_width: 0.0, elevation_half_width: 0.4}]",
        "fields_of_view: [{sensor: a, azimuth_half_width: 0.5, elevation_half_width: 0.4},"
        " {sensor: a, azimuth_half_width: 0.5, elevation_half_width: 0.4}]"}) {
    EXPECT_THROW(load(wrong), ParamError) << wrong;
  }
}

}  // namespace
