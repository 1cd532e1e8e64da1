#include "sightline/ros/inspector/sighting_log.h"

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

SightingRecord onlyRecord(const SightingLog& log) {
  EXPECT_EQ(log.followed().size(), 1u);
  return *log.followed().begin();
}

/// What is said of the last of the decisions of one scan.
std::string reasonFor(const std::vector<Association>& rows) {
  SightingLog log;
  log.follow({{"/a", rows.back().track}});
  log.take("/a/associations", decisionsOf("left", 1.0, rows), at(1.0));
  return reasonOf(*log.followed().rbegin());
}

TEST(SightingLog, SaysWhyASightingWasTakenOrRefused) {
  EXPECT_EQ(reasonFor({decisionOn(1, Association::ACCEPTED, 1.0, 2.0)}), "distance squared 5 of at most 9");
  EXPECT_EQ(reasonFor({decisionOn(1, Association::OUTSIDE_GATE, 4.0, 0.0)}),
            "distance squared 16 is beyond the gate's 9");
  EXPECT_EQ(reasonFor({decisionOn(1, Association::STARTED_TRACK, 0.0, 0.0)}),
            "in no gate: the track was initiated from it");
}

TEST(SightingLog, SaysWhetherTheTrackTookAnotherSightingOrTheSightingAnotherTrack) {
  EXPECT_EQ(reasonFor({decisionOn(1, Association::ACCEPTED, 1.0, 0.0),
                       decisionOn(1, Association::CLAIMED_BY_OTHER, 2.0, 0.0)}),
            "in the gate (4), but the track took another sighting of the scan (1)");
  EXPECT_EQ(reasonFor({decisionOn(2, Association::ACCEPTED, 1.0, 0.0),
                       decisionOn(1, Association::CLAIMED_BY_OTHER, 2.0, 0.0)}),
            "in the gate (4), but given to a more likely track");
}

TEST(SightingLog, KnowsOfATrackWhatCameBeforeItWasFollowed) {
  SightingLog log;
  log.take("/a/associations", decisionsOf("left", 1.0, {decisionOn(1, Association::ACCEPTED, 1.0, 0.0)}),
           at(1.0));
  log.take("/b/associations", decisionsOf("left", 1.0, {decisionOn(1, Association::ACCEPTED, 2.0, 0.0)}),
           at(1.0));
  log.follow({{"/b", 1}});
  EXPECT_NEAR(onlyRecord(log).innovation[0], 2e-3, 1e-9) << "of the other tracker's track of that number";
  log.follow({{"/a", 1}, {"/b", 1}});
  EXPECT_EQ(log.followed().size(), 2u);
  log.follow({{"/a", 1}});
  EXPECT_NEAR(onlyRecord(log).innovation[0], 1e-3, 1e-9);
}

TEST(SightingLog, IsBoundedInNumberAndOthersDoNotCrowdOutTheFollowed) {
  SightingLog log;
  log.follow({{"/a", 1}});
  log.take("/a/associations", decisionsOf("left", 1.0, {decisionOn(1, Association::ACCEPTED, 1.0, 0.0)}),
           at(1.0));
  const std::vector<Association> many(1000, decisionOn(2, Association::ACCEPTED, 1.0, 0.0));
  for (std::size_t i = 0; i < SightingLog::kMost / 1000 + 5; ++i)
    log.take("/a/associations", decisionsOf("left", 2.0, many), at(2.0));
  EXPECT_EQ(log.size(), SightingLog::kMost);
  EXPECT_NEAR(onlyRecord(log).innovation[0], 1e-3, 1e-9);
}

TEST(SightingLog, NamesWithoutNumberShareTheLastOne) {
  NameTable names(3);
  EXPECT_EQ(names.indexOf("a"), 0u);
  EXPECT_EQ(names.indexOf("b"), 1u);
  for (int i = 0; i < 1000; ++i) EXPECT_EQ(names.indexOf("name " + std::to_string(i)), 2u);
  EXPECT_EQ(names.indexOf("a"), 0u);
  EXPECT_EQ(names.names().size(), 3u);
}

}  // namespace
