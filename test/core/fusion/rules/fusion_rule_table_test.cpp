#include "sightline/core/fusion/rules/fusion_rule_table.h"

#include <fstream>
#include <iterator>
#include <set>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "support/paths.h"

namespace sightline::core {
namespace {

std::string contentOf(const std::string& file) {
  std::ifstream stream(sightline::test::sourceDirectory() + "/" + file);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

TEST(FusionRuleTable, EachRuleStandsInItOnceInTheOrderOfTheEnum) {
  std::set<std::string> names;
  for (std::size_t i = 0; i < fusionRuleTable().size(); ++i) {
    const FusionRuleEntry& entry = fusionRuleTable()[i];
    EXPECT_EQ(static_cast<std::size_t>(entry.rule), i);
    EXPECT_TRUE(names.insert(entry.name).second) << entry.name;
    EXPECT_EQ(nameOf(entry.rule), entry.name);
    EXPECT_NE(std::string(entry.description), "");
  }
}

TEST(FusionRuleTable, ARuleThatIsNotInItHasNoName) {
  EXPECT_THROW(nameOf(static_cast<FusionRule>(99)), std::invalid_argument);
}

TEST(FusionRuleTable, TheTextsThatListRulesNameAllOfThem) {
  for (const char* file : {"config/track_fusion.yaml", "doc/fusion.md", "launch/replay.launch",
                           "launch/six_sensors.launch", "launch/track_fusion.launch"}) {
    const std::string content = contentOf(file);
    ASSERT_FALSE(content.empty()) << file;
    for (const FusionRuleEntry& entry : fusionRuleTable())
      EXPECT_NE(content.find(entry.name), std::string::npos) << file << " does not name " << entry.name;
  }
}

}  // namespace
}  // namespace sightline::core
