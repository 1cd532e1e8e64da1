// The rules of the house that a machine can check: layers, rooms and floors.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "support/paths.h"

namespace {

namespace fs = std::filesystem;

const fs::path kRoot = sightline::test::sourceDirectory();

/// Floors of the rooms, lowest first: a room includes itself and rooms on floors below it. A room below
/// another one's name (fusion/rules) is part of that room.
using Floors = std::map<std::string, int>;

const Floors kCoreFloors{{"model", 1},      {"estimators", 2}, {"ordering", 2},    {"simulation", 2},
                         {"imaging", 2},    {"smoothing", 3},  {"association", 3}, {"sensors", 4},
                         {"evaluation", 4}, {"tracking", 5},   {"fusion", 5},      {"positions", 5}};

const Floors kRosFloors{{"params", 1},     {"messages", 2},   {"diagnosis", 3}, {"display", 3},
                        {"adapters", 4},   {"components", 4}, {"outputs", 4},   {"inspector", 4},
                        {"recordings", 5}, {"nodes", 6}};

std::vector<fs::path> filesOf(const std::string& layer) {
  std::vector<fs::path> files;
  for (const fs::path& folder : {kRoot / "include/sightline" / layer, kRoot / "src" / layer}) {
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
      const std::string suffix = entry.path().extension().string();
      if (suffix == ".h" || suffix == ".cpp") files.push_back(entry.path());
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

std::vector<std::string> linesOf(const fs::path& file) {
  std::ifstream stream(file);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// What a file includes, as written.
std::vector<std::string> includesOf(const fs::path& file) {
  static const std::regex include(R"(^\s*#\s*include\s*[<"]([^>"]+)[>"].*)");
  std::vector<std::string> includes;
  for (const std::string& line : linesOf(file)) {
    std::smatch found;
    if (std::regex_match(line, found, include)) includes.push_back(found[1].str());
  }
  return includes;
}

/// The room of "sightline/LAYER/ROOM/..." or of a file's path; empty when it is in none.
std::string roomOf(const std::string& path, const std::string& layer) {
  const std::regex room("(?:.*/)?(?:sightline|src)/" + layer + "/([a-z_]+)/.*");
  std::smatch found;
  return std::regex_match(path, found, room) ? found[1].str() : std::string();
}

void expectFloorsHold(const std::string& layer, const Floors& floors) {
  std::size_t arrows = 0;
  for (const fs::path& file : filesOf(layer)) {
    const std::string room = roomOf(file.string(), layer);
    ASSERT_EQ(floors.count(room), 1u)
        << file << " is in no room: add the room to this test and to doc/architecture.md";
    for (const std::string& include : includesOf(file)) {
      const std::string other = roomOf(include, layer);
      if (other.empty() || other == room) continue;
      ++arrows;
      ASSERT_EQ(floors.count(other), 1u) << file << " includes " << include;
      EXPECT_LT(floors.at(other), floors.at(room))
          << file << " includes " << include << ", which is not below it";
    }
  }
  EXPECT_GE(arrows, 50u) << "the pattern for includes finds too few of them";
}

void expectIncludesMatch(const std::string& layer, const std::string& pattern) {
  const std::regex allowed(pattern);
  std::size_t includes = 0;
  const auto files = filesOf(layer);
  ASSERT_GE(files.size(), 8u);
  for (const fs::path& file : files) {
    for (const std::string& include : includesOf(file)) {
      ++includes;
      EXPECT_TRUE(std::regex_match(include, allowed)) << file << " includes " << include;
    }
  }
  EXPECT_GE(includes, files.size()) << "the pattern for includes finds too few of them";
}

// Standard headers have neither folder nor suffix.
TEST(House, CoreIncludesNothingButItselfEigenAndTheStandardLibrary) {
  expectIncludesMatch("core", R"([a-z_0-9]+|Eigen/.*|unsupported/Eigen/.*|sightline/core/.*)");
}

TEST(House, ReportIncludesNoRos) {
  expectIncludesMatch("report", R"([a-z_0-9]+|Eigen/.*|sightline/(core|report)/.*)");
}

TEST(House, FormatsIncludeNoRosAndTheLibrariesOfFilesAndTheSky) {
  expectIncludesMatch(
      "formats",
      R"([a-z_0-9]+|Eigen/.*|sightline/(core|report|formats)/.*|erfa\.h|tinyxml2\.h|yaml-cpp/yaml\.h)");
}

TEST(House, RoomsOfTheCoreIncludeOnlyRoomsOnFloorsBelow) {
  expectFloorsHold("core", kCoreFloors);
}

TEST(House, RoomsOfTheRosLayerIncludeOnlyRoomsOnFloorsBelow) {
  expectFloorsHold("ros", kRosFloors);
}

TEST(House, EveryHeaderAndSourceOfARoomStandInTheSameRoom) {
  for (const std::string layer : {"core", "report", "formats", "ros"}) {
    for (const fs::path& file : filesOf(layer)) {
      if (file.extension() != ".cpp") continue;
      const fs::path relative = fs::relative(file, kRoot / "src").replace_extension(".h");
      for (const std::string& include : includesOf(file)) {
        const bool is_own =
            fs::path(include).filename() == relative.filename() && include.rfind("sightline/", 0) == 0;
        if (is_own) {
          EXPECT_EQ(include, "sightline/" + relative.string()) << file;
        }
      }
    }
  }
}

TEST(House, CoreReadsNoClockAndHasNoThread) {
  const std::regex banned(
      R"(.*(system_clock|steady_clock|high_resolution_clock|std::random_device|std::thread|std::async|\btime\(nullptr\)|\bROS_[A-Z]+\().*)");
  for (const fs::path& file : filesOf("core")) {
    for (const std::string& line : linesOf(file)) {
      EXPECT_FALSE(std::regex_match(line, banned)) << file << ": " << line;
    }
  }
}

}  // namespace
