#include "sightline/ros/messages/frame_params.h"

#include <string>

#include <gtest/gtest.h>

#include "support/scratch_folder.h"

namespace {

using sightline_ros::FrameChangeParams;
using sightline_ros::ParamError;
using sightline_ros::ParamReader;

ParamReader readerOf(const std::string& yaml) {
  const ScratchFolder folder;
  return ParamReader::fromYaml(folder.write("frames.yaml", yaml));
}

std::string complaintAbout(const std::string& yaml) {
  try {
    sightline_ros::loadTrackerFrameParams(readerOf(yaml));
  } catch (const ParamError& refusal) {
    return refusal.what();
  }
  return "none";
}

TEST(FrameParams, KeysThatAreNotSetKeepTheDefaults) {
  const FrameChangeParams params = sightline_ros::loadTrackerFrameParams(readerOf("max_future: 0.25"));
  EXPECT_EQ(params.tracking_frame, "platform_enu");
  EXPECT_EQ(params.max_future, 0.25);
  EXPECT_EQ(params.tf_timeout, FrameChangeParams{}.tf_timeout);
  EXPECT_TRUE(params.attitude.isExact());
  EXPECT_TRUE(params.fields_of_view.empty());
}

TEST(FrameParams, FieldsOfViewAndAttitudeAreThoseOfATracker) {
  const FrameChangeParams params = sightline_ros::loadTrackerFrameParams(
      readerOf("{fields_of_view: [{sensor: eye, azimuth_half_width: 0.5, elevation_half_width: 0.25}], "
               "attitude_sigma: [0.001, 0.002, 0.003], attitude_time_sigma: 0.01}"));
  EXPECT_EQ(params.fields_of_view.at("eye"), Eigen::Vector2d(0.5, 0.25));
  EXPECT_EQ(params.attitude.sigma, Eigen::Vector3d(0.001, 0.002, 0.003));
  EXPECT_EQ(params.attitude.time_sigma, 0.01);
}

TEST(FrameParams, WhatCannotBeMeantIsRefusedByName) {
  EXPECT_NE(complaintAbout("tracking_frame: /map").find("without leading slash"), std::string::npos);
  EXPECT_NE(complaintAbout("attitude_sigma: [0.1, 0.1]").find("expected three numbers"), std::string::npos);
  EXPECT_NE(
      complaintAbout("{fields_of_view: [{sensor: a, azimuth_half_width: 0.5, elevation_half_width: 0.2}, "
                     "{sensor: a, azimuth_half_width: 0.5, elevation_half_width: 0.2}]}")
          .find("given twice"),
      std::string::npos);
  EXPECT_NE(complaintAbout("tf_timeout: -0.1").find("tf_timeout"), std::string::npos);
}

}  // namespace
