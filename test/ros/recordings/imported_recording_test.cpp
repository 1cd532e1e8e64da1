#include "sightline/ros/recordings/imported_recording.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <rosbag/bag.h>
#include <rosbag/view.h>

#include "sightline/report/csv_table.h"
#include "sightline/ros/recordings/bags.h"

#include "support/command.h"
#include "support/paths.h"
#include "support/scratch_folder.h"

namespace {

namespace formats = sightline::formats;
using sightline::SightingArray;
using sightline_ros::importSightings;
using sightline_ros::importTruth;
using sightline_ros::scansOf;

std::string sample(const std::string& name) {
  return sightline::test::sourceDirectory() + "/test/formats/data/" + name;
}

std::pair<int, std::string> run(const std::string& command) {
  return outcomeOf(std::string(SIGHTLINE_TOOLS_DIR) + "/" + command);
}

std::vector<SightingArray> scansIn(const std::string& bag_file) {
  const auto bag = sightline_ros::openBag(bag_file);
  std::vector<SightingArray> scans;
  rosbag::View view(*bag);
  for (const rosbag::MessageInstance& instance : view) {
    if (const auto scan = instance.instantiate<SightingArray>()) scans.push_back(*scan);
  }
  return scans;
}

formats::FileScan scanAt(double seconds, const std::string& sensor) {
  formats::FileScan scan;
  scan.time = sightline::core::Time{} + sightline::core::durationOf(seconds);
  scan.sensor = sensor;
  return scan;
}

std::string refusal(const formats::Recording& recording) {
  std::vector<std::string> renamed;
  try {
    scansOf(recording, "", renamed);
  } catch (const std::exception& problem) {
    return problem.what();
  }
  return "";
}

TEST(ImportedRecording, ScansAreInTheFrameOfTheirStationOrOfTheTrackers) {
  formats::Recording recording;
  recording.scans = {scanAt(1.0, "a"), scanAt(2.0, "b")};
  std::vector<std::string> renamed;
  EXPECT_EQ(scansOf(recording, "", renamed)[1].header.frame_id, "platform_enu");
  EXPECT_EQ(scansOf(recording, "mine", renamed)[1].header.frame_id, "mine");
  recording.stations["a"] = {};
  EXPECT_NE(refusal(recording).find("\"b\" is not known, while that of others is"), std::string::npos);
  recording.stations["b"] = {};
  EXPECT_EQ(scansOf(recording, "", renamed)[1].header.frame_id, "b");
  EXPECT_TRUE(renamed.empty());
}

TEST(ImportedRecording, NamesThatNoTopicCanBeMadeOfAreChangedAndSaid) {
  formats::Recording recording;
  recording.scans = {scanAt(1.0, "S05 Vermin"), scanAt(2.0, "S05_Vermin")};
  std::vector<std::string> renamed;
  const auto scans = scansOf(recording, "", renamed);
  EXPECT_EQ(scans[0].sensor, "S05_Vermin_");
  EXPECT_EQ(scans[1].sensor, "S05_Vermin");
  ASSERT_EQ(renamed.size(), 1u);
  EXPECT_NE(renamed[0].find("\"S05 Vermin\" is called S05_Vermin_"), std::string::npos);
}

TEST(ImportedRecording, TimesThatABagCannotHoldAreRefused) {
  formats::Recording recording;
  recording.scans = {scanAt(0.0, "a")};
  EXPECT_NE(refusal(recording).find("--offset 100"), std::string::npos);
  recording.scans = {scanAt(5e9, "a")};
  EXPECT_NE(refusal(recording), "");
}

TEST(ImportedRecording, FilesBecomeABagWithTheirStationsAndSayWhatWasUnderstood) {
  const ScratchFolder folder;
  const std::string bag = folder.file("out.bag");
  const std::string said = importSightings({sample("dfn_small_36.ecsv")}, bag, {}, "");
  EXPECT_NE(said.find("fireball ECSV, sensors DFNSMALL36: 6 scans with 6 sightings"), std::string::npos)
      << said;
  EXPECT_NE(said.find("station DFNSMALL36: latitude -30.6608 deg"), std::string::npos) << said;
  const auto scans = scansIn(bag);
  ASSERT_EQ(scans.size(), 6u);
  EXPECT_EQ(scans[0].header.frame_id, "DFNSMALL36");
  EXPECT_NEAR(scans[0].sightings.at(0).azimuth, -1.9351153, 1e-7);
  EXPECT_NEAR(scans[0].sightings.at(0).elevation, 0.6138921, 1e-7);
  EXPECT_NEAR(std::sqrt(scans[0].sightings[0].covariance[0]), 0.0005190, 1e-7);
}

TEST(ImportedRecording, StationsThatAreOfNoSensorAreSaid) {
  const ScratchFolder folder;
  formats::ImportOptions options;
  options.stations["DFNSMALL63"] = {};
  const std::string said =
      importSightings({sample("dfn_small_36.ecsv")}, folder.file("out.bag"), options, "");
  EXPECT_NE(said.find("of no sensor in these files: DFNSMALL63"), std::string::npos) << said;
}

TEST(ImportedRecording, ATruthIsWhatEvaluateReads) {
  const ScratchFolder folder;
  formats::ImportOptions options;
  importTruth({sample("dfn_small_36.ecsv")}, folder.file("truth.csv"), options);
  std::ifstream stream(folder.file("truth.csv"));
  std::string head, first;
  std::getline(stream, head);
  std::getline(stream, first);
  EXPECT_EQ(head, "time,target,sensor,azimuth,elevation");
  EXPECT_EQ(first.substr(0, 43), "1416928875.386000000,1,DFNSMALL36,-1.935115");
}

TEST(ImportedRecording, NothingIsHalfWrittenAndNoInputIsOverwritten) {
  const ScratchFolder folder;
  const std::string good = folder.write("good.csv", "time,sensor,azimuth,elevation\n1,a,0.1,0.2\n");
  const std::string bad = folder.write("bad.csv", "time,sensor,azimuth,elevation\n1,a,0.1,0.2\n2,a,0.1\n");
  auto [code, said] =
      run("import_sightings --sigma 1mrad " + good + " " + bad + " " + folder.file("out.bag"));
  EXPECT_EQ(code, 1);
  EXPECT_NE(said.find("bad.csv:3: expected 4 fields"), std::string::npos) << said;
  EXPECT_FALSE(std::filesystem::exists(folder.file("out.bag")));
  EXPECT_FALSE(std::filesystem::exists(folder.file("out.bag.unfinished")));
  std::tie(code, said) = run("import_sightings --sigma 1mrad " + good + " " + good);
  EXPECT_EQ(code, 1);
  EXPECT_NE(said.find("cannot be read and written at once"), std::string::npos) << said;
  std::tie(code, said) = run("import_sightings --sigma 1 " + good + " " + folder.file("out.bag"));
  EXPECT_EQ(code, 2);
  EXPECT_NE(said.find("--sigma: cannot be understood: \"1\""), std::string::npos) << said;
}

TEST(ImportedRecording, DialectsOfCsvHaveATrackInTheFusion) {
  const ScratchFolder folder;
  std::ostringstream semicolons, tabs, degrees, bare;
  semicolons << "time;sensor;azimuth;elevation;sigma_azimuth;sigma_elevation\n";
  tabs << "# a comment\ntime\tsensor\tazimuth\televation\tsigma_azimuth\tsigma_elevation\tlabel\n";
  degrees << "datetime,camera,az_deg,alt_deg\n";
  bare << "time,sensor,azimuth\n";
  for (int i = 0; i < 20; ++i) {
    semicolons << 1000 + i << ",0;cam;0,1" << 10 + i << ";0,3;0,001;0,001\n";
    tabs << 1000 + i << "\tcam\t0.1" << 10 + i << "\t0.3\t0.001\t0.001\tx\n";
    degrees << "2026-03-01T21:54:" << 10 + i << ".250Z,cam," << (i < 10 ? 359.0 + 0.1 * i : 0.1 * i - 1.0)
            << ",17.2\n";
    bare << 1000 + i << ",cam,0.1" << 10 + i << "\n";
  }
  const std::vector<std::pair<std::string, std::string>> cases{
      {semicolons.str(), ""},
      {tabs.str(), ""},
      {degrees.str(),
       "--sigma 0.06deg --columns "
       "time=datetime,sensor=camera,azimuth=az_deg:deg:compass,elevation=alt_deg:deg "},
      {bare.str(), "--elevation 0deg --sigma 0.06deg,20deg "}};
  for (const auto& [text, options] : cases) {
    const std::string csv = folder.write("in.csv", text), bag = folder.file("in.bag"),
                      tracked = folder.file("out.bag");
    ASSERT_EQ(run("import_sightings " + options + csv + " " + bag).first, 0) << text;
    ASSERT_EQ(run("replay " + bag + " " + tracked).first, 0) << text;
    ASSERT_EQ(run("bag_to_csv --topic /fusion/tracks " + tracked + " " + folder.file("tracks.csv")).first, 0);
    std::ifstream stream(folder.file("tracks.csv"));
    std::size_t confirmed = 0;
    for (std::string line; std::getline(stream, line);)
      confirmed += line.find(",confirmed,") != std::string::npos ? 1 : 0;
    EXPECT_GE(confirmed, 15u) << text;
  }
}

TEST(ImportedRecording, ThreeStationsOfTheSharedRecordingsAreItsScansAgain) {
  const std::string shared = sightline::test::sharedDirectory();
  const std::string folder_of_files = shared + "/data/formats/fireball_ecsv/";
  if (shared.empty() || !std::filesystem::exists(folder_of_files)) GTEST_SKIP() << "no shared recordings";
  const ScratchFolder folder;
  importSightings({folder_of_files + "DFNSMALL36.ecsv", folder_of_files + "DFNSMALL38.ecsv",
                   folder_of_files + "DFNSMALL40.ecsv"},
                  folder.file("out.bag"), {}, "");
  ASSERT_EQ(run("bag_to_csv --sightings " + folder.file("out.bag") + " " + folder.file("out.csv")).first, 0);
  const std::vector<std::string> columns{"time",          "sensor",          "azimuth", "elevation",
                                         "sigma_azimuth", "sigma_elevation", "scan"};
  const auto ours = sightline::report::CsvTable::fromFile(folder.file("out.csv"), columns);
  const auto theirs =
      sightline::report::CsvTable::fromFile(shared + "/data/fireball_3_stations/sightings.csv", columns);
  ASSERT_EQ(ours.rows(), theirs.rows());
  // The shared table counts from 100 s at the first sighting, and may order those of one instant differently.
  const auto offset = ours.time(0, "time") - theirs.time(0, "time");
  std::map<std::pair<std::string, sightline::core::Time>, std::size_t> row_of;
  for (std::size_t row = 0; row < theirs.rows(); ++row)
    row_of[{theirs.text(row, "sensor"), theirs.time(row, "time") + offset}] = row;
  for (std::size_t row = 0; row < ours.rows(); ++row) {
    const auto found = row_of.find({ours.text(row, "sensor"), ours.time(row, "time")});
    ASSERT_NE(found, row_of.end()) << row;
    for (const char* column : {"azimuth", "elevation", "sigma_azimuth", "sigma_elevation"})
      EXPECT_NEAR(ours.number(row, column, "rad"), theirs.number(found->second, column, "rad"), 1e-7)
          << column << " " << row;
  }
}

}  // namespace
