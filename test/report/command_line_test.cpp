#include "sightline/report/command_line.h"

#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "support/complaint.h"

namespace {

using sightline::report::CommandLine;
using sightline::report::NumberRange;
using sightline::report::runTool;
using sightline::report::UsageError;
using sightline::test::complaintOf;

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

TEST(CommandLine, FlagsTakeNoValue) {
  const CommandLine line({"--fast", "in.bag"}, kOptions, 1, 1, {"--fast", "--slow"});
  EXPECT_TRUE(line.has("--fast"));
  EXPECT_FALSE(line.has("--slow"));
  EXPECT_EQ(line.arguments(), (Words{"in.bag"}));
  EXPECT_THROW(CommandLine({"--fast=yes"}, kOptions, 0, 0, {"--fast"}), UsageError);
}

TEST(CommandLine, NumbersAreOfTheirRangeOrRefusedWithValueAndRemedy) {
  const auto line = [](const std::string& value) { return CommandLine({"--topic", value}, kOptions, 0, 0); };
  EXPECT_EQ(line("-2.5e1").number("--topic", 7.0), -25.0);
  EXPECT_EQ(line("1").number("--config", 7.0), 7.0);
  EXPECT_EQ(line("0").number("--topic", 7.0, NumberRange::at_least_zero), 0.0);
  EXPECT_EQ(complaintOf<UsageError>([&] { line("0").number("--topic", 7.0, NumberRange::above_zero); }),
            "--topic: expected a number above 0, got \"0\" (write for instance --topic 1)");
  EXPECT_EQ(complaintOf<UsageError>([&] { line("-1").number("--topic", 7.0, NumberRange::at_least_zero); }),
            "--topic: expected a number of at least 0, got \"-1\" (write for instance --topic 1)");
  for (const char* text : {"", "1 s", "nan", "inf", "one"})
    EXPECT_NE(complaintOf<UsageError>([&] { line(text).number("--topic", 7.0); }), "") << text;
}

TEST(CommandLine, WholeNumbersHaveNoFraction) {
  const auto line = [](const std::string& value) { return CommandLine({"--topic", value}, kOptions, 0, 0); };
  EXPECT_EQ(line("17").wholeNumber("--topic", 3), 17);
  EXPECT_EQ(line("17").wholeNumber("--config", 3), 3);
  for (const char* text : {"1.5", "-1", "3e9", "x"})
    EXPECT_NE(complaintOf<UsageError>([&] { line(text).wholeNumber("--topic", 3); }), "") << text;
}

TEST(CommandLine, YesAndNoAreTheOnlyAnswers) {
  const auto line = [](const std::string& value) { return CommandLine({"--topic", value}, kOptions, 0, 0); };
  EXPECT_TRUE(line("yes").yesOrNo("--topic", false));
  EXPECT_FALSE(line("no").yesOrNo("--topic", true));
  EXPECT_TRUE(line("no").yesOrNo("--config", true));
  EXPECT_EQ(complaintOf<UsageError>([&] { line("maybe").yesOrNo("--topic", true); }),
            "--topic: expected yes or no, got \"maybe\" (write for instance --topic yes)");
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
