#include "sightline/core/estimators/estimators.h"

#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "support/paths.h"

namespace sightline::core {
namespace {

namespace fs = std::filesystem;

const fs::path kRoot = test::sourceDirectory();

TEST(Estimators, TableIsInTheOrderOfTheKinds) {
  for (std::size_t i = 0; i < estimatorTable().size(); ++i)
    EXPECT_EQ(static_cast<std::size_t>(estimatorTable()[i].kind), i) << estimatorTable()[i].name;
}

TEST(Estimators, NamesAndDescriptionsAreThereAndDiffer) {
  std::set<std::string> names, descriptions;
  for (const EstimatorEntry& entry : estimatorTable()) {
    EXPECT_NE(std::string(entry.name), "");
    EXPECT_NE(std::string(entry.description), "");
    names.insert(entry.name);
    descriptions.insert(entry.description);
  }
  EXPECT_EQ(names.size(), estimatorTable().size());
  EXPECT_EQ(descriptions.size(), estimatorTable().size());
}

TEST(Estimators, EveryKindIsMadeAndKnownByItsName) {
  for (const EstimatorEntry& entry : estimatorTable()) {
    EstimatorParams params;
    params.kind = entry.kind;
    const auto estimator = makeEstimator(params);
    ASSERT_TRUE(estimator) << entry.name;
    EXPECT_FALSE(estimator->stateAt(Time{})) << entry.name;
    EXPECT_EQ(estimatorName(entry.kind), entry.name);
    EXPECT_TRUE(isEstimatorName(entry.name));
  }
}

TEST(Estimators, FormChoosesTheClass) {
  EstimatorParams params;
  params.twbls_form = params.noga_form = EstimatorForm::paper;
  params.kind = EstimatorKind::twbls;
  EXPECT_TRUE(dynamic_cast<TwblsEstimator*>(makeEstimator(params).get()));
  params.kind = EstimatorKind::noga;
  EXPECT_TRUE(dynamic_cast<NogaEstimator*>(makeEstimator(params).get()));
  params.noga_form = EstimatorForm::consistent;
  EXPECT_TRUE(dynamic_cast<NogaConsistentEstimator*>(makeEstimator(params).get()));
}

TEST(Estimators, FusionRulesAndUnknownKindsAreNoEstimators) {
  for (const char* name : {"weighted_covariance", "covariance_intersection", "tracklets", "", "TWBLS"})
    EXPECT_FALSE(isEstimatorName(name)) << name;
  EXPECT_THROW(estimatorName(static_cast<EstimatorKind>(estimatorTable().size())), std::invalid_argument);
}

std::vector<std::string> linesOf(const fs::path& file) {
  std::ifstream stream(file);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// That each line of the file which introduces the parameter names every estimator; returns their number.
int expectEveryNameIn(const fs::path& file, const std::regex& introduces) {
  int found = 0;
  for (const std::string& line : linesOf(file)) {
    if (!std::regex_search(line, introduces)) continue;
    ++found;
    for (const std::string& name : estimatorNames()) {
      // Not the default alone: the names after "doc=" or the comment sign.
      const std::string text =
          line.substr(line.find_first_of("#") == std::string::npos ? line.find("doc=") : line.find('#'));
      EXPECT_TRUE(std::regex_search(text, std::regex("\\b" + name + "\\b")))
          << file << " does not name " << name << ": " << line;
    }
  }
  return found;
}

TEST(Estimators, LaunchFilesNameEveryOne) {
  const std::regex argument("<arg name=\"estimator\".*doc=");
  int found = 0;
  for (const auto& entry : fs::directory_iterator(kRoot / "launch"))
    if (entry.path().extension() == ".launch") found += expectEveryNameIn(entry.path(), argument);
  EXPECT_GE(found, 6);
}

TEST(Estimators, ConfigurationsNameEveryOneAndItsSection) {
  const std::regex key("^estimator: .*#");
  for (const char* name : {"local_tracker.yaml", "track_fusion.yaml"})
    EXPECT_EQ(expectEveryNameIn(kRoot / "config" / name, key), 1) << name;
  const std::vector<std::string> lines = linesOf(kRoot / "config/local_tracker.yaml");
  for (const std::string& name : estimatorNames()) {
    int sections = 0;
    for (const std::string& line : lines) sections += line.rfind(name + ":", 0) == 0 ? 1 : 0;
    EXPECT_EQ(sections, 1) << name;
  }
}

}  // namespace
}  // namespace sightline::core
