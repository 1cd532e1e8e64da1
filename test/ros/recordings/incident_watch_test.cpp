#include "sightline/ros/recordings/incident_watch.h"

#include <gtest/gtest.h>

namespace {

using sightline::Track;
using sightline_ros::IncidentWatch;

constexpr const char* kTopic = "/fusion/tracks";

sightline::TrackArray tracksOf(const std::map<std::uint32_t, std::uint8_t>& status_by_id) {
  sightline::TrackArray tracks;
  for (const auto& [id, status] : status_by_id) {
    tracks.tracks.emplace_back();
    tracks.tracks.back().id = id;
    tracks.tracks.back().status = status;
  }
  return tracks;
}

TEST(IncidentWatch, NamesABelievedTrackThatEndsAndOnlyOnce) {
  IncidentWatch watch;
  EXPECT_FALSE(watch.onTracks(kTopic, tracksOf({{7, Track::CONFIRMED}, {8, Track::CONFIRMED}})));
  EXPECT_FALSE(watch.onTracks(kTopic, tracksOf({{7, Track::COASTING}, {8, Track::CONFIRMED}})));
  EXPECT_EQ(watch.onTracks(kTopic, tracksOf({{8, Track::CONFIRMED}})), "track 7 of /fusion/tracks ended");
  EXPECT_FALSE(watch.onTracks(kTopic, tracksOf({{8, Track::CONFIRMED}})));
}

TEST(IncidentWatch, NamesAllThatEndAtOnce) {
  IncidentWatch watch;
  watch.onTracks(kTopic, tracksOf({{7, Track::CONFIRMED}, {8, Track::CONFIRMED}}));
  EXPECT_EQ(watch.onTracks(kTopic, tracksOf({})), "tracks 7, 8 of /fusion/tracks ended");
}

TEST(IncidentWatch, TentativeTracksComeAndGo) {
  IncidentWatch watch;
  EXPECT_FALSE(watch.onTracks(kTopic, tracksOf({{7, Track::TENTATIVE}})));
  EXPECT_FALSE(watch.onTracks(kTopic, tracksOf({})));
}

TEST(IncidentWatch, TracksOfOneTopicDoNotEndThoseOfAnother) {
  IncidentWatch watch;
  watch.onTracks("/a/tracks", tracksOf({{7, Track::CONFIRMED}}));
  EXPECT_FALSE(watch.onTracks("/b/tracks", tracksOf({})));
  EXPECT_EQ(watch.onTracks("/a/tracks", tracksOf({})), "track 7 of /a/tracks ended");
}

TEST(IncidentWatch, NamesASensorWhoseVerdictChanges) {
  sightline::FusionReport report;
  report.tracks.resize(2);
  EXPECT_FALSE(IncidentWatch::onReport(report));
  report.tracks[1].sensor_changes.resize(1);
  report.tracks[1].sensor_changes[0].sensor = "left";
  report.tracks[1].sensor_changes[0].verdict = "biased";
  EXPECT_EQ(IncidentWatch::onReport(report), "sensor left is biased now");
}

}  // namespace
