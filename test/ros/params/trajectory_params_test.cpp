#include "sightline/ros/params/trajectory_params.h"

#include <string>

#include <gtest/gtest.h>

#include "support/scratch_folder.h"

namespace {

namespace core = sightline::core;
using sightline_ros::ParamError;
using sightline_ros::ParamReader;

ParamReader motionReader(const std::string& yaml) {
  const ScratchFolder folder;
  return ParamReader::fromYaml(folder.write("motion.yaml", yaml));
}

/// The complaint about a trajectory; "none" when it is read.
std::string complaintAbout(const std::string& yaml) {
  try {
    sightline_ros::loadTrajectory(motionReader(yaml), 1);
  } catch (const ParamError& refusal) {
    return refusal.what();
  }
  return "none";
}

TEST(TrajectoryParams, WithoutKeysTheTargetIsThePapersAndThePlatformStandsStill) {
  const auto trajectory = sightline_ros::loadTrajectory(motionReader("{}"), 1);
  ASSERT_TRUE(std::holds_alternative<core::Sinusoid>(trajectory));
  EXPECT_EQ(std::get<core::Sinusoid>(trajectory).amplitude, core::Sinusoid{}.amplitude);
  EXPECT_TRUE(
      std::holds_alternative<core::FixedPlatform>(sightline_ros::loadPlatformMotion(motionReader("{}"))));
}

TEST(TrajectoryParams, KeysOfTheChosenKindAreRead) {
  const auto line = sightline_ros::loadTrajectory(
      motionReader("{trajectory: line, angles: [0.5, 0.25], rates: [0.125, -0.5]}"), 1);
  EXPECT_EQ(std::get<core::AngularLine>(line).rates, Eigen::Vector2d(0.125, -0.5));
  const auto orbit =
      sightline_ros::loadPlatformMotion(motionReader("{motion: orbit, radius: 20.0, phase: 1.0}"));
  EXPECT_EQ(std::get<core::OrbitPlatform>(orbit).radius, 20.0);
}

TEST(TrajectoryParams, TheSeedIsThatOfARandomTrajectory) {
  const auto path = sightline_ros::loadTrajectory(motionReader("trajectory: white_acceleration"), 42);
  EXPECT_EQ(std::get<core::WhiteAcceleration>(path).seed, 42u);
}

TEST(TrajectoryParams, AnUnknownKindAndALoneNumberAreRefused) {
  EXPECT_NE(complaintAbout("trajectory: spiral").find("expected one of boost, flight"), std::string::npos)
      << complaintAbout("trajectory: spiral");
  EXPECT_NE(complaintAbout("{trajectory: line, rates: [0.1]}").find("expected a list of 2 numbers"),
            std::string::npos);
}

TEST(TrajectoryParams, WhatTheCoreRefusesIsRefusedWithTheKind) {
  const std::string boost =
      "{trajectory: boost, stages: [{acceleration: 1.0, burn: 5.0, coast: 0.0, elevation_start: 1.5, "
      "elevation_end: 1.5}]}";
  EXPECT_NE(complaintAbout(boost).find("trajectory: boost: the first stage does not lift off"),
            std::string::npos)
      << complaintAbout(boost);
}

}  // namespace
