#include "sightline/ros/display/position_picture.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "sightline/core/model/sphere.h"

namespace {

using namespace sightline_ros;
namespace core = sightline::core;

sightline::PositionTrack positionAt(double x, std::uint32_t id = 4) {
  sightline::PositionTrack track;
  track.id = id;
  track.status = sightline::PositionTrack::CONFIRMED;
  track.position.x = x;
  track.position.y = 50.0;
  track.position.z = 20.0;
  track.velocity.x = 8.0;
  for (std::size_t i = 0; i < 6; ++i) track.covariance[7 * i] = 0.01;
  track.sources = {"west/7"};
  return track;
}

sightline::PositionTrackArray positions(double stamp, const std::vector<sightline::PositionTrack>& tracks) {
  sightline::PositionTrackArray array;
  array.header.stamp = ros::Time(stamp);
  array.header.frame_id = "world";
  array.tracks = tracks;
  return array;
}

/// Two stations 100 m apart.
PositionPicture twoStations() {
  PositionPicture picture(PositionPictureParams{}, SensorColours({"west", "east"}));
  picture.setStations({{"west", {0.0, 0.0, 2.0}, Eigen::Matrix3d::Identity(), {0.5, 0.4}},
                       {"east", {100.0, 0.0, 4.0}, Eigen::Matrix3d::Identity(), {0.5, 0.4}}});
  return picture;
}

sightline::TrackArray localTracks() {
  sightline::TrackArray tracks;
  tracks.tracker = "west";
  tracks.tracks.resize(3);
  tracks.tracks[0].id = 7;
  tracks.tracks[1].id = 8;
  tracks.tracks[1].azimuth = 1.0;
  tracks.tracks[2].id = 9;
  tracks.tracks[2].status = sightline::Track::TENTATIVE;
  tracks.tracks[0].status = tracks.tracks[1].status = sightline::Track::CONFIRMED;
  return tracks;
}

std::vector<Marker> markersOf(const MarkerArray& array, const std::string& name) {
  std::vector<Marker> found;
  for (const Marker& marker : array.markers)
    if (marker.ns == name && marker.action == Marker::ADD) found.push_back(marker);
  return found;
}

TEST(PositionPicture, SceneIsAsLargeAsTheStationsStandApartAndItsMiddleIsBetweenThem) {
  PositionPicture picture = twoStations();
  EXPECT_NEAR(picture.size(), std::hypot(100.0, 2.0), 1e-9);
  EXPECT_NEAR(picture.middle().x(), 50.0, 1e-9);
  EXPECT_EQ(markersOf(picture.draw(1.0)[PositionPicture::kStations], "names").size(), 2u);
}

TEST(PositionPicture, OfARecordingWithoutFieldsOfViewTheTrackersTellWhereTheStationsStand) {
  PositionPicture picture(PositionPictureParams{}, SensorColours({"west", "east"}));
  core::StationPose west, east;
  east.origin = {100.0, 0.0, 0.0};
  sightline::TrackArray tracks = localTracks();
  picture.addTracks(tracks, west, 1.0);
  tracks.tracker = "east";
  picture.addTracks(tracks, east, 1.0);
  EXPECT_NEAR(picture.size(), 100.0, 1e-9);
  EXPECT_NEAR(picture.middle().x(), 50.0, 1e-9);
  EXPECT_EQ(markersOf(picture.draw(1.0)[PositionPicture::kStations], "names").size(), 2u);
  picture.draw(10.0);
  picture.draw(0.0);  // the trackers are silent, and then the recording begins anew: the camera stays
  EXPECT_NEAR(picture.size(), 100.0, 1e-9);
}

TEST(PositionPicture, RayOfATrackThatSupportsAPositionEndsThereAndTheOthersGoOn) {
  PositionPicture picture = twoStations();
  core::StationPose pose;
  pose.origin = {0.0, 0.0, 2.0};
  picture.addTracks(localTracks(), pose, 1.0);
  picture.addPositions(positions(1.0, {positionAt(30.0)}), 1.0);
  auto sheets = picture.draw(1.0);
  const auto used = markersOf(sheets[PositionPicture::kRays], "of positions");
  ASSERT_EQ(used.size(), 1u);
  ASSERT_EQ(used[0].points.size(), 2u);
  EXPECT_NEAR(used[0].points[1].x, Eigen::Vector3d(30.0, 50.0, 18.0).norm(), 1e-9);
  const auto free = markersOf(sheets[PositionPicture::kRays], "without a position");
  ASSERT_EQ(free.size(), 1u);
  EXPECT_EQ(free[0].points.size(), 2u) << "the tentative one is not drawn";
  EXPECT_GT(free[0].points[1].y, 100.0);
}

TEST(PositionPicture, PositionHasEllipsoidVelocityTrailAndLabel) {
  PositionPicture picture = twoStations();
  for (int i = 0; i <= 20; ++i)
    picture.addPositions(positions(1.0 + 0.1 * i, {positionAt(30.0 + 0.8 * i)}), 1.0 + 0.1 * i);
  const MarkerArray array = picture.draw(3.0)[PositionPicture::kPositions];
  const auto ellipsoids = markersOf(array, "ellipsoids");
  ASSERT_EQ(ellipsoids.size(), 1u);
  EXPECT_NEAR(ellipsoids[0].scale.x, 5.0 * 4.0 * 0.1, 1e-6) << "two sigmas of 0.1 m, five times as large";
  ASSERT_EQ(markersOf(array, "velocities").size(), 1u);
  EXPECT_NEAR(markersOf(array, "velocities")[0].points[1].x, 46.0 + 8.0, 1e-9);
  ASSERT_EQ(markersOf(array, "histories").size(), 1u);
  EXPECT_EQ(markersOf(array, "histories")[0].points.size(), 40u);
  ASSERT_EQ(markersOf(array, "labels").size(), 1u);
  EXPECT_EQ(markersOf(array, "labels")[0].text, "4  8.0 m/s\nsigma 10 cm\n1 station");
  ASSERT_EQ(markersOf(array, "scale").size(), 1u);
  EXPECT_NE(markersOf(array, "scale")[0].text.find("x 5"), std::string::npos);
}

TEST(PositionPicture, RefusedCrossingsAreCrossedOutWithTheirKind) {
  PositionPicture picture = twoStations();
  sightline::PositionReport report;
  for (const char* kind : {"ghost", "ambiguous"}) {
    sightline::RefusedCrossing crossing;
    crossing.position.x = 40.0;
    crossing.kind = kind;
    report.refused.push_back(crossing);
  }
  report.refused.push_back(report.refused[0]);
  report.refused.back().position.x = 1e7;  // out of the picture
  picture.addReport(report, 1.0);
  const MarkerArray array = picture.draw(1.0)[PositionPicture::kRefused];
  const auto kinds = markersOf(array, "kinds");
  ASSERT_EQ(kinds.size(), 2u);
  EXPECT_EQ(kinds[0].text, "ghost");
  EXPECT_NE(kinds[0].color.g, kinds[1].color.g);
  EXPECT_TRUE(markersOf(picture.draw(5.0)[PositionPicture::kRefused], "kinds").empty()) << "silent for long";
}

TEST(PositionPicture, WhatIsSilentVanishesAndItsSheetIsDeleted) {
  PositionPicture picture = twoStations();
  picture.addSightings("west", {0.0, 0.0, 2.0}, {Eigen::Vector3d::UnitX()}, 1.0);
  picture.addTruth(positions(1.0, {positionAt(30.0)}), 1.0);
  auto sheets = picture.draw(1.1);
  ASSERT_EQ(markersOf(sheets[PositionPicture::kStations], "sightings").size(), 1u);
  EXPECT_EQ(markersOf(sheets[PositionPicture::kTruth], "targets").at(0).points.size(), 6u);
  sheets = picture.draw(4.0);
  EXPECT_TRUE(markersOf(sheets[PositionPicture::kStations], "sightings").empty());
  EXPECT_TRUE(markersOf(sheets[PositionPicture::kTruth], "targets").empty());
  for (const Marker& marker : sheets[PositionPicture::kTruth].markers)
    EXPECT_EQ(marker.action, Marker::DELETE);
}

TEST(PositionPicture, WhatIsNotFiniteIsLeftOutAndWhatIsKeptIsBounded) {
  PositionPicture picture = twoStations();
  sightline::PositionTrack broken = positionAt(std::numeric_limits<double>::quiet_NaN(), 5);
  picture.addPositions(positions(1.0, {broken, positionAt(30.0)}), 1.0);
  EXPECT_EQ(markersOf(picture.draw(1.0)[PositionPicture::kPositions], "ellipsoids").size(), 1u);
  for (int i = 0; i < 5000; ++i) {
    picture.addPositions(positions(1.0 + 0.0001 * i, {positionAt(30.0 + i)}), 1.0);
    picture.addSightings("west", {0.0, 0.0, 0.0}, {Eigen::Vector3d::UnitX()}, 1.0);
  }
  auto sheets = picture.draw(1.0);
  EXPECT_LE(markersOf(sheets[PositionPicture::kPositions], "histories").at(0).points.size(), 1000u);
  EXPECT_LE(markersOf(sheets[PositionPicture::kStations], "sightings").at(0).points.size(), 4000u);
}

TEST(PositionPicture, RecordingThatStartsAnewForgetsWhatWas) {
  PositionPicture picture = twoStations();
  picture.addPositions(positions(100.0, {positionAt(30.0)}), 100.0);
  EXPECT_TRUE(markersOf(picture.draw(50.0)[PositionPicture::kPositions], "ellipsoids").empty());
}

}  // namespace
