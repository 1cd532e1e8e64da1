// What the doctor says of stations and positions, judged without a node: reports in, words out.
#include "sightline/ros/diagnosis/position_examination.h"

#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "support/position_reports.h"

namespace {

using sightline::PositionReport;
using sightline::StationError;
using sightline_ros::Finding;
using sightline_ros::GraphView;
using sightline_ros::PositionExamination;

const char* const kReportTopic = "/positions/report";

class PositionsExamined : public testing::Test {
 protected:
  /// Reports every tenth of a second, up to `seconds` and with both ends.
  void report(double seconds, const PositionReport& like) {
    for (int k = 0; 0.1 * k <= seconds + 1e-9; ++k) {
      PositionReport message = like;
      message.header.stamp = ros::Time(next_);
      next_ += 0.1;
      examination_.take(message, kReportTopic);
    }
  }

  std::vector<Finding> findings() const { return examination_.findings(); }

  /// Everything that is said, a line for each finding.
  std::string said() const {
    std::string lines;
    for (const Finding& finding : findings())
      lines += (finding.is_note ? "note " : "WRONG ") + finding.subject + ": " + finding.words + "\n";
    return lines;
  }

  bool says(const std::string& words) const { return said().find(words) != std::string::npos; }

  double next_ = 1000.0;  // [s]
  PositionExamination examination_;
};

TEST_F(PositionsExamined, NothingIsSaidWithoutReports) {
  EXPECT_EQ(said(), "");
}

TEST_F(PositionsExamined, ALateStationThatIsPutRightIsWrongWithItsStandardDeviation) {
  PositionReport message = positionReport({"west", "east", "north"});
  message.stations[1].clock_behind = 0.0502;
  message.stations[1].clock_sigma = 0.0013;
  message.stations[1].corrected = true;
  report(1.0, message);
  ASSERT_EQ(findings().size(), 3u) << said();
  EXPECT_TRUE(
      says("WRONG east in /positions/report: its clock is 0.0502 s behind those of the stations that are "
           "right (standard deviation 0.0013 s)"))
      << said();
  EXPECT_TRUE(says("put right by that; synchronise its clock\n")) << said();
  EXPECT_TRUE(
      says("note west in /positions/report: its clock is 0.003 s ahead of the others' (standard "
           "deviation 0.002 s); what it sees is turned by 0.1 mrad about x, -0.2 mrad about y, 0.3 mrad "
           "about z of \"world\" (standard deviations 0.4 mrad, 0.5 mrad, 0.6 mrad)\n"))
      << said();
}

TEST_F(PositionsExamined, TheRemedyIsOfWhatIsOff) {
  PositionReport message = positionReport({"west", "east", "north"});
  StationError& east = message.stations[1];
  east.corrected = true;
  east.rotation[2] = 5e-3;
  east.rotation_sigma[2] = 2e-4;
  report(1.0, message);
  EXPECT_TRUE(says("put right by that; correct the rotation of its tf\n")) << said();
  east.clock_behind = 0.05;
  report(1.0, message);
  EXPECT_TRUE(says("put right by that; synchronise its clock, and correct the rotation of its tf\n"))
      << said();
}

TEST_F(PositionsExamined, WhatTargetsDoNotTellIsSaid) {
  PositionReport message = positionReport({"west", "east", "north"});
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  StationError& west = message.stations[0];
  west.clock_behind = west.clock_sigma = kNaN;
  west.rotation.fill(kNaN);
  west.rotation_sigma.fill(kNaN);
  message.stations[1].rotation_sigma[1] = 4.9e-3;  // that before anything is known is 5 mrad
  message.stations[2].clock_sigma = 0.19;          // ... and 0.2 s
  report(1.0, message);
  ASSERT_EQ(findings().size(), 3u) << said();
  for (const Finding& finding : findings()) EXPECT_TRUE(finding.is_note) << finding.words;
  EXPECT_TRUE(
      says("note west in /positions/report: the targets do not tell its clock and its rotation about x, y, "
           "z: it must see targets that other stations see"))
      << said();
  EXPECT_TRUE(
      says("0.1 mrad about x, 0.3 mrad about z of \"world\" (standard deviations 0.4 mrad, 0.6 mrad); the "
           "targets do not tell its rotation about y:"))
      << said();
  EXPECT_TRUE(says("note north in /positions/report: what it sees is turned by")) << said();
  EXPECT_TRUE(says("the targets do not tell its clock:")) << said();
}

TEST_F(PositionsExamined, StationsOfWhichOneIsOffAreWrongTogether) {
  PositionReport message = positionReport({"west", "east"});
  for (StationError& station : message.stations) station.undecided = true;
  report(1.0, message);
  EXPECT_TRUE(
      says("WRONG /positions/report: the clock or the orientation of one of these stations is off, and the "
           "targets do not tell whose: east, west;"))
      << said();
}

TEST_F(PositionsExamined, AStationWithLargeSlowErrorsHarms) {
  PositionReport message = positionReport({"west", "east"});
  report(1.0, message);
  EXPECT_FALSE(says("errors that stay for a while")) << said();
  message.stations[1].sensor = "camera";
  message.stations[1].slow_scale = 7.2;
  report(1.0, message);
  EXPECT_TRUE(
      says("note east/camera in /positions/report: its directions have errors that stay for a while, of 7.2 "
           "times the sigma that it states (time constant 3 s)"))
      << said();
}

TEST_F(PositionsExamined, SensorsOfOneTrackerHaveOneClock) {
  PositionReport message = positionReport({"west", "east"});
  message.stations.push_back(message.stations[0]);
  message.stations.back().sensor = "second";
  report(1.0, message);
  EXPECT_EQ(findings().size(), 2u) << said();
}

TEST_F(PositionsExamined, LocalTracksWithoutAPositionAreSaidWithTheReason) {
  PositionReport message;
  message.complete = true;
  message.positions.resize(1);
  message.unlocated = {unlocatedTrack("west/4", "one station only"),
                       unlocatedTrack("east/2", "parallax too small")};
  report(2.5, message);
  ASSERT_EQ(findings().size(), 2u) << said();
  EXPECT_TRUE(
      says("note west in /positions/report: its west/4 for 2.5 s had no position (one station only: why)"))
      << said();
  EXPECT_TRUE(
      says("note east in /positions/report: its east/2 for 2.5 s had no position (parallax too small: why); "
           "stations farther apart"))
      << said();
}

TEST_F(PositionsExamined, OnlyTheTimeWithoutAPositionCounts) {
  PositionReport without;
  without.complete = true;
  without.positions.resize(1);
  PositionReport with = without;
  without.unlocated = {unlocatedTrack("west/4", "one station only")};
  report(0.7, without);  // tracks start without one
  report(5.0, with);
  EXPECT_EQ(said(), "");
  report(0.7, without);
  EXPECT_TRUE(says("west/4 for 1.4 s")) << said();
}

TEST_F(PositionsExamined, NoPositionAtAllIsSaid) {
  PositionReport message;
  message.complete = true;
  message.unlocated = {unlocatedTrack("west/4", "one station only")};
  report(1.5, message);
  EXPECT_FALSE(says("no position in any")) << said();  // one station cannot
  message.unlocated.push_back(unlocatedTrack("east/1", "one station only"));
  report(1.5, message);
  EXPECT_TRUE(says("note /positions/report: no position in any of 32 reports, though east, west have tracks"))
      << said();
}

TEST_F(PositionsExamined, CrossingsThatAreTooManyAreWrong) {
  PositionReport message;
  message.complete = true;
  report(0.5, message);
  message.complete = false;
  report(0.3, message);
  EXPECT_TRUE(
      says("WRONG /positions/report: 4 of 10 reports say that there are more crossings than can be scored"))
      << said();
}

TEST_F(PositionsExamined, ASilentTrackerIsSaidAndOneThatSpeaksIsNot) {
  GraphView graph;
  graph.topics = {{kReportTopic, "sightline/PositionReport", {"/position_tracker"}, {}},
                  {"/other", "sightline/PositionTrackArray", {"/position_tracker"}, {}}};
  const auto silent = examination_.silentTopics(graph, 4.0);
  ASSERT_EQ(silent.size(), 1u);
  EXPECT_EQ(silent[0].subject, kReportTopic);
  EXPECT_NE(silent[0].words.find("no report of positions came within 4 s"), std::string::npos)
      << silent[0].words;
  report(0.1, PositionReport{});
  EXPECT_TRUE(examination_.silentTopics(graph, 4.0).empty());
}

}  // namespace
