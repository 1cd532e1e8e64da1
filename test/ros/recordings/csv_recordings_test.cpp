#include "sightline/ros/recordings/csv_recordings.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <rosbag/bag.h>
#include <rosbag/view.h>

#include "sightline/ros/messages/conversions.h"

#include "support/scratch_folder.h"

namespace {

using sightline::report::CsvError;
using sightline::report::CsvTable;
using sightline_ros::convertBagToCsv;
using sightline_ros::convertCsvToBag;
using sightline_ros::scansOf;

const std::string kHeader = "time,sensor,azimuth,elevation,sigma_azimuth,sigma_elevation";

CsvTable csvOf(const std::string& text) {
  std::istringstream stream(text);
  return CsvTable(stream, "in.csv",
                  {"time", "sensor", "azimuth", "elevation", "sigma_azimuth", "sigma_elevation"}, {"scan"});
}

std::string refusal(const std::string& text, double offset = 0.0) {
  try {
    scansOf(csvOf(text), "platform_enu", offset);
  } catch (const CsvError& error) {
    return error.what();
  }
  return "";
}

TEST(CsvRecordings, RowsOfOneScanAndSensorAreOneExposure) {
  const auto scans = scansOf(csvOf(kHeader + ",scan\n"
                                             "10.5,b,0.1,0.2,0.001,0.002,7\n"
                                             "10.5,a,0.3,0.4,0.001,0.002,7\n"
                                             "10.5,b,-0.1,0.2,0.001,0.002,7\n"
                                             "10.6,b,0.1,0.2,0.001,0.002,8\n"),
                             "my_frame", 0.0);
  ASSERT_EQ(scans.size(), 3u);
  EXPECT_EQ(scans[0].sensor, "a");
  EXPECT_EQ(scans[1].sensor, "b");
  ASSERT_EQ(scans[1].sightings.size(), 2u);
  EXPECT_EQ(scans[1].sightings[1].azimuth, -0.1);
  EXPECT_EQ(scans[1].header.frame_id, "my_frame");
  EXPECT_DOUBLE_EQ(scans[1].sightings[0].covariance[0], 1e-6);
  EXPECT_DOUBLE_EQ(scans[1].sightings[0].covariance[3], 4e-6);
  EXPECT_EQ(scans[1].sightings[0].covariance[1], 0.0);
  EXPECT_TRUE(std::isnan(scans[1].ifov) && std::isnan(scans[1].detection_probability) &&
              std::isnan(scans[1].clutter_density) && std::isnan(scans[1].sightings[0].snr));
}

TEST(CsvRecordings, WithoutScanColumnEachRowIsAScanInOrderOfTime) {
  const auto scans =
      scansOf(csvOf(kHeader + "\n2,a,0,0,1e-3,1e-3\n1,a,0,0,1e-3,1e-3\n1,a,0.5,0,1e-3,1e-3\n"), "f", 0.0);
  ASSERT_EQ(scans.size(), 3u);
  EXPECT_EQ(scans[0].header.stamp, ros::Time(1.0));
  EXPECT_EQ(scans[2].header.stamp, ros::Time(2.0));
}

TEST(CsvRecordings, AnglesThatAreRoundedBeyondTheEndOfTheirRangeAreTaken) {
  const auto scans = scansOf(
      csvOf(kHeader + "\n1,a,6.2831855,0,1e-3,1e-3\n2,a,0,1.570796327,1e-3,1e-3\n3,a,0,-1.5708,1e-3,1e-3\n"),
      "f", 0.0);
  EXPECT_EQ(scans.size(), 3u);
}

TEST(CsvRecordings, TimesAreExactToTheNanosecond) {
  const auto scans =
      scansOf(csvOf(kHeader + "\n1700000000.123456789,a,0,0,1e-3,1e-3\n1e1,a,0,0,1e-3,1e-3\n"), "f", 0.0);
  EXPECT_EQ(scans[0].header.stamp, ros::Time(10, 0));
  EXPECT_EQ(scans[1].header.stamp, ros::Time(1700000000, 123456789));
}

TEST(CsvRecordings, TimeZeroIsRefusedWithTheRemedyThatThenHelps) {
  const std::string text = kHeader + "\n0.0,a,0,0,1e-3,1e-3\n";
  EXPECT_EQ(refusal(text),
            "in.csv:2: time: 0.0 s cannot be held by a bag, which knows only times after 0: shift the "
            "recording, with "
            "--offset 100 for instance");
  EXPECT_NE(refusal(kHeader + "\n-5,a,0,0,1e-3,1e-3\n"), "");
  EXPECT_EQ(scansOf(csvOf(text), "f", 100.0).at(0).header.stamp, ros::Time(100.0));
}

TEST(CsvRecordings, ErrorsNameTheLineTheColumnAndTheValue) {
  EXPECT_EQ(refusal(kHeader + "\n\n1,a,here,0,1e-3,1e-3\n"),
            "in.csv:3: azimuth: expected a finite number [rad], got \"here\"");
  EXPECT_EQ(refusal(kHeader + "\n1,a,nan,0,1e-3,1e-3\n"),
            "in.csv:2: azimuth: expected a finite number [rad], got \"nan\"");
  EXPECT_EQ(refusal(kHeader + "\n1,a,0,0,1e-3\n"), "in.csv:2: expected 6 fields, got 5");
  EXPECT_NE(
      refusal(kHeader + "\n1,a,45,0,1e-3,1e-3\n").find("in.csv:2: direction (45, 0) rad is off the sphere"),
      std::string::npos);
  EXPECT_NE(refusal(kHeader + "\n1,a,0,0,-0.001,1e-3\n").find("in.csv:2: a sigma is negative"),
            std::string::npos);
  EXPECT_NE(refusal(kHeader + "\n1,a,0,0,0,1e-3\n").find("in.csv:2: covariance"), std::string::npos);
  EXPECT_NE(refusal(kHeader + "\n1,cam-1,0,0,1e-3,1e-3\n").find("got \"cam-1\""), std::string::npos);
  EXPECT_NE(refusal(kHeader + "\n1700000000000,a,0,0,1e-3,1e-3\n").find("milli- or nanoseconds?"),
            std::string::npos);
  EXPECT_NE(refusal(kHeader + "\n5e9,a,0,0,1e-3,1e-3\n").find("in.csv:2: time: "), std::string::npos);
  EXPECT_NE(refusal(kHeader + ",scan\n1,a,0,0,1e-3,1e-3,1\n2,a,0,0,1e-3,1e-3,1\n")
                .find("in.csv:3: scan: \"1\" of a"),
            std::string::npos);
}

TEST(CsvRecordings, HeaderIsChecked) {
  EXPECT_NE(refusal("").find("expected a header line"), std::string::npos);
  EXPECT_NE(refusal("time,sensor,azimuth\n").find("column \"elevation\" is missing"), std::string::npos);
  EXPECT_NE(refusal(kHeader + ",colour\n").find("unknown column \"colour\""), std::string::npos);
  EXPECT_NE(refusal(kHeader + ",time\n").find("\"time\" stands twice"), std::string::npos);
}

TEST(CsvRecordings, FilesFromOtherSystemsAreRead) {
  const auto scans =
      scansOf(csvOf("\xEF\xBB\xBFsensor, time "
                    ",azimuth,elevation,sigma_elevation,sigma_azimuth\r\na,1,0.1,0,2e-3,1e-3\r\n"),
              "f", 0.0);
  ASSERT_EQ(scans.size(), 1u);
  EXPECT_DOUBLE_EQ(scans[0].sightings[0].covariance[0], 1e-6);
}

TEST(CsvRecordings, BagHoldsEveryScanAtItsStampOnItsSensorsTopic) {
  const ScratchFolder folder;
  const std::string csv =
      folder.write("in.csv", kHeader + "\n1,a,0,0,1e-3,1e-3\n1.5,b,0,0,1e-3,1e-3\n2,a,0,0,1e-3,1e-3\n");
  convertCsvToBag(csv, folder.file("out.bag"), "platform_enu", 0.0);
  rosbag::Bag bag(folder.file("out.bag"));
  std::vector<std::string> seen;
  for (const rosbag::MessageInstance& message : rosbag::View(bag)) {
    EXPECT_EQ(message.getTime(), message.instantiate<sightline::SightingArray>()->header.stamp);
    seen.push_back(message.getTopic());
  }
  EXPECT_EQ(seen, (std::vector<std::string>{"/sensors/a/sightings", "/sensors/b/sightings",
                                            "/sensors/a/sightings"}));
}

TEST(CsvRecordings, NothingIsLeftBehindWhenARecordingIsRefused) {
  const ScratchFolder folder;
  EXPECT_THROW(convertCsvToBag(folder.file("absent.csv"), folder.file("out.bag"), "f", 0.0), CsvError);
  EXPECT_THROW(convertCsvToBag(folder.write("empty.csv", kHeader + "\n"), folder.file("out.bag"), "f", 0.0),
               CsvError);
  EXPECT_FALSE(std::filesystem::exists(folder.file("out.bag")));
  EXPECT_FALSE(std::filesystem::exists(folder.file("out.bag.unfinished")));
}

sightline::TrackArray tracksAt(double stamp, const std::string& tracker, std::uint32_t id) {
  sightline::TrackArray tracks;
  tracks.header.stamp = ros::Time(stamp);
  tracks.tracker = tracker;
  sightline::Track track;
  track.id = id;
  track.status = sightline::Track::CONFIRMED;
  track.azimuth = 0.1;
  track.elevation = -0.2;
  track.azimuth_rate = 0.3;
  track.elevation_rate = -0.4;
  for (int i = 0; i < 4; ++i) track.covariance[5 * i] = std::pow(0.5, 2 * i);
  tracks.tracks.push_back(track);
  return tracks;
}

TEST(CsvRecordings, TracksOfABagBecomeATableInOrderOfTime) {
  const ScratchFolder folder;
  {
    rosbag::Bag bag(folder.file("in.bag"), rosbag::bagmode::Write);
    bag.write("/b/tracks", ros::Time(5.0), tracksAt(3.0, "b", 2));
    bag.write("/a/tracks", ros::Time(6.0), tracksAt(2.5, "a", 1));
  }
  convertBagToCsv(folder.file("in.bag"), folder.file("out.csv"), {});
  std::ifstream stream(folder.file("out.csv"));
  const std::string written((std::istreambuf_iterator<char>(stream)), std::istreambuf_iterator<char>());
  EXPECT_EQ(
      written,
      "time,tracker,track,status,azimuth,elevation,azimuth_rate,elevation_rate,sigma_azimuth,sigma_elevation,"
      "sigma_azimuth_rate,sigma_elevation_rate\n"
      "2.500000000,a,1,confirmed,0.1,-0.2,0.3,-0.4,1,0.5,0.25,0.125\n"
      "3.000000000,b,2,confirmed,0.1,-0.2,0.3,-0.4,1,0.5,0.25,0.125\n");

  convertBagToCsv(folder.file("in.bag"), folder.file("b.csv"), {"/b/tracks"});
  std::ifstream chosen(folder.file("b.csv"));
  std::string header, first, second;
  std::getline(chosen, header);
  EXPECT_TRUE(std::getline(chosen, first) && first.find(",b,") != std::string::npos);
  EXPECT_FALSE(std::getline(chosen, second));
  EXPECT_THROW(convertBagToCsv(folder.file("in.bag"), folder.file("c.csv"), {"/c/tracks"}),
               std::runtime_error);
}

}  // namespace
