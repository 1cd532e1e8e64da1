// Truth in positions, and what evaluate says of a recording with it.
#include "sightline/ros/recordings/recorded_positions.h"

#include <string>

#include <gtest/gtest.h>

#include <sensor_msgs/NavSatFix.h>
#include <sightline/PositionTrackArray.h>

#include "sightline/report/csv_table.h"
#include "sightline/ros/recordings/bag_evaluation.h"

#include "support/scratch_folder.h"
#include "support/times.h"

namespace {

namespace core = sightline::core;
using sightline::test::at;
using sightline_ros::BagEvaluationSettings;
using sightline_ros::evaluateBag;
using sightline_ros::positionTruthFromCsv;

const char* const kTruth = "time,east_m,north_m,up_m\n10.0,0,0,5\n10.2,2,0,5\n10.4,4,0,5\n10.6,6,0,5\n";

/// Positions half a metre above a target that flies along kTruth, from 10 s + `shift`.
void record(const std::string& file, double shift = 0.0, bool with_world = false) {
  rosbag::Bag bag(file, rosbag::bagmode::Write);
  for (int i = 0; i <= 6; ++i) {
    sightline::PositionTrackArray array;
    array.header.stamp = ros::Time(10.0 + 0.1 * i + shift);
    array.header.frame_id = "world";
    array.tracker = "positions";
    array.tracks.resize(1);
    sightline::PositionTrack& track = array.tracks[0];
    track.id = 3;
    track.status = sightline::PositionTrack::CONFIRMED;
    track.position.x = 1.0 * i;
    track.position.z = 5.5;
    track.velocity.x = 10.0;
    for (int k = 0; k < 6; ++k) track.covariance[7 * static_cast<std::size_t>(k)] = 0.25;
    track.parallax = 0.5;
    bag.write("/positions/tracks", array.header.stamp, array);
  }
  if (!with_world) return;
  sensor_msgs::NavSatFix fix;
  fix.latitude = 50.0;
  fix.longitude = 10.0;
  fix.altitude = 100.0;
  bag.write("/world_origin", ros::Time(10.0), fix);
}

TEST(RecordedPositions, CsvInMetresOrDegreesBecomesPathsInTheWorld) {
  const ScratchFolder folder;
  record(folder.file("a.bag"), 0.0, true);
  const rosbag::Bag bag(folder.file("a.bag"));
  const auto metres = positionTruthFromCsv(folder.write("m.csv", kTruth), bag, 2.0);
  ASSERT_EQ(metres.size(), 1u);
  EXPECT_LT((metres.at("1").at(at(10.2))->position - Eigen::Vector3d(2.0, 0.0, 5.0)).norm(), 1e-9);

  const std::string degrees = folder.write("d.csv",
                                           "time,target,latitude_deg,longitude_deg,height_m\n"
                                           "10.0,a,50.0,10.0,150.0\n10.1,a,50.001,10.0,100.0\n");
  EXPECT_TRUE(sightline_ros::isPositionTruth(degrees));
  const auto paths = positionTruthFromCsv(degrees, bag, 2.0);
  EXPECT_LT((paths.at("a").at(at(10.0))->position - Eigen::Vector3d(0.0, 0.0, 50.0)).norm(), 1e-6);
  EXPECT_NEAR(paths.at("a").at(at(10.1))->position.y(), 111.2, 0.1);  // a thousandth of a degree
}

TEST(RecordedPositions, WhatCannotBeUsedIsSaid) {
  const ScratchFolder folder;
  record(folder.file("a.bag"));
  const rosbag::Bag bag(folder.file("a.bag"));
  const std::string degrees =
      folder.write("d.csv", "time,latitude_deg,longitude_deg,height_m\n10.0,50.0,10.0,150.0\n");
  EXPECT_THROW(positionTruthFromCsv(degrees, bag, 2.0), std::runtime_error) << "where is the world?";
  const std::string empty = folder.write("e.csv", "time,east_m,north_m,up_m\n");
  EXPECT_THROW(positionTruthFromCsv(empty, bag, 2.0), sightline::report::CsvError);
  EXPECT_FALSE(sightline_ros::isPositionTruth(folder.write("a.csv", "time,azimuth,elevation\n")));
}

TEST(RecordedPositions, EvaluationIsInMetresAndWritesItsFiles) {
  const ScratchFolder folder;
  record(folder.file("a.bag"));
  BagEvaluationSettings settings;
  settings.truth = folder.write("m.csv", kTruth);
  settings.csv = folder.file("csv");
  const std::string said = evaluateBag(folder.file("a.bag"), settings);
  EXPECT_NE(said.find("/positions/tracks"), std::string::npos) << said;
  EXPECT_NE(said.find("RMSE [m]"), std::string::npos) << said;
  const auto rows = sightline::report::CsvTable::fromFile(
      settings.csv + "/positions.csv", {"topic", "samples", "rmse_m", "anees", "coverage", "false_tracks"},
      {"reports", "median_m", "p90_m", "p95_m", "median_velocity_m_s", "alone_samples", "alone_rmse_m",
       "alone_median_m", "alone_anees", "breaks", "id_changes", "tracks", "false_share", "gospa_m"});
  ASSERT_EQ(rows.rows(), 1u);
  EXPECT_EQ(rows.text(0, "samples"), "7");
  EXPECT_NEAR(rows.number(0, "rmse_m", "m"), 0.5, 1e-6);
  EXPECT_NEAR(rows.number(0, "anees", "1"), 1.0 / 3.0, 1e-6);
  EXPECT_EQ(rows.text(0, "false_tracks"), "0");
}

TEST(RecordedPositions, TruthIsReadFromATopicOfPositionsWhichIsNotScoredItself) {
  const ScratchFolder folder;
  record(folder.file("in.bag"));
  {
    rosbag::Bag bag(folder.file("in.bag"), rosbag::bagmode::Append);
    for (int i = 0; i <= 3; ++i) {
      sightline::PositionTrackArray truth;
      truth.header.stamp = ros::Time(10.0 + 0.2 * i);
      truth.tracks.resize(1);
      truth.tracks[0].id = 9;
      truth.tracks[0].status = sightline::PositionTrack::CONFIRMED;
      truth.tracks[0].position.x = 2.0 * i;
      truth.tracks[0].position.z = 5.0;
      bag.write("/truth/positions", truth.header.stamp, truth);
    }
  }
  const rosbag::Bag bag(folder.file("in.bag"));
  EXPECT_TRUE(sightline_ros::isPositionTopic("/truth/positions", bag));
  EXPECT_FALSE(sightline_ros::isPositionTopic("/truth", bag));
  const auto paths = sightline_ros::positionTruthFromTopic("/truth/positions", bag, 2.0);
  ASSERT_EQ(paths.size(), 1u);
  EXPECT_NEAR(paths.at("9").at(at(10.3))->position.x(), 3.0, 1e-6);
  BagEvaluationSettings settings;
  settings.truth = "/truth/positions";
  const std::string text = evaluateBag(folder.file("in.bag"), settings);
  EXPECT_NE(text.find("/positions/tracks"), std::string::npos) << text;
  EXPECT_EQ(text.find("/truth/positions"), std::string::npos) << text;
}

TEST(RecordedPositions, TruthOfAnotherTimeOrARecordingWithoutPositionsIsRefused) {
  const ScratchFolder folder;
  record(folder.file("late.bag"), 50.0);
  BagEvaluationSettings settings;
  settings.truth = folder.write("m.csv", kTruth);
  EXPECT_THROW(evaluateBag(folder.file("late.bag"), settings), std::runtime_error);
  { rosbag::Bag empty(folder.file("empty.bag"), rosbag::bagmode::Write); }
  EXPECT_THROW(evaluateBag(folder.file("empty.bag"), settings), std::runtime_error);
}

}  // namespace
