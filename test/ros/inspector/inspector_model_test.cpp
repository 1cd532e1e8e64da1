#include "sightline/ros/inspector/inspector_model.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "support/inspected.h"

namespace {

using namespace sightline_ros;
using sightline::Association;
using sightline::test::at;
using sightline::test::decisionOn;
using sightline::test::decisionsOf;
using sightline::test::positionTrack;
using sightline::test::reportOf;
using sightline::test::sourceOf;
using sightline::test::stamped;
using sightline::test::tracksOf;

const TrackKey kGlobal{"/fusion/tracks", 10};
const TrackKey kLocal{"/groups/left/tracks", 1};

/// Two local trackers and a fusion: global track 10 of left/1 and right/2; left/3 is left out.
void feedPlatform(InspectorModel& model, double time) {
  model.take(kLocal.topic, tracksOf("left", time, {1, 3}), at(time));
  model.take("/groups/right/tracks", tracksOf("right", time, {2}), at(time));
  model.take(kGlobal.topic, tracksOf("fusion", time, {10}, 5e-4), at(time));
  auto report = reportOf(time, 10, {sourceOf("left", 1, 0.75), sourceOf("right", 2, 0.25)});
  report->tracks[0].left_out = {sourceOf("left", 3, 0.0, "shared sensor: eye")};
  model.take("/fusion/report", report, at(time));
}

std::vector<TrackKey> keysOf(const InspectorModel& model) {
  std::vector<TrackKey> keys;
  for (const TrackRow& row : model.rows()) keys.push_back(row.key);
  return keys;
}

TEST(InspectorModel, ListsGlobalTracksThenPositionsThenLocalOnes) {
  InspectorModel model;
  auto positions = boost::make_shared<sightline::PositionTrackArray>(
      stamped<sightline::PositionTrackArray>(ros::Time(100.0), "world"));
  positions->tracks.push_back(positionTrack(5, {1.0, 2.0, 3.0}, {0.0, 0.0, 0.0}));
  model.take("/positions/tracks", positions, at(100.0));
  feedPlatform(model, 100.0);
  const auto rows = model.rows();
  ASSERT_EQ(rows.size(), 5u);
  EXPECT_EQ(rows[0].key, kGlobal);
  EXPECT_EQ(rows[0].kind, TrackKind::global);
  EXPECT_EQ(rows[1].kind, TrackKind::position);
  EXPECT_EQ(rows[2].key, kLocal);
  EXPECT_EQ(rows[2].kind, TrackKind::local);
}

TEST(InspectorModel, AgeIsFromTheFirstMessageWithTheTrack) {
  InspectorModel model;
  model.take(kLocal.topic, tracksOf("left", 100.0, {1}), at(100.0));
  model.take(kLocal.topic, tracksOf("left", 103.0, {1, 2}), at(103.0));
  const auto rows = model.rows();
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_NEAR(rows[0].age, 3.0, 1e-6);
  EXPECT_NEAR(rows[1].age, 0.0, 1e-6);
}

TEST(InspectorModel, OfALocalTrackItKnowsItsOwnSightings) {
  InspectorModel model;
  model.select(kLocal);
  feedPlatform(model, 100.0);
  model.take("/groups/left/associations",
             decisionsOf("eye", 99.5,
                         {decisionOn(1, Association::ACCEPTED, 1.0, -1.0),
                          decisionOn(3, Association::ACCEPTED, 2.0, 0.0)}),
             at(100.0));
  model.take("/groups/right/associations",
             decisionsOf("ear", 99.5, {decisionOn(1, Association::ACCEPTED, 0.0, 0.0)}), at(100.0));
  const auto detail = model.detail();
  ASSERT_TRUE(detail);
  ASSERT_EQ(detail->sightings.size(), 1u);
  EXPECT_NEAR(detail->sightings[0].age, 0.5, 1e-3);
  EXPECT_NEAR(detail->sightings[0].x, 1e-3, 1e-9);
  EXPECT_NEAR(detail->sightings[0].squared, 2.0, 1e-6);
  EXPECT_EQ(detail->sensors[detail->sightings[0].sensor], "eye");
  ASSERT_EQ(detail->gates.size(), 1u);
  EXPECT_NEAR(detail->gates[0].threshold, 9.0, 1e-6);
}

TEST(InspectorModel, OfAGlobalTrackItKnowsTheSightingsOfItsSupporters) {
  InspectorModel model;
  feedPlatform(model, 100.0);
  model.take("/groups/left/associations",
             decisionsOf("eye", 100.0, {decisionOn(1, Association::ACCEPTED, 1.0, 0.0)}), at(100.0));
  model.take("/groups/left/associations",
             decisionsOf("eye", 100.0, {decisionOn(3, Association::ACCEPTED, 2.0, 0.0)}), at(100.0));
  model.select(kGlobal);
  model.take("/groups/right/associations",
             decisionsOf("ear", 100.0, {decisionOn(2, Association::OUTSIDE_GATE, 4.0, 0.0)}), at(100.1));
  const auto lines = model.sightings(10);
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_EQ(lines[0].tracker, "right/2");
  EXPECT_EQ(lines[0].decision, "refused");
  EXPECT_EQ(lines[0].reason, "distance squared 16 is beyond the gate's 9");
  EXPECT_EQ(lines[1].tracker, "left/1");
  EXPECT_TRUE(lines[1].is_taken);
  EXPECT_EQ(model.sightings(1).size(), 1u);
}

TEST(InspectorModel, SaysWhoSupportsATrackWithWhatWeight) {
  InspectorModel model;
  feedPlatform(model, 100.0);
  model.select(kGlobal);
  const auto support = model.support();
  ASSERT_EQ(support.size(), 3u);
  EXPECT_EQ(support[0].tracker, "left");
  EXPECT_NEAR(support[0].weight, 0.75, 1e-12);
  EXPECT_EQ(support[0].words, "by the rule tracklets");
  EXPECT_EQ(support[2].words, "left out: shared sensor: eye");
}

TEST(InspectorModel, SaysWhatALocalTrackSupports) {
  InspectorModel model;
  feedPlatform(model, 100.0);
  model.select(kLocal);
  const auto support = model.support();
  ASSERT_EQ(support.size(), 3u) << "two sensors and a global track";
  EXPECT_EQ(support[0].tracker, "left");  // a sensor of that name
  EXPECT_EQ(support[2].words, "it supports fusion/10");
  EXPECT_NEAR(support[2].weight, 0.75, 1e-12);
  model.select(TrackKey{kLocal.topic, 3});
  EXPECT_EQ(model.support().at(2).words, "left out of fusion/10: shared sensor: eye");
}

TEST(InspectorModel, OfAPositionItKnowsTheSightingsOfItsLocalTracks) {
  InspectorModel model;
  model.take("/sensors/camera_1/tracks", tracksOf("/sensors/camera_1", 100.0, {4}), at(100.0));
  auto positions = boost::make_shared<sightline::PositionTrackArray>(
      stamped<sightline::PositionTrackArray>(ros::Time(100.0), "world"));
  positions->tracks.push_back(positionTrack(5, {1.0, 2.0, 3.0}, {0.0, 0.0, 0.0}));
  positions->tracks[0].sources = {"/sensors/camera_1/4", "no number/x"};
  model.take("/positions/tracks", positions, at(100.0));
  model.select(TrackKey{"/positions/tracks", 5});
  model.take("/sensors/camera_1/associations",
             decisionsOf("camera_1", 100.0, {decisionOn(4, Association::ACCEPTED, 1.0, 0.0)}), at(100.0));
  EXPECT_EQ(model.detail()->sightings.size(), 1u);
  ASSERT_EQ(model.support().size(), 1u);
  EXPECT_EQ(model.support()[0].tracker, "/sensors/camera_1");
  EXPECT_EQ(model.support()[0].id, 4u);
}

TEST(InspectorModel, MeanOfNormalisedInnovationsHasItsBand) {
  InspectorModel model;
  model.select(kLocal);
  feedPlatform(model, 100.0);
  for (int i = 0; i < 400; ++i) {
    model.take("/groups/left/associations",
               decisionsOf("eye", 100.0, {decisionOn(1, Association::ACCEPTED, i % 2 == 0 ? 1.0 : 0.0, 1.0)}),
               at(100.0));
  }
  const auto nis = model.detail()->nis;
  EXPECT_EQ(nis.count, 400u);
  EXPECT_NEAR(nis.mean, 1.5, 1e-6);
  EXPECT_NEAR(nis.low, 2.0 - 1.96 * 2.0 / 20.0, 0.01) << "2 -+ 1.96 sigma of a mean of 400 of variance 4";
  EXPECT_NEAR(nis.high, 2.0 + 1.96 * 2.0 / 20.0, 0.01);
}

TEST(InspectorModel, KeepsWhereEveryTrackStoodFiveTimesASecondForAMinute) {
  InspectorModel model;
  for (int i = 0; i <= 3000; ++i)
    model.take(kLocal.topic, tracksOf("left", 100.0 + 0.04 * i, {1}, 2e-3), at(100.0 + 0.04 * i));
  model.select(kLocal);
  const auto spread = model.detail()->spread;
  EXPECT_GE(spread.size(), 299u);
  EXPECT_LE(spread.size(), 302u);
  EXPECT_NEAR(spread.front().age, 60.0, 0.3);
  EXPECT_LE(spread.back().age, 0.2F);
  EXPECT_NEAR(spread.back().sigma, 2e-3, 1e-8);
  EXPECT_NEAR(spread.back().gate, 8e-3, 1e-8);
}

TEST(InspectorModel, FrozenItTakesNothingInAndAllCanBeLookedAt) {
  InspectorModel model;
  feedPlatform(model, 100.0);
  model.take("/groups/left/associations",
             decisionsOf("eye", 100.0, {decisionOn(3, Association::ACCEPTED, 1.0, 0.0)}), at(100.0));
  model.freeze(true);
  feedPlatform(model, 160.0);
  model.tick(at(300.0));
  EXPECT_EQ(model.now(), at(100.0));
  model.select(TrackKey{kLocal.topic, 3});
  EXPECT_EQ(model.detail()->sightings.size(), 1u);
  EXPECT_EQ(model.rows().size(), 4u);
  model.freeze(false);
  feedPlatform(model, 300.0);
  EXPECT_EQ(model.now(), at(300.0));
}

TEST(InspectorModel, WhenTimeGoesBackAllIsForgottenButTheChoice) {
  InspectorModel model;
  feedPlatform(model, 100.0);
  model.select(kGlobal);
  model.take("/groups/left/associations",
             decisionsOf("eye", 100.0, {decisionOn(1, Association::ACCEPTED, 1.0, 0.0)}), at(100.0));
  model.tick(at(50.0));
  EXPECT_TRUE(model.rows().empty());
  ASSERT_TRUE(model.detail());
  EXPECT_FALSE(model.detail()->row);
  EXPECT_TRUE(model.detail()->sightings.empty());
  feedPlatform(model, 50.1);
  model.take("/groups/left/associations",
             decisionsOf("eye", 50.1, {decisionOn(1, Association::ACCEPTED, 1.0, 0.0)}), at(50.1));
  ASSERT_TRUE(model.detail()->row);
  EXPECT_EQ(model.detail()->sightings.size(), 1u);
  EXPECT_NEAR(model.detail()->row->age, 0.0, 1e-6);
}

TEST(InspectorModel, AClockThatTremblesForgetsNothing) {
  InspectorModel model;
  feedPlatform(model, 100.0);
  model.tick(at(99.5));
  EXPECT_EQ(model.rows().size(), 4u);
}

TEST(InspectorModel, ASilentTrackerIsSaidAndItsTracksGoLater) {
  InspectorModel model;
  feedPlatform(model, 100.0);
  model.select(kGlobal);
  model.tick(at(103.0));
  EXPECT_EQ(stateText(model.rows().at(0)), "silent 3.0 s");
  model.tick(at(111.0));
  EXPECT_TRUE(model.rows().empty());
  EXPECT_EQ(model.selected(), kGlobal);
  feedPlatform(model, 112.0);  // the node is back
  EXPECT_EQ(keysOf(model).front(), kGlobal);
  EXPECT_TRUE(model.detail()->row);
}

TEST(InspectorModel, MoreTopicsThanThereIsRoomForAreSaid) {
  InspectorModel model;
  EXPECT_EQ(model.notice(), "");
  for (std::size_t i = 0; i <= InspectorModel::kMostTopics; ++i)
    model.take("/t" + std::to_string(i) + "/tracks", tracksOf("t", 100.0, {1}), at(100.0));
  EXPECT_EQ(model.rows().size(), InspectorModel::kMostTopics);
  EXPECT_NE(model.notice(), "");
}

TEST(InspectorModel, NumbersThatAreNoneDoNoHarm) {
  InspectorModel model;
  const double nan = std::nan("");
  auto tracks = tracksOf("left", 100.0, {1}, nan);
  tracks->tracks[0].azimuth = nan;
  model.select(kLocal);
  model.take(kLocal.topic, tracks, at(100.0));
  model.take("/groups/left/associations",
             decisionsOf("eye", 100.0, {decisionOn(1, Association::ACCEPTED, nan, nan)}), at(100.0));
  EXPECT_TRUE(model.detail()->sightings.empty());
  EXPECT_EQ(model.rows().size(), 1u);
}

}  // namespace
