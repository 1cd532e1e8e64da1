#include "sightline/ros/recordings/recording_examination.h"

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <sightline/PositionReport.h>
#include <tf2_msgs/TFMessage.h>

#include "sightline/ros/recordings/bags.h"
#include "sightline/ros/recordings/replay.h"

#include "support/position_reports.h"
#include "support/scans.h"
#include "support/scratch_folder.h"

using namespace sightline_ros;

namespace {

constexpr double kExaminedStart = 1000.0;  // [s]

class RecordingExaminationTest : public testing::Test {
 protected:
  struct Recorded {
    sightline::SightingArray scan;
    double received = 0.0;
  };

  /// Ten seconds of a sensor that sees the target.
  void look(const std::string& sensor, double latency = 0.01, double azimuth_offset = 0.0) {
    SeenTarget target(static_cast<unsigned>(sensor.back()));
    for (int k = 0; k < 300; ++k) {
      const double time = kExaminedStart + 0.033 * k;
      auto angles = target.at(time);
      angles.first += azimuth_offset;
      scans_.push_back({scanOf(sensor, time, {angles}), time + latency});
    }
  }

  std::string file() const {
    rosbag::Bag bag(folder_.file("in.bag"), rosbag::bagmode::Write);
    for (const Recorded& each : scans_)
      bag.write("/sensors/" + each.scan.sensor + "/sightings", ros::Time(each.received), each.scan);
    for (const auto& report : reports_) bag.write("/positions/report", report.header.stamp, report);
    for (const auto& message : transforms_) bag.write("/tf", message.transforms[0].header.stamp, message);
    return folder_.file("in.bag");
  }

  RecordingExamination examine(const RecordingExaminationParams& params = {}) const {
    return examineRecording(*openBag(file()), params);
  }

  std::string said(const RecordingExaminationParams& params = {}) const {
    return linesOf(examine(params).findings);
  }

  ScratchFolder folder_;
  std::vector<Recorded> scans_;
  std::vector<tf2_msgs::TFMessage> transforms_;
  std::vector<sightline::PositionReport> reports_;
};

TEST_F(RecordingExaminationTest, FindsNothingWrongWithGoodSensors) {
  look("a");
  look("b");
  const RecordingExamination examined = examine();
  EXPECT_EQ(linesOf(examined.findings), "");
  EXPECT_EQ(examined.inputs.sensors().size(), 2u);
  EXPECT_NEAR(examined.seconds, 299 * 0.033, 1e-3);
  EXPECT_EQ(examined.tracking_frame, "platform_enu");
}

TEST_F(RecordingExaminationTest, LatencyIsExaminedOnlyWhereItMatters) {
  look("a");
  look("late", 2.5);
  EXPECT_NE(said().find("WRONG  late on /sensors/late/sightings: its stamps are 2.5 s behind the clock"),
            std::string::npos)
      << said();
  RecordingExaminationParams offline;
  offline.with_latency = false;
  EXPECT_EQ(said(offline), "");
}

TEST_F(RecordingExaminationTest, TransformsAreThoseOfTheStampsHoweverLongTheRecording) {
  look("a");
  for (auto& each : scans_) each.scan.header.frame_id = "mast";
  // Minutes of transforms after the scans, more than a buffer holds.
  for (int k = -1; k < 300; ++k) {
    tf2_msgs::TFMessage message;
    message.transforms.resize(1);
    message.transforms[0].header.stamp = ros::Time(kExaminedStart + k);
    message.transforms[0].header.frame_id = "platform_enu";
    message.transforms[0].child_frame_id = "mast";
    message.transforms[0].transform.rotation.w = 1.0;
    transforms_.push_back(message);
  }
  EXPECT_EQ(said(), "");
  transforms_.clear();
  EXPECT_NE(said().find("its frame \"mast\" has no transform to the tracking frame \"platform_enu\""),
            std::string::npos)
      << said();
}

TEST_F(RecordingExaminationTest, CamerasBackToBackAreANoteAtMost) {
  look("front");
  look("rear", 0.01, 3.1);
  const RecordingExamination examined = examine();
  EXPECT_FALSE(examined.findings.empty());
  for (const Finding& finding : examined.findings) EXPECT_TRUE(finding.is_note) << finding.words;
}

TEST_F(RecordingExaminationTest, ARecordingWithoutScansIsWrong) {
  EXPECT_NE(said().find("WRONG  sightings: nobody publishes sightline/SightingArray"), std::string::npos)
      << said();
}

TEST_F(RecordingExaminationTest, ReportsOfPositionsAreReadUnlessTheyAreNotAskedFor) {
  look("west");
  look("east");
  for (int k = 0; k < 30; ++k) {
    reports_.push_back(positionReport({"west", "east", "north"}));
    sightline::PositionReport& report = reports_.back();
    report.header.stamp = ros::Time(kExaminedStart + 0.1 * k);
    report.positions.resize(1);
    report.unlocated = {unlocatedTrack("west/4", "one station only")};
    report.stations[1].clock_behind = 0.001 * k;  // the last report counts
    report.stations[1].corrected = true;
  }
  const std::string words = said();
  EXPECT_NE(words.find("WRONG  east in /positions/report: its clock is 0.029 s behind those of the stations "
                       "that are right (standard deviation 0.002 s)"),
            std::string::npos)
      << words;
  EXPECT_NE(words.find("note   north in /positions/report: its clock is 0.003 s ahead"), std::string::npos)
      << words;
  EXPECT_NE(words.find("west/4 for 2.9 s had no position"), std::string::npos) << words;
  RecordingExaminationParams inputs_alone;
  inputs_alone.with_positions = false;
  EXPECT_EQ(said(inputs_alone), "");
}

/// A recording of one sensor, as `replay` and `evaluate` see it.
std::string saidOfReplay(const std::vector<sightline::SightingArray>& scans) {
  const ScratchFolder folder;
  {
    rosbag::Bag bag(folder.file("in.bag"), rosbag::bagmode::Write);
    for (const auto& scan : scans) bag.write("/sensors/cam/sightings", scan.header.stamp, scan);
  }
  const ReplaySummary summary = replay(folder.file("in.bag"), folder.file("out.bag"), {});
  return linesOf(summary.findings);
}

TEST(InputsOfAReplay, AVarianceGivenForTheSigmaIsSaid) {
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0.0, 1e-3);
  std::vector<sightline::SightingArray> scans;
  for (int i = 0; i < 60; ++i) {
    const std::pair<double, double> angles{0.1 + 0.002 * i + noise(random), 0.3 + noise(random)};
    scans.push_back(scanOf("cam", kExaminedStart + 0.1 * i, {angles}, 1e-6));
  }
  const std::string said = saidOfReplay(scans);
  EXPECT_NE(
      said.find(
          "WRONG  cam on /sensors/cam/sightings: its covariance is too small: it states a sigma of 1e-06 "
          "rad"),
      std::string::npos)
      << said;
  EXPECT_NE(said.find("a variance given for the sigma?"), std::string::npos) << said;
}

TEST(InputsOfAReplay, StampsThatScansShareAreSaid) {
  std::vector<sightline::SightingArray> scans;
  for (int i = 0; i < 500; ++i)
    scans.push_back(scanOf("cam", kExaminedStart + i / 50, {{0.1 + 0.0004 * i, 0.3}}));
  const std::string said = saidOfReplay(scans);
  EXPECT_NE(said.find("490 of 500 scans repeat the stamp of the one before (50 scans share each stamp)"),
            std::string::npos)
      << said;
}

}  // namespace
