// Runs the example on its file and compares the track it prints with the simulated target.
#include <cmath>
#include <cstdio>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace {

constexpr double kSigmas = 5.0;  // largest error of an estimate, in its stated sigma

/// The true azimuth, elevation and their rates [rad, rad/s].
std::vector<double> truthAt(double time) {
  const double t = time - 100.0;
  return {0.5 + 0.2 * std::sin(0.6 * t), 0.2 + 0.03 * t, 0.12 * std::cos(0.6 * t), 0.03};
}

std::string outputOf(const std::string& command) {
  std::string output;
  FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return output;
  char buffer[4096];
  for (std::size_t read; (read = std::fread(buffer, 1, sizeof buffer, pipe)) > 0;)
    output.append(buffer, read);
  EXPECT_EQ(pclose(pipe), 0) << command;
  return output;
}

std::vector<double> numbersOf(const std::string& line) {
  std::istringstream stream(line);
  std::vector<double> numbers;
  for (std::string field; std::getline(stream, field, ',');) numbers.push_back(std::stod(field));
  return numbers;
}

TEST(CsvToTracks, OneTrackFollowsTheTargetWithinItsStatedSigma) {
  std::istringstream output(outputOf(std::string(SIGHTLINE_EXAMPLE) + " " + SIGHTLINE_EXAMPLE_CSV));
  std::string line;
  std::getline(output, line);
  EXPECT_EQ(line, "time,track,azimuth,elevation,azimuth_rate,elevation_rate,sigma_azimuth,sigma_elevation");
  int lines = 0;
  std::vector<double> last;
  while (std::getline(output, line)) {
    last = numbersOf(line);
    ASSERT_EQ(last.size(), 8u) << line;
    ++lines;
    const std::vector<double> truth = truthAt(last[0]);
    EXPECT_EQ(last[1], 1.0) << line;
    for (int i = 0; i < 2; ++i) {
      EXPECT_NEAR(last[2 + i], truth[i], kSigmas * last[6 + i]) << line;
      EXPECT_LT(last[6 + i], 0.002) << line;  // no worse than a sighting of the coarse sensor
    }
  }
  EXPECT_GE(lines, 200);  // of 250 scans
  ASSERT_FALSE(last.empty());
  EXPECT_NEAR(last[0], 104.98, 1e-9);
  const std::vector<double> truth = truthAt(last[0]);
  EXPECT_NEAR(last[2], truth[0], 0.002);
  EXPECT_NEAR(last[3], truth[1], 0.002);
  EXPECT_NEAR(last[4], truth[2], 0.03);
  EXPECT_NEAR(last[5], truth[3], 0.03);
}

}  // namespace
