#include "sightline/ros/inspector/sensor_board.h"

#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "support/inspected.h"

namespace {

using namespace sightline_ros;
using sightline::test::at;

diagnostic_msgs::DiagnosticArray said(const std::vector<std::pair<std::string, std::string>>& values) {
  diagnostic_msgs::DiagnosticArray message;
  message.status.resize(1);
  message.status[0].name = "/a/local_tracker: tracker";
  for (const auto& [key, value] : values) {
    message.status[0].values.emplace_back();
    message.status[0].values.back().key = key;
    message.status[0].values.back().value = value;
  }
  return message;
}

TEST(SensorBoard, SortsWhatATrackerSaysOfEachSensor) {
  SensorBoard board;
  board.take(said({{"noise of left", "0.98 times the stated sigma (from 300 sightings)"},
                   {"guard of left", "healthy"},
                   {"latency of left", "12.0 ms (median)"},
                   {"guard of fused", "track 1: healthy"},
                   {"clock of right", "clock of right is 0.2 s behind"},
                   {"left: scans", "12"},
                   {"tracks confirmed", "3"}}),
             at(10.0));
  auto rows = board.rows(at(12.0));
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_FALSE(rows[0].is_suspect) << "the fusion's way to say it";
  rows.erase(rows.begin());
  EXPECT_EQ(rows[0].sensor, "left");
  EXPECT_EQ(rows[0].by, "/a/local_tracker");
  EXPECT_EQ(rows[0].noise, "0.98 times the stated sigma (from 300 sightings)");
  EXPECT_EQ(rows[0].verdict, "healthy");
  EXPECT_EQ(rows[0].clock, "12.0 ms (median)");
  EXPECT_FALSE(rows[0].is_suspect);
  EXPECT_NEAR(rows[0].silence, 2.0, 1e-9);
  EXPECT_TRUE(rows[1].is_suspect) << "a clock that is wrong";
}

TEST(SensorBoard, RemembersVerdictsThatChangeAndNotTheirValuesThatDo) {
  SensorBoard board;
  board.take(said({{"guard of left", "healthy"}}), at(10.0));
  board.take(said({{"guard of left", "noise has grown to 3 times, now 3.1 times"}}), at(11.0));
  board.take(said({{"guard of left", "noise has grown to 3 times, now 3.4 times"}}), at(12.0));
  board.take(said({{"guard of left", "healthy, recovered at 13.0"}}), at(13.0));
  ASSERT_EQ(board.changes().size(), 2u);
  EXPECT_EQ(board.changes()[0].time, at(11.0));
  EXPECT_EQ(board.changes()[0].sensor, "left");
  EXPECT_EQ(board.changes()[1].words, "healthy, recovered at 13.0");
}

TEST(SensorBoard, ShowsTheWorstThatTheFusionThinksOfASensor) {
  auto report = sightline::test::reportOf(5.0, 1, {});
  report->tracks.push_back(report->tracks[0]);
  report->tracks[1].id = 2;
  sightline::SensorHealth health;
  health.sensor = "left";
  health.verdict = "healthy";
  health.noise_scale = 1.0;
  health.clock_behind = std::numeric_limits<double>::quiet_NaN();
  report->tracks[0].sensors = {health};
  health.verdict = "noisy";
  health.noise_scale = 4.0;
  health.bias = {0.5, -0.25};
  health.reason = "noise has grown";
  report->tracks[1].sensors = {health};
  report->tracks[1].sensor_changes = {health};
  SensorBoard board;
  board.take("/fusion/report", *report, at(5.0));
  const auto rows = board.rows(at(5.0));
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_EQ(rows[0].verdict, "track 2: noise has grown");
  EXPECT_EQ(rows[0].noise, "2 times the stated sigma");
  EXPECT_EQ(rows[0].bias, "(0.5, -0.25) sigma");
  EXPECT_EQ(rows[0].clock, "");
  ASSERT_EQ(board.changes().size(), 1u);
  EXPECT_EQ(board.changes()[0].words, "track 2: noise has grown");
}

TEST(SensorBoard, CountsRejectedSightingsWithTheReason) {
  auto rejected = sightline::test::decisionOn(0, sightline::Association::REJECTED_INPUT, 0.0, 0.0);
  rejected.reason = "covariance is zero";
  SensorBoard board;
  for (int scan = 0; scan < 2; ++scan)
    board.take("/a/associations", sightline::test::decisionsOf("left", 1.0, {rejected, rejected}), at(1.0));
  EXPECT_EQ(board.rows(at(1.0)).at(0).detection,
            "4 sightings rejected, the last one because covariance is zero");
}

TEST(SensorBoard, IsBoundedWhateverNamesCome) {
  SensorBoard board;
  for (int i = 0; i < 2000; ++i) {
    board.take(said({{"guard of sensor " + std::to_string(i), "off by (9, 0) sigma"}}), at(i));
  }
  EXPECT_EQ(board.rows(at(2000.0)).size(), SensorBoard::kMostRows);
  EXPECT_EQ(board.changes().size(), SensorBoard::kMostChanges);
}

}  // namespace
