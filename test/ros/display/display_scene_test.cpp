#include "sightline/ros/display/display_scene.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "sightline/ros/display/label_places.h"
#include "sightline/ros/nodes/track_display_node.h"

#include "support/paths.h"

namespace {

namespace core = sightline::core;
using sightline_ros::DisplayParams;
using sightline_ros::DisplayScene;
using sightline_ros::Marker;
using sightline_ros::MarkerArray;
using sightline_ros::SensorColours;
using Sheets = std::map<std::string, MarkerArray>;

constexpr double kSigma = 0.02;  // of tracks, unless told otherwise [rad]

core::Scan scanAt(const std::string& sensor, double time, double azimuth, double elevation) {
  core::Scan scan;
  scan.time = core::timeOf(0) + core::durationOf(time);
  scan.sensor = sensor;
  scan.sightings.push_back(core::sightingOf({azimuth, elevation}, 1e-4 * Eigen::Matrix2d::Identity()));
  return scan;
}

sightline::Track track(std::uint32_t id, double azimuth, double elevation, double sigma = kSigma) {
  sightline::Track track;
  track.id = id;
  track.status = sightline::Track::CONFIRMED;
  track.azimuth = azimuth;
  track.elevation = elevation;
  track.azimuth_rate = 0.5;
  track.covariance[0] = track.covariance[5] = sigma * sigma;
  track.covariance[10] = track.covariance[15] = 1e-4;
  track.gate.azimuth = azimuth;
  track.gate.elevation = elevation;
  track.gate.azimuth_half_width = track.gate.elevation_half_width = 0.1;
  return track;
}

sightline::TrackArray report(double time, const std::vector<sightline::Track>& tracks) {
  sightline::TrackArray report;
  report.header.stamp.fromSec(time);
  report.header.frame_id = "platform_enu";
  report.tracks = tracks;
  return report;
}

/// The marker of a name in an array; nullptr when there is none or it is to be deleted.
const Marker* find(const Sheets& sheets, const std::string& channel, const std::string& name) {
  const auto array = sheets.find(channel);
  if (array == sheets.end()) return nullptr;
  for (const Marker& marker : array->second.markers) {
    if (marker.ns == name && marker.action == Marker::ADD) return &marker;
  }
  return nullptr;
}

bool isEmptied(const Sheets& sheets, const std::string& channel) {
  const auto array = sheets.find(channel);
  return array != sheets.end() &&
         std::all_of(array->second.markers.begin(), array->second.markers.end(),
                     [](const Marker& marker) { return marker.action == Marker::DELETE; });
}

class Scene : public testing::Test {
 protected:
  DisplayParams params;
  DisplayScene scene{params, SensorColours({"left", "right"})};
};

TEST_F(Scene, TentativeTracksHaveNoGateUnlessLookedAtOrAskedFor) {
  sightline::Track young = track(7, 0.0, 0.0);
  young.status = sightline::Track::TENTATIVE;
  const char* const kGates = "gates: tentative (yellow)";
  scene.addTracks("left", report(1.0, {young, track(8, 1.0, 0.0)}), 1.0);
  const Sheets usual = scene.draw(1.0);
  EXPECT_EQ(find(usual, "left", kGates), nullptr);
  EXPECT_NE(find(usual, "left", "gates: accepted (green)"), nullptr);
  EXPECT_LT(find(usual, "left", "tracks")->colors[0].a, find(usual, "left", "tracks")->colors[1].a)
      << "faint";
  scene.lookAt(sightline_ros::LookedAt{"left", 7, false});
  EXPECT_NE(find(scene.draw(1.0), "left", kGates), nullptr);
  params.tentative_gates = true;
  DisplayScene with_gates{params, SensorColours({"left"})};
  with_gates.addTracks("left", report(1.0, {young}), 1.0);
  EXPECT_NE(find(with_gates.draw(1.0), "left", kGates), nullptr);
}

TEST_F(Scene, TheTrackLookedAtHasACircle) {
  scene.addTracks(DisplayScene::kMainChannel, report(1.0, {track(1, 0.0, 0.0), track(2, 1.0, 0.0)}), 1.0);
  EXPECT_EQ(find(scene.draw(1.0), DisplayScene::kMainChannel, "selected"), nullptr);
  scene.lookAt(sightline_ros::LookedAt{DisplayScene::kMainChannel, 2, false});
  const Sheets sheets = scene.draw(1.0);
  const Marker* circle = find(sheets, DisplayScene::kMainChannel, "selected");
  ASSERT_NE(circle, nullptr);
  EXPECT_NEAR(std::atan2(circle->points[0].y, circle->points[0].x), 1.0, 0.06) << "round the second track";
  EXPECT_EQ(find(sheets, DisplayScene::kMainChannel, "tracks")->points.size(), 2u) << "with the others";
}

TEST_F(Scene, AloneATrackIsDrawnWithTheSightingsNearItsGateOnly) {
  const auto drawAll = [this] {
    scene.addTracks(DisplayScene::kMainChannel, report(1.0, {track(1, 0.0, 0.0), track(2, 1.0, 0.0)}), 1.0);
    scene.addTracks("left", report(1.0, {track(1, 0.0, 0.0)}), 1.0);
    scene.addScan(scanAt("left", 1.0, 0.02, 0.0), 1.0);
    scene.addScan(scanAt("left", 1.0, 1.02, 0.0), 1.0);
    return scene.draw(1.0);
  };
  scene.lookAt(sightline_ros::LookedAt{DisplayScene::kMainChannel, 2, true});
  const Sheets sheets = drawAll();
  EXPECT_EQ(find(sheets, DisplayScene::kMainChannel, "tracks")->points.size(), 1u);
  EXPECT_EQ(find(sheets, "left", "tracks"), nullptr)
      << "a track of another tracker, of another number or the same";
  ASSERT_NE(find(sheets, "left", "sightings"), nullptr);
  EXPECT_EQ(find(sheets, "left", "sightings")->points.size(), 1u);
  scene.lookAt(std::nullopt);
  EXPECT_EQ(find(drawAll(), DisplayScene::kMainChannel, "tracks")->points.size(), 2u);
}

TEST_F(Scene, EachSensorHasItsChannelAndItsColour) {
  scene.addScan(scanAt("left", 1.0, 0.1, 0.2), 1.0);
  scene.addScan(scanAt("right", 1.0, 0.3, 0.2), 1.0);
  const Sheets sheets = scene.draw(1.0);
  const Marker* left = find(sheets, "left", "sightings");
  const Marker* right = find(sheets, "right", "sightings");
  ASSERT_TRUE(left != nullptr && right != nullptr);
  ASSERT_EQ(left->points.size(), 1U);
  EXPECT_NE(left->colors[0].r, right->colors[0].r);
  const Eigen::Vector3d seen(left->points[0].x, left->points[0].y, left->points[0].z);
  EXPECT_LT(core::angleBetween(seen, core::directionOf({0.1, 0.2})), 1e-9);
}

TEST_F(Scene, SightingsVanishAfterTheirTimeAndTheirChannelIsClearedOnce) {
  scene.addScan(scanAt("left", 1.0, 0.1, 0.2), 1.0);
  EXPECT_NE(find(scene.draw(1.0), "left", "sightings"), nullptr);
  EXPECT_TRUE(isEmptied(scene.draw(1.01 + params.sighting_time), "left"));
  EXPECT_EQ(scene.draw(1.02 + params.sighting_time).count("left"), 0U);
}

TEST_F(Scene, TracksOfASilentTrackerVanish) {
  scene.addTracks("left", report(1.0, {track(1, 0.0, 0.0)}), 1.0);
  EXPECT_NE(find(scene.draw(1.0 + params.silence), "left", "tracks"), nullptr);
  EXPECT_TRUE(isEmptied(scene.draw(1.01 + params.silence), "left"));
}

TEST_F(Scene, TrackThatItsTrackerDropsVanishesAtOnce) {
  scene.addTracks("left", report(1.0, {track(1, 0.0, 0.0), track(2, 0.5, 0.0)}), 1.0);
  EXPECT_EQ(find(scene.draw(1.0), "left", "tracks")->points.size(), 2U);
  scene.addTracks("left", report(1.1, {track(2, 0.5, 0.0)}), 1.1);
  EXPECT_EQ(find(scene.draw(1.1), "left", "tracks")->points.size(), 1U);
}

TEST_F(Scene, OnlyTheMainTrackHasLabelHistoryAndPrediction) {
  for (const double time : {1.0, 1.1, 1.2}) {
    scene.addTracks("left", report(time, {track(1, time, 0.0)}), time);
    scene.addTracks(DisplayScene::kMainChannel, report(time, {track(1, time, 0.0)}), time);
  }
  const Sheets sheets = scene.draw(1.2);
  for (const char* name : {"labels", "histories", "predictions", "2-sigma ellipses"}) {
    EXPECT_NE(find(sheets, DisplayScene::kMainChannel, name), nullptr) << name;
  }
  EXPECT_EQ(find(sheets, "left", "labels"), nullptr);
  EXPECT_EQ(find(sheets, "left", "predictions"), nullptr);
  EXPECT_NE(find(sheets, "left", "2-sigma ellipses"), nullptr);
}

TEST_F(Scene, SpokesTieTheMainTrackToItsSourcesInTheirColours) {
  sightline::Track fused = track(1, 0.0, 0.0);
  fused.sources = {"left", "never_heard", "right"};
  scene.addTracks("left", report(1.0, {track(5, 0.1, 0.0), track(6, 0.9, 0.0)}), 1.0);
  scene.addScan(scanAt("right", 1.0, 0.0, 0.1), 1.0);
  scene.addTracks(DisplayScene::kMainChannel, report(1.0, {fused}), 1.0);
  const Sheets sheets = scene.draw(1.0);
  const Marker* spokes = find(sheets, DisplayScene::kMainChannel, "sources");
  ASSERT_NE(spokes, nullptr);
  ASSERT_EQ(spokes->points.size(), 4U);  // one line to the near track, one to the sighting
  const Eigen::Vector3d end(spokes->points[1].x, spokes->points[1].y, spokes->points[1].z);
  EXPECT_LT(core::angleBetween(end, core::directionOf({0.1, 0.0})), 1e-9);
}

TEST_F(Scene, SpokesOfManyTracksLeadToTheirOwnSightings) {
  sightline::Track left = track(1, -0.5, 0.0), right = track(2, 0.5, 0.0), missed = track(3, 0.0, 0.6);
  left.sources = right.sources = missed.sources = {"eye"};
  scene.addScan(scanAt("eye", 1.0, -0.52, 0.0), 1.0);
  scene.addScan(scanAt("eye", 1.1, 0.51, 0.0), 1.1);
  scene.addTracks(DisplayScene::kMainChannel, report(1.1, {left, right, missed}), 1.1);
  const Sheets sheets = scene.draw(1.1);
  const Marker* spokes = find(sheets, DisplayScene::kMainChannel, "sources");
  ASSERT_NE(spokes, nullptr);
  ASSERT_EQ(spokes->points.size(), 4U);
  for (const auto& [point, azimuth] :
       {std::pair(spokes->points[1], -0.52), std::pair(spokes->points[3], 0.51)}) {
    const Eigen::Vector3d end(point.x, point.y, point.z);
    EXPECT_LT(core::angleBetween(end, core::directionOf({azimuth, 0.0})), 1e-9);
  }
}

TEST_F(Scene, TracksOfACrowdHaveTheirNumbersOnly) {
  std::vector<sightline::Track> few, many;
  for (std::uint32_t id = 1; id <= 12; ++id) many.push_back(track(id, 0.1 * id, 0.0));
  few.assign(many.begin(), many.begin() + 2);
  scene.addTracks(DisplayScene::kMainChannel, report(1.0, few), 1.0);
  Sheets sheets = scene.draw(1.0);
  EXPECT_NE(find(sheets, DisplayScene::kMainChannel, "labels")->text.find("sigma"), std::string::npos);
  scene.addTracks(DisplayScene::kMainChannel, report(1.1, many), 1.1);
  sheets = scene.draw(1.1);
  EXPECT_EQ(find(sheets, DisplayScene::kMainChannel, "labels")->text, "1");
}

TEST_F(Scene, LabelsOfACrowdDoNotLieOverEachOtherOrInTheInset) {
  std::vector<sightline::Track> many;
  for (std::uint32_t id = 1; id <= 30; ++id)
    many.push_back(track(id, 0.02 * (id % 6), 0.02 * static_cast<double>(id / 6)));
  many.front().covariance[0] = many.front().covariance[5] = 1e-8;  // small enough for the inset
  scene.addTracks(DisplayScene::kMainChannel, report(1.0, many), 1.0);
  const Sheets sheets = scene.draw(1.0);
  std::vector<const Marker*> labels;
  for (const Marker& marker : sheets.at(DisplayScene::kMainChannel).markers)
    if (marker.ns == "labels") labels.push_back(&marker);
  EXPECT_GE(labels.size(), 8U);
  const auto anglesTo = [](const Marker& marker) {
    const auto& place = marker.pose.position;
    return core::anglesOf(Eigen::Vector3d(place.x, place.y, place.z).normalized());
  };
  for (std::size_t i = 0; i < labels.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const Eigen::Vector2d apart = (anglesTo(*labels[i]) - anglesTo(*labels[j])).cwiseAbs();
      const Eigen::Vector2d size = 0.5 * (sightline_ros::labelSize(labels[i]->text, 2.4 * core::kDegree) +
                                          sightline_ros::labelSize(labels[j]->text, 2.4 * core::kDegree));
      EXPECT_TRUE(apart.x() > 0.98 * size.x() || apart.y() > 0.98 * size.y())
          << labels[i]->text << " on " << labels[j]->text;
    }
  }
  EXPECT_NE(find(sheets, "magnifier", "magnification"), nullptr);
}

TEST_F(Scene, SpokesTieAGroupsTrackToItsSensorsToo) {
  sightline::Track grouped = track(1, 0.0, 0.0);
  grouped.sources = {"left", "right"};
  scene.addTracks("left", report(1.0, {track(5, 0.1, 0.0)}), 1.0);
  scene.addTracks("right", report(1.0, {track(5, 0.0, 0.1)}), 1.0);
  scene.addTracks("group", report(1.0, {grouped}), 1.0);
  const Sheets sheets = scene.draw(1.0);
  ASSERT_NE(find(sheets, "group", "sources"), nullptr);
  EXPECT_EQ(find(sheets, "group", "sources")->points.size(), 4U);
  EXPECT_EQ(find(sheets, "left", "sources"), nullptr);
}

TEST_F(Scene, GatesAreNamedAfterWhatHappenedInThem) {
  sightline::Track missed = track(1, 0.0, 0.0), outbid = track(2, 0.5, 0.0), seen = track(3, 1.0, 0.0);
  missed.misses = outbid.misses = 1;
  scene.addTracks("left", report(1.0, {missed, outbid, seen}), 1.0);
  sightline::AssociationArray decisions;
  decisions.associations.resize(1);
  decisions.associations[0].track = 2;
  decisions.associations[0].decision = sightline::Association::CLAIMED_BY_OTHER;
  scene.addAssociations("left", decisions);
  const Sheets sheets = scene.draw(1.0);
  EXPECT_NE(find(sheets, "left", "gates: accepted (green)"), nullptr);
  EXPECT_NE(find(sheets, "left", "gates: nothing seen (grey)"), nullptr);
  EXPECT_NE(find(sheets, "left", "gates: claimed by other (red)"), nullptr);
  EXPECT_EQ(find(sheets, "left", "gates: tentative (yellow)"), nullptr);
}

TEST_F(Scene, LabelSaysHowFarTheTruthIs) {
  scene.addTruth(report(1.0, {track(1, 0.30, 0.0), track(2, 0.01, 0.0)}), 1.0);
  scene.addTracks(DisplayScene::kMainChannel, report(1.0, {track(4, 0.0, 0.0)}), 1.0);
  const Sheets sheets = scene.draw(1.0);
  const Marker* label = find(sheets, DisplayScene::kMainChannel, "labels");
  ASSERT_NE(label, nullptr);
  EXPECT_NE(label->text.find("error 0.6 deg"), std::string::npos) << label->text;
  EXPECT_NE(find(sheets, DisplayScene::kTruthChannel, "targets"), nullptr);
}

TEST_F(Scene, ErrorsTooSmallToBeSeenAreMagnified) {
  scene.addScan(scanAt("left", 1.0, 0.00001, 0.0), 1.0);
  scene.addTracks(DisplayScene::kMainChannel, report(1.0, {track(4, 0.0, 0.0)}), 1.0);
  EXPECT_EQ(find(scene.draw(1.0), "magnifier", "rim"), nullptr);
  scene.addTracks(DisplayScene::kMainChannel, report(1.1, {track(4, 0.05, 0.0, 1e-5)}), 1.1);
  const Sheets sheets = scene.draw(1.1);
  ASSERT_NE(find(sheets, "magnifier", "rim"), nullptr);
  EXPECT_NE(find(sheets, "magnifier", "magnification"), nullptr);
  // The sighting belongs to the moment in which the track was at zero azimuth.
  ASSERT_NE(find(sheets, "magnifier", "sightings and tracks"), nullptr);
  EXPECT_EQ(find(sheets, "magnifier", "sightings and tracks")->points.size(), 1U);
}

TEST_F(Scene, MagnifiedTracksAreComparedAtACommonTime) {
  // The local tracker and the truth are ahead of the main track, and all of them move.
  const auto moving = [](double time) { return track(1, 0.5 * time, 0.0, 1e-5); };
  for (const double time : {1.0, 1.1}) {
    scene.addTracks(DisplayScene::kMainChannel, report(time, {moving(time)}), time);
  }
  for (const double time : {1.05, 1.15}) {
    scene.addTracks("left", report(time, {moving(time)}), time);
    scene.addTruth(report(time, {moving(time)}), time);
  }
  const Sheets sheets = scene.draw(1.15);
  const Marker* lines = find(sheets, "magnifier", "2-sigma ellipses and truth");
  ASSERT_NE(lines, nullptr);
  EXPECT_EQ(lines->points.size(), 2U * (48U + 48U + 2U));  // two ellipses and a cross
}

TEST_F(Scene, RecordingThatStartsAgainStartsAnEmptyScene) {
  scene.addScan(scanAt("left", 100.0, 0.1, 0.2), 100.0);
  scene.addTracks("left", report(100.0, {track(1, 0.0, 0.0)}), 100.0);
  scene.addTracks("right", report(1.0, {track(1, 0.0, 0.0)}), 1.0);
  const Sheets sheets = scene.draw(1.0);
  EXPECT_EQ(find(sheets, "left", "tracks"), nullptr);
  EXPECT_NE(find(sheets, "right", "tracks"), nullptr);
}

TEST_F(Scene, TracksThatAreNotFiniteAreLeftOut) {
  sightline::Track bad = track(1, 0.0, 0.0);
  bad.covariance[3] = std::numeric_limits<double>::quiet_NaN();
  scene.addTracks("left", report(1.0, {bad, track(2, 0.1, 0.0)}), 1.0);
  EXPECT_EQ(find(scene.draw(1.0), "left", "tracks")->points.size(), 1U);
}

TEST_F(Scene, ViewGoesToTheSightingsThenToTheMainTrackWhichTakesItAlong) {
  EXPECT_EQ(scene.view(), Eigen::Vector2d(0.0, 0.0));
  scene.addScan(scanAt("right", 1.0, 2.5, 0.3), 1.0);
  scene.draw(1.0);
  EXPECT_LT((scene.view() - Eigen::Vector2d(2.5, 0.0)).norm(), 1e-9);
  scene.addTracks(DisplayScene::kMainChannel, report(1.1, {track(1, 3.1, 0.0)}), 1.1);
  scene.draw(1.1);
  EXPECT_LT((scene.view() - Eigen::Vector2d(2.5, 0.0)).norm(), 1e-9);  // near enough
  scene.addTracks(DisplayScene::kMainChannel, report(1.2, {track(1, -2.5, 0.0)}), 1.2);
  scene.draw(1.2);
  EXPECT_NEAR(scene.view().x(), core::wrapAngle(-2.5 - 1.0), 1e-9);  // across the wrap
}

TEST_F(Scene, ViewFollowsATargetToTheZenith) {
  const double zenith = std::acos(0.0);
  scene.addTracks(DisplayScene::kMainChannel, report(1.0, {track(1, 0.4, zenith)}), 1.0);
  scene.draw(1.0);
  EXPECT_NEAR(scene.view().x(), 0.4, 1e-9);
  EXPECT_NEAR(scene.view().y(), zenith - 1.0, 1e-9);
}

TEST_F(Scene, PictureStaysBoundedWhateverComesIn) {
  for (int i = 0; i < 20000; ++i) {
    const double time = 1.0 + 1e-4 * i;
    scene.addScan(scanAt("left", time, 0.1, 0.2), time);
    scene.addScan(scanAt("sensor" + std::to_string(i), time, 0.1, 0.2), time);
    scene.addTracks(DisplayScene::kMainChannel, report(time, {track(1, 1e-5 * i, 0.0)}), time);
  }
  const Sheets sheets = scene.draw(3.0);
  EXPECT_LE(sheets.size(), 70U);
  EXPECT_LE(find(sheets, "left", "sightings")->points.size(), 500U);
  EXPECT_LE(find(sheets, DisplayScene::kMainChannel, "histories")->points.size(), 500U);
}

TEST(TrackDisplayParams, ShippedFileHoldsTheDefaults) {
  const auto reader =
      sightline_ros::ParamReader::fromYaml(sightline::test::sourceDirectory() + "/config/track_display.yaml");
  sightline_ros::loadTrackDisplayParams(reader);
  EXPECT_NO_THROW(reader.finish());
  EXPECT_EQ(reader.differences(), std::vector<std::string>());
}

TEST(TrackDisplayParams, FieldsOfViewComeFromParametersAndFromTheScenario) {
  XmlRpc::XmlRpcValue tree;
  tree["fields_of_view"][0]["sensor"] = "left";
  tree["fields_of_view"][0]["azimuth_half_width"] = 0.3;
  tree["fields_of_view"][0]["elevation_half_width"] = 0.2;
  const auto params = sightline_ros::loadTrackDisplayParams({tree, "/track_display"});
  ASSERT_EQ(params.fields_of_view.size(), 1U);
  EXPECT_EQ(params.fields_of_view[0].frame, "left");

  core::Scenario scenario;
  scenario.sensors.resize(1);
  scenario.sensors[0].name = "right";
  scenario.sensors[0].field_of_view = {0.4, 0.1};
  const auto views = sightline_ros::fieldsOfView(scenario);
  ASSERT_EQ(views.size(), 1U);
  EXPECT_EQ(views[0].frame, "right");
  EXPECT_EQ(views[0].half_width, Eigen::Vector2d(0.4, 0.1));
}

TEST(TrackDisplayParams, ChannelIsTheNamespaceOfTheTopic) {
  EXPECT_EQ(sightline_ros::channelOf("/sensors/left/tracks"), "left");
  EXPECT_EQ(sightline_ros::channelOf("/fusion/tracks"), "fusion");
  EXPECT_EQ(sightline_ros::channelOf("camera/tracks"), "camera");
  EXPECT_EQ(sightline_ros::channelOf("/tracks"), "tracks");
  EXPECT_EQ(sightline_ros::channelOf("tracks"), "tracks");
}

}  // namespace
