// The tools that read and write recordings, as their users run them.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "support/command.h"
#include "support/file_size_limit.h"
#include "support/paths.h"
#include "support/scratch_folder.h"

namespace {

namespace fs = std::filesystem;

/// Exit code and words of a tool.
std::pair<int, std::string> run(const std::string& command) {
  return outcomeOf(std::string(SIGHTLINE_TOOLS_DIR) + "/" + command);
}

std::ptrdiff_t linesIn(const std::string& text) {
  return std::count(text.begin(), text.end(), '\n');
}

class RecordingTools : public testing::Test {
 protected:
  RecordingTools() {
    std::ostringstream table;
    table << "time,sensor,azimuth,elevation,sigma_azimuth,sigma_elevation\n";
    for (int i = 0; i < 3000; ++i)
      table << 1000.0 + 0.05 * i << ",cam," << 0.1 + 0.0003 * i << ",0.3,0.001,0.001\n";
    csv_ = folder_.write("in.csv", table.str());
  }

  void makeBags() {
    ASSERT_EQ(run("csv_to_bag " + csv_ + " " + bag_).first, 0);
    ASSERT_EQ(run("replay " + bag_ + " " + tracked_).first, 0);
  }

  /// Names of the files in the folder.
  std::set<std::string> files() const {
    std::set<std::string> names;
    for (const auto& entry : fs::recursive_directory_iterator(fs::path(csv_).parent_path())) {
      if (entry.is_regular_file()) names.insert(entry.path().filename());
    }
    return names;
  }

  ScratchFolder folder_;
  std::string csv_;
  const std::string bag_ = folder_.file("in.bag"), tracked_ = folder_.file("tracked.bag");
};

TEST_F(RecordingTools, ReplaySaysWhatItDidNotWriteAndEvaluateThatItIsNotThere) {
  ASSERT_EQ(run("csv_to_bag " + csv_ + " " + bag_).first, 0);
  const std::string in_part = run("replay " + bag_ + " " + tracked_).second;
  EXPECT_NE(in_part.find("messages not written"), std::string::npos) << in_part;
  EXPECT_NE(run("evaluate " + tracked_).second.find("shorter breaks and changes are not seen"),
            std::string::npos);
  const std::string all = run("replay --all " + bag_ + " " + tracked_).second;
  EXPECT_EQ(all.find("messages not written"), std::string::npos) << all;
  EXPECT_EQ(run("evaluate " + tracked_).second.find("shorter breaks"), std::string::npos);
  EXPECT_EQ(run("replay --all --topics /fusion/tracks " + bag_ + " " + tracked_).first, 2)
      << "which of the two?";
}

TEST_F(RecordingTools, DoNotOverwriteTheirInput) {
  makeBags();
  const std::string config = folder_.write("config.yaml", "local_tracker: {}\n");
  const std::string scenario =
      (fs::path(sightline::test::sourceDirectory()) / "config/scenarios/line.yaml").string();
  fs::copy_file(scenario, folder_.file("line.yaml"));
  fs::create_directory(folder_.file("figures"));
  const std::string truth = folder_.file("figures/errors.csv");
  std::ofstream(truth) << "time,azimuth,elevation\n1000,0.1,0.3\n1140,0.94,0.3\n";
  const std::vector<std::pair<std::string, std::string>> cases{
      {"csv_to_bag " + csv_ + " " + csv_, csv_},
      {"bag_to_csv " + tracked_ + " " + tracked_, tracked_},
      {"replay " + bag_ + " " + bag_, bag_},
      {"replay --config " + config + " " + bag_ + " " + config, config},
      {"simulate --duration 1 " + folder_.file("line.yaml") + " " + folder_.file("line.yaml"),
       folder_.file("line.yaml")},
      {"evaluate --truth " + truth + " --csv " + folder_.file("figures") + " " + tracked_, truth},
  };
  const std::set<std::string> before = files();
  for (const auto& [command, input] : cases) {
    const std::string bytes = textOfFile(input);
    const auto [code, said] = run(command);
    EXPECT_EQ(code, 1) << command << "\n" << said;
    EXPECT_EQ(linesIn(said), 1) << said;
    EXPECT_NE(said.find(input + " cannot be read and written at once: name another output"),
              std::string::npos)
        << said;
    EXPECT_TRUE(textOfFile(input) == bytes) << command;
  }
  EXPECT_EQ(files(), before);
}

TEST_F(RecordingTools, OnAFullDiskSayOneLineAndLeaveNothingHalfWritten) {
  makeBags();
  const std::string truth =
      folder_.write("truth.csv", "time,azimuth,elevation\n1000,0.1,0.3\n1149,0.994,0.3\n");
  const std::vector<std::string> commands{
      "csv_to_bag " + csv_ + " " + folder_.file("out.bag"),
      "bag_to_csv " + tracked_ + " " + folder_.file("out.csv"),
      "replay " + bag_ + " " + folder_.file("out.bag"),
      "simulate --duration 20 crowd " + folder_.file("out.bag"),
      "evaluate --truth-gap 1000 --truth " + truth + " --csv " + folder_.file("figures") + " " + tracked_,
  };
  const std::set<std::string> before = files();
  for (const std::string& command : commands) {
    const FileSizeLimit limit(20000);
    const auto [code, said] = run(command);
    EXPECT_EQ(code, 1) << command << "\n" << said;
    EXPECT_EQ(linesIn(said), 1) << said;
    EXPECT_NE(said.find("cannot be written: File too large"), std::string::npos) << said;
    EXPECT_EQ(files(), before) << command;
  }
}

TEST_F(RecordingTools, WhereNothingCanBeWrittenSayOneLine) {
  makeBags();
  const std::vector<std::string> commands{
      "csv_to_bag " + csv_ + " /no/folder/out.bag",
      "bag_to_csv " + tracked_ + " /no/folder/out.csv",
      "replay " + bag_ + " /no/folder/out.bag",
      "simulate --duration 1 crowd /no/folder/out.bag",
  };
  for (const std::string& command : commands) {
    const auto [code, said] = run(command);
    EXPECT_EQ(code, 1) << command;
    EXPECT_EQ(linesIn(said), 1) << said;
    EXPECT_NE(said.find("cannot be written: No such file or directory"), std::string::npos) << said;
  }
  EXPECT_EQ(run("csv_to_bag " + csv_ + " /dev/full").first, 1) << "and not 134";
  const auto [code, said] =
      outcomeOf("( " + std::string(SIGHTLINE_TOOLS_DIR) + "/evaluate " + tracked_ + " > /dev/full )");
  EXPECT_EQ(code, 1);
  EXPECT_NE(said.find("standard output: cannot be written: No space left on device"), std::string::npos)
      << said;
}

TEST_F(RecordingTools, EvaluateRefusesATruthOfAnotherTimeWithBothSpans) {
  makeBags();
  const std::string truth = folder_.write("truth.csv", "time,azimuth,elevation\n0,0.1,0.3\n60,0.94,0.3\n");
  const auto [code, said] = run("evaluate --truth " + truth + " " + tracked_);
  EXPECT_EQ(code, 1) << said;
  EXPECT_EQ(linesIn(said), 1) << said;
  EXPECT_NE(
      said.find(
          "the truth is of 0.000 s to 60.000 s, and the recording's sightings and tracks of 1000.000 s to "
          "1149.950 s"),
      std::string::npos)
      << said;
}

TEST_F(RecordingTools, TheDoctorExaminesARecordingWithTheSameWordsAndExitCodes) {
  makeBags();
  const auto [well, said_of_good] = run("doctor " + tracked_);
  EXPECT_EQ(well, 0) << said_of_good;
  EXPECT_NE(said_of_good.find("sensors: 1, trackers: 2, fusions: 1"), std::string::npos) << said_of_good;
  EXPECT_NE(said_of_good.find("nothing wrong found"), std::string::npos) << said_of_good;

  std::ostringstream table;
  table << "time,sensor,azimuth,elevation,sigma_azimuth,sigma_elevation,scan\n";
  for (int i = 0; i < 500; ++i)
    table << 1000 + i / 50 << ",cam," << 0.1 + 0.0004 * i << ",0.3,0.001,0.001," << i << "\n";
  ASSERT_EQ(
      run("csv_to_bag " + folder_.write("whole.csv", table.str()) + " " + folder_.file("whole.bag")).first,
      0);
  const auto [ill, said_of_bad] = run("doctor " + folder_.file("whole.bag"));
  EXPECT_EQ(ill, 1) << said_of_bad;
  EXPECT_NE(said_of_bad.find("WRONG  cam on /sensors/cam/sightings: 490 of 500 scans repeat the stamp"),
            std::string::npos)
      << said_of_bad;
  EXPECT_NE(said_of_bad.find("thing"), std::string::npos) << said_of_bad;

  EXPECT_EQ(run("doctor " + folder_.file("missing.bag")).first, 1);
  EXPECT_EQ(run("doctor --seconds 3 " + tracked_).first, 2);
}

}  // namespace
