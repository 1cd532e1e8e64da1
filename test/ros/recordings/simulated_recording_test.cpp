#include "sightline/ros/recordings/simulated_recording.h"

#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <rosbag/view.h>
#include <sightline/PositionTrackArray.h>
#include <sightline/SightingArray.h>
#include <sightline/TrackArray.h>
#include <tf2_msgs/TFMessage.h>

#include "sightline/core/model/sphere.h"
#include "sightline/core/simulation/sensor_simulator.h"
#include "sightline/ros/messages/conversions.h"
#include "sightline/ros/params/scenario_params.h"
#include "sightline/ros/recordings/bags.h"
#include "sightline/ros/recordings/recorded_transforms.h"

#include "support/paths.h"
#include "support/scratch_folder.h"

namespace {

namespace core = sightline::core;
using sightline_ros::ParamReader;
using sightline_ros::recordSimulation;
using sightline_ros::SimulatedRecordingParams;
using sightline_ros::toCore;

core::Scenario shipped(const std::string& name, double duration) {
  core::Scenario scenario = sightline_ros::loadScenario(ParamReader::fromYamlFiles(
      {sightline::test::sourceDirectory() + "/config/sensors/six_sensors.yaml",
       sightline::test::sourceDirectory() + "/config/scenarios/" + name + ".yaml"}));
  scenario.duration = duration;
  return scenario;
}

class SimulatedRecording : public testing::Test {
 protected:
  void record(const core::Scenario& scenario, const SimulatedRecordingParams& params = {}) {
    sightline_ros::BagWriter out(file_);
    summary_ = recordSimulation(scenario, params, *out);
    out.finish();
    bag_ = sightline_ros::openBag(file_);
  }

  template <typename Message>
  std::vector<typename Message::ConstPtr> all(const std::string& topic) {
    std::vector<typename Message::ConstPtr> messages;
    rosbag::View view(*bag_, rosbag::TopicQuery(topic));
    for (const rosbag::MessageInstance& instance : view) messages.push_back(instance.instantiate<Message>());
    return messages;
  }

  ScratchFolder folder_;
  std::string file_ = folder_.write("recording.bag", "");
  std::unique_ptr<rosbag::Bag> bag_;
  sightline_ros::SimulatedRecordingSummary summary_;
};

TEST_F(SimulatedRecording, ScansAreThoseOfTheSimulatorsInTheOrderOfPublication) {
  const core::Scenario scenario = shipped("two_targets_clutter", 3.0);
  record(scenario);
  std::size_t scans = 0;
  for (const core::SimulatedSensor& sensor : scenario.sensors) {
    const auto recorded = all<sightline::SightingArray>("/sensors/" + sensor.name + "/sightings");
    core::SensorSimulator simulator(scenario, sensor.name, SimulatedRecordingParams{}.start);
    for (const auto& scan : recorded) {
      const auto expected = simulator.next();
      ASSERT_TRUE(expected);
      EXPECT_EQ(toCore(scan->header.stamp), expected->scan.time);
      EXPECT_EQ(scan->header.frame_id, sensor.name);
      ASSERT_EQ(scan->sightings.size(), expected->scan.sightings.size());
      for (std::size_t i = 0; i < scan->sightings.size(); ++i) {
        EXPECT_EQ(scan->sightings[i].azimuth, core::anglesOf(expected->scan.sightings[i].direction).x());
      }
    }
    EXPECT_FALSE(simulator.next());
    scans += recorded.size();
  }
  EXPECT_EQ(scans, summary_.scans);
  EXPECT_GT(scans, 400U);
  EXPECT_EQ(all<sightline::TrackArray>("/truth").size(), 301U);
}

TEST_F(SimulatedRecording, FixedTransformsAreLatchedForTrackersThatStartLater) {
  record(shipped("two_targets_clutter", 0.5));
  rosbag::View view(*bag_, rosbag::TopicQuery("/tf_static"));
  ASSERT_EQ(view.size(), 1u);
  EXPECT_TRUE(view.begin()->isLatching());
}

TEST_F(SimulatedRecording, EveryScanOfAMovingPlatformHasItsTransform) {
  const core::Scenario scenario = shipped("fast_turn", 2.0);
  record(scenario);
  sightline_ros::RecordedTransforms transforms(*bag_);
  transforms.advanceTo(SimulatedRecordingParams{}.start + std::chrono::seconds(10));
  for (const core::SimulatedSensor& sensor : scenario.sensors) {
    for (const auto& scan : all<sightline::SightingArray>("/sensors/" + sensor.name + "/sightings")) {
      EXPECT_TRUE(transforms.buffer().canTransform("platform_enu", sensor.name, scan->header.stamp));
    }
  }
  EXPECT_GT(all<tf2_msgs::TFMessage>("/tf").size(), 200U);
}

TEST_F(SimulatedRecording, WhatIsNotToBeStatedIsNotKnown) {
  SimulatedRecordingParams params;
  params.is_stated = false;
  record(shipped("heavy_clutter", 0.5), params);
  const auto scans = all<sightline::SightingArray>("/sensors/tracking_1/sightings");
  ASSERT_FALSE(scans.empty());
  EXPECT_TRUE(std::isnan(scans[0]->detection_probability));
  EXPECT_TRUE(std::isnan(scans[0]->clutter_density));
}

TEST_F(SimulatedRecording, ScenarioWithoutEndIsRefused) {
  EXPECT_THROW(record(shipped("six_sensors_paper", std::numeric_limits<double>::infinity())),
               std::invalid_argument);
}

TEST(ScenarioFile, NameAndPathLeadToTheSameFileAndUnknownOnesToTheList) {
  EXPECT_EQ(sightline_ros::scenarioFile("crowd"), sightline_ros::scenarioFile("crowd.yaml"));
  EXPECT_EQ(sightline_ros::scenarioFile(sightline_ros::scenarioFile("crowd")),
            sightline_ros::scenarioFile("crowd"));
  const ScratchFolder here;
  here.write("own.yaml", "seed: 1\n");
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::current_path(here.path());
  EXPECT_EQ(sightline_ros::scenarioFile("own.yaml"), "own.yaml");
  EXPECT_EQ(sightline_ros::scenarioFile("./own"), "./own.yaml");
  std::filesystem::current_path(before);
  try {
    sightline_ros::scenarioFile("crowds");
    FAIL() << "no refusal";
  } catch (const std::runtime_error& refusal) {
    EXPECT_NE(std::string(refusal.what()).find("heavy_clutter"), std::string::npos) << refusal.what();
  }
}

TEST_F(SimulatedRecording, StationsHaveTransformsAndTargetsTheirTruePositions) {
  core::Scenario scenario = sightline_ros::loadScenario(
      ParamReader::fromYamlFiles(sightline_ros::scenarioFiles("ship_and_shore", "")));
  scenario.duration = 1.0;
  record(scenario);
  sightline_ros::RecordedTransforms transforms(*bag_);
  transforms.advanceTo(SimulatedRecordingParams{}.start + std::chrono::seconds(10));
  const auto scans = all<sightline::SightingArray>("/sensors/camera_2/sightings");
  ASSERT_GT(scans.size(), 15U);
  for (const auto& scan : scans)
    EXPECT_TRUE(transforms.buffer().canTransform("world", "station_2_enu", scan->header.stamp));
  const auto truth = all<sightline::PositionTrackArray>("/truth/positions");
  ASSERT_EQ(truth.size(), 101U);
  EXPECT_EQ(truth[0]->tracks.size(), 3U);
}

TEST(ScenarioFile, SixSensorsComeBeforeAScenarioUnlessItHasStationsOrOthersAreGiven) {
  EXPECT_EQ(sightline_ros::scenarioFiles("crowd", "").size(), 2U);
  EXPECT_EQ(sightline_ros::scenarioFiles("stations_field", "").size(), 1U);
  EXPECT_EQ(sightline_ros::scenarioFiles("stations_field", "own.yaml").front(), "own.yaml");
}

}  // namespace
