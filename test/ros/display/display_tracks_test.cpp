#include "sightline/ros/display/display_tracks.h"

#include <cmath>

#include <gtest/gtest.h>

namespace {

namespace core = sightline::core;

sightline::Track trackAt(double azimuth, double elevation,
                         std::uint8_t status = sightline::Track::CONFIRMED) {
  sightline::Track track;
  track.status = status;
  track.azimuth = azimuth;
  track.elevation = elevation;
  return track;
}

TEST(DisplayTracks, ConfirmedAndCoastingTracksAreEstablished) {
  sightline::TrackArray report;
  for (const std::uint8_t status :
       {sightline::Track::TENTATIVE, sightline::Track::CONFIRMED, sightline::Track::COASTING})
    report.tracks.push_back(trackAt(0.0, 0.0, status));
  EXPECT_FALSE(sightline_ros::isEstablished(report.tracks[0]));
  EXPECT_EQ(sightline_ros::establishedIn(report), 2U);
}

TEST(DisplayTracks, SigmaIsTheLargerArcOfTheTwoAndNeverZero) {
  sightline::Track track = trackAt(0.3, 1.0);
  track.covariance[0] = 4e-4;
  track.covariance[5] = 1e-6;
  EXPECT_NEAR(sightline_ros::sigmaOf(track), 0.02 * std::cos(1.0), 1e-9);
  EXPECT_GT(sightline_ros::sigmaOf(trackAt(0.0, 0.0)), 0.0);
}

TEST(DisplayTracks, NearestTrackIsFoundAcrossTheWrapOfTheAzimuth) {
  sightline::TrackArray report;
  report.tracks = {trackAt(0.0, 0.0), trackAt(-3.1, 0.0)};
  EXPECT_EQ(sightline_ros::nearestTo({3.1, 0.0}, report), &report.tracks[1]);
  EXPECT_EQ(sightline_ros::nearestTo({3.1, 0.0}, sightline::TrackArray()), nullptr);
}

TEST(DisplayTracks, SideIsAcrossTheMotionTowardsTheCamera) {
  core::AngularState state;
  state.mean << 0.0, 0.0, 0.2, 0.0;
  EXPECT_LT((sightline_ros::sideOf(state, {0.0, 0.5}) - Eigen::Vector2d(0.0, 1.0)).norm(), 1e-12);
  EXPECT_LT((sightline_ros::sideOf(state, {0.0, -0.5}) - Eigen::Vector2d(0.0, -1.0)).norm(), 1e-12);
  state.mean(2) = 1e-3;
  EXPECT_EQ(sightline_ros::sideOf(state, {0.0, 0.5}), Eigen::Vector2d(0.0, -1.0));
}

TEST(DisplayTracks, SightingsNearAGateAreThoseInItAndHardlyBeyond) {
  sightline::Gate gate;
  gate.azimuth = 0.5;
  gate.azimuth_half_width = 0.03;
  gate.elevation_half_width = 0.04;
  EXPECT_TRUE(sightline_ros::isNearGate(gate, core::directionOf({0.5 + 0.07, 0.0})));
  EXPECT_FALSE(sightline_ros::isNearGate(gate, core::directionOf({0.5 + 0.08, 0.0})));
}

}  // namespace
