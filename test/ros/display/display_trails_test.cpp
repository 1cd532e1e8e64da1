#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "sightline/ros/display/display_scene.h"

namespace {

using sightline_ros::DisplayScene;

/// Pieces of the trail of each of `count` tracks that were told 160 times in 3.2 s.
std::size_t piecesOfTrails(std::uint32_t count) {
  const sightline_ros::DisplayParams params;
  DisplayScene scene(params, sightline_ros::SensorColours(std::vector<std::string>{}));
  for (int i = 0; i < 160; ++i) {
    sightline::TrackArray report;
    report.header.stamp.fromSec(1.0 + 0.02 * i);
    for (std::uint32_t id = 1; id <= count; ++id) {
      sightline::Track track;
      track.id = id;
      track.status = sightline::Track::CONFIRMED;
      track.azimuth = 0.05 * id + 1e-3 * i;
      for (std::size_t k = 0; k < 4; ++k) track.covariance[5 * k] = 1e-4;
      report.tracks.push_back(track);
    }
    scene.addTracks(DisplayScene::kMainChannel, report, report.header.stamp.toSec());
  }
  const auto sheets = scene.draw(4.2);
  for (const auto& marker : sheets.at(DisplayScene::kMainChannel).markers)
    if (marker.ns == "histories") return marker.points.size() / 2 / count;
  return 0;
}

TEST(DisplayTrails, OfOneTrackIsSmoothAndThoseOfACrowdHaveFewPieces) {
  EXPECT_GE(piecesOfTrails(1), 150U);
  EXPECT_LE(piecesOfTrails(20), 32U);
  EXPECT_GE(piecesOfTrails(20), 16U);
}

}  // namespace
