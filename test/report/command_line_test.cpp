#include "sightline/report/command_line.h"

#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace {

using sightline_ros::CommandLine;
using sightline_ros::runTool;
using sightline_ros::UsageError;

using Words = std::vector<std::string>;

const Words kOptions = {"--config", "--topic"};

TEST(CommandLine, OptionsStandAnywhereWithOrWithoutEqualsSign) {
  const CommandLine line({"in.bag", "--config", "a.yaml", "--topic=/b", "out.bag"}, kOptions, 2, 2);
  EXPECT_EQ(line.arguments(), (Words{"in.bag", "out.bag"}));
  EXPECT_EQ(line.option("--config", ""), "a.yaml");
  EXPECT_EQ(line.option("--topic", ""), "/b");
}

TEST(CommandLine, AbsentOptionFallsBackAndRepeatedOnesAreAllKept) {
  const CommandLine line({"--topic", "/a", "--topic", "/b"}, kOptions, 0, 0);
  EXPECT_EQ(line.option("--config", "default"), "default");
  EXPECT_FALSE(line.has("--config"));
  EXPECT_EQ(line.all("--topic"), (Words{"/a", "/b"}));
  EXPECT_TRUE(line.all("--config").empty());
}

TEST(CommandLine, ValueMayBeANegativeNumber) {
  EXPECT_EQ(CommandLine({"--config", "-5"}, kOptions, 0, 0).option("--config", ""), "-5");
}

TEST(CommandLine, WhatCannotBeUnderstoodIsRefused) {
  EXPECT_THROW(CommandLine({"--unknown", "x"}, kOptions, 0, 9), UsageError);
  EXPECT_THROW(CommandLine({"--config"}, kOptions, 0, 9), UsageError);
  EXPECT_THROW(CommandLine({"one"}, kOptions, 2, 2), UsageError);
  EXPECT_THROW(CommandLine({"one", "two", "three"}, kOptions, 2, 2), UsageError);
}

int exitCodeOf(const std::string& argument, const std::function<void(const Words&)>& tool) {
  std::string program = "/somewhere/tool";
  std::string copy = argument;
  char* argv[] = {program.data(), copy.data()};
  return runTool(2, argv, "Usage: tool\n", tool);
}

TEST(CommandLine, ExitCodesTellHelpSuccessUsageAndFailureApart) {
  const auto fine = [](const Words&) {};
  const auto misused = [](const Words&) { throw UsageError("no"); };
  const auto failing = [](const Words&) { throw std::runtime_error("broken"); };
  EXPECT_EQ(exitCodeOf("--help", misused), 0);
  EXPECT_EQ(exitCodeOf("x", fine), 0);
  EXPECT_EQ(exitCodeOf("x", misused), 2);
  testing::internal::CaptureStderr();
  EXPECT_EQ(exitCodeOf("x", failing), 1);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "tool: broken\n");
}

}  // namespace
