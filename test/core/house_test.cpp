// The rules of the house that a machine can check.
#include <filesystem>
#include <fstream>
#include <regex>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace {

std::vector<std::filesystem::path> coreFiles() {
  const std::filesystem::path root = SIGHTLINE_SOURCE_DIR;
  std::vector<std::filesystem::path> files;
  for (const auto& folder : {root / "include/sightline/core", root / "src/core"}) {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
      if (entry.is_regular_file()) files.push_back(entry.path());
    }
  }
  return files;
}

std::vector<std::string> linesOf(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

TEST(House, CoreIncludesNothingButItselfEigenAndTheStandardLibrary) {
  const std::regex include(R"(^\s*#\s*include\s*[<"]([^>"]+)[>"].*)");
  // Standard headers have neither folder nor suffix.
  const std::regex allowed(R"([a-z_0-9]+|Eigen/.*|unsupported/Eigen/.*|sightline/core/.*)");
  const auto files = coreFiles();
  ASSERT_GE(files.size(), 8u);
  std::size_t includes = 0;
  for (const auto& file : files) {
    for (const std::string& line : linesOf(file)) {
      std::smatch found;
      if (!std::regex_match(line, found, include)) continue;
      ++includes;
      EXPECT_TRUE(std::regex_match(found[1].str(), allowed)) << file << ": " << line;
    }
  }
  EXPECT_GE(includes, files.size()) << "the pattern for includes finds too few of them";
}

TEST(House, CoreReadsNoClockAndHasNoThread) {
  const std::regex banned(
      R"(.*(system_clock|steady_clock|high_resolution_clock|std::random_device|std::thread|std::async|\btime\(nullptr\)|\bROS_[A-Z]+\().*)");
  for (const auto& file : coreFiles()) {
    for (const std::string& line : linesOf(file)) {
      EXPECT_FALSE(std::regex_match(line, banned)) << file << ": " << line;
    }
  }
}

}  // namespace
