#include "sightline/formats/import_command.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "format_files.h"

namespace {

using namespace sightline::test;
using namespace sightline::formats;
using sightline::report::CommandLine;

TEST(ImportCommand, OptionsAreReadWithTheirUnits) {
  const CommandLine line(
      {"--sigma", "3deg,20deg", "--station", "A=48,11,500", "--heading=90deg", "--separator", "tab",
       "--decimal", "comma", "--image-size", "640x480", "--offset", "1.5"},
      importOptionNames(), 0, 0);
  const ImportOptions options = importOptionsOf(line);
  EXPECT_NEAR(options.sigma->y(), 20.0 * kDegree, 1e-12);
  EXPECT_NEAR(options.stations.at("A").longitude, 11.0 * kDegree, 1e-12);
  EXPECT_NEAR(*options.heading, 90.0 * kDegree, 1e-12);
  EXPECT_EQ(options.separator, '\t');
  EXPECT_TRUE(*options.decimal_comma);
  EXPECT_EQ(*options.image_size, Eigen::Vector2d(640.0, 480.0));
  EXPECT_EQ(options.offset.count(), 1500000000);
  const CommandLine pixels({"--sigma", "1.5px"}, importOptionNames(), 0, 0);
  EXPECT_EQ(*importOptionsOf(pixels).sigma_pixels, 1.5);
}

TEST(ImportCommand, MistakesNameTheOptionItsValueAndAnExample) {
  const std::vector<std::vector<std::string>> mistakes{
      {"--sigma", "0.05"},        {"--sigma", "-1deg"},    {"--station", "48,11"},
      {"--station", "A=98,11,0"}, {"--heading", "north"},  {"--separator", "xx"},
      {"--decimal", "dot"},       {"--image-size", "640"}, {"--field-of-view", "200deg"},
      {"--frame-rate", "0"},      {"--ut1-utc", "37"},     {"--elevation", "0"}};
  for (const auto& words : mistakes) {
    const std::string why = refusal([&] { importOptionsOf(CommandLine(words, importOptionNames(), 0, 0)); });
    EXPECT_TRUE(contains(why, words[0]) && contains(why, words[1]))
        << words[0] << " " << words[1] << ": " << why;
  }
}

TEST(ImportCommand, TheUsageNamesEveryOption) {
  for (const std::string& option : importOptionNames())
    EXPECT_TRUE(contains(importOptionUsage(), option)) << option;
}

}  // namespace
