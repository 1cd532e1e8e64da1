// bench/recordings_report on a recording of its own: one target that jumps further than its track can follow.
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>

#include "support/paths.h"
#include "support/scratch_folder.h"

namespace {

constexpr double kStep = 1.0 / 30.0;  // [s]

bool havePythonToDraw() {
  return std::system("/usr/bin/python3 -c 'import matplotlib, numpy' 2>/dev/null") == 0;
}

/// A target that moves on evenly, and jumps by `jump` [rad] after two of four seconds.
void writeRecording(const ScratchFolder& folder, double jump) {
  const std::string run = folder.file("data") + "/crossing/run1";
  std::filesystem::create_directories(run);
  std::ofstream sightings(run + "/sightings.csv"), truth(run + "/truth.csv");
  sightings.precision(10), truth.precision(10);
  sightings << "time,sensor,azimuth,elevation,sigma_azimuth,sigma_elevation,scan\n";
  truth << "time,target,azimuth,elevation\n";
  for (int i = 0; i < 120; ++i) {
    const double t = kStep * i, azimuth = 0.01 * t + (t >= 2.0 ? jump : 0.0);
    const double noise = 0.0005 * std::sin(37.0 * i);  // [rad]
    sightings << 100.0 + t << ",camera," << azimuth + noise << ',' << -noise << ",0.001,0.001," << i << '\n';
    truth << 100.0 + t << ",1," << azimuth << ",0.0\n";
  }
}

/// The line of the report's table about the recording.
std::string reportedLine(const ScratchFolder& folder) {
  const std::string command = "/usr/bin/python3 " + sightline::test::sourceDirectory() +
                              "/bench/recordings_report --data " + folder.file("data") +
                              " --tools " SIGHTLINE_TOOLS_DIR " --out " + folder.file("out") +
                              " --pictures " + folder.file("pictures") + " > /dev/null";
  EXPECT_EQ(std::system(command.c_str()), 0) << command;
  std::istringstream report(textOfFile(folder.file("out") + "/report.md"));
  for (std::string line; std::getline(report, line);) {
    if (line.find("| crossing_run1 | camera |") == 0) return line;
  }
  ADD_FAILURE() << "no line on crossing_run1";
  return "";
}

TEST(RecordingsReport, ATargetThatIsHeldHasNoBreakAndAPicture) {
  if (!havePythonToDraw()) GTEST_SKIP() << "no matplotlib";
  const ScratchFolder folder;
  writeRecording(folder, 0.0);
  const std::string line = reportedLine(folder);
  EXPECT_NE(line.find("| 0 (0) | 0 | 1 | 0 | 1.000 |"), std::string::npos) << line;
  EXPECT_GT(std::filesystem::file_size(folder.file("pictures") + "/crossing_run1.png"), 1000u);
}

TEST(RecordingsReport, ATrackLostThoughItsTargetIsSeenIsSaidToBe) {
  if (!havePythonToDraw()) GTEST_SKIP() << "no matplotlib";
  const ScratchFolder folder;
  writeRecording(folder, 0.3);
  const std::string line = reportedLine(folder);
  EXPECT_NE(line.find("| 1 (1, longest 0."), std::string::npos) << line;
}

}  // namespace
