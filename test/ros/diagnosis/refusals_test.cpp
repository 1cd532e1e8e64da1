#include "sightline/ros/diagnosis/refusals.h"

#include <map>
#include <string>

#include <gtest/gtest.h>

#include "support/times.h"

namespace {

namespace core = sightline::core;
using sightline::test::at;
using sightline_ros::Refusals;

std::map<std::string, std::string> valuesOf(const diagnostic_updater::DiagnosticStatusWrapper& status) {
  std::map<std::string, std::string> values;
  for (const auto& value : status.values) values[value.key] = value.value;
  return values;
}

TEST(Refusals, WarnOfEachKindAtMostOnceInFiveSecondsWithTheNumbersMeanwhile) {
  Refusals refusals;
  EXPECT_EQ(refusals.note({"late", "by 1 s"}, at(10.0)), "late (1 new, 1 in all): by 1 s");
  EXPECT_EQ(refusals.note({"late", "by 2 s"}, at(14.9)), std::nullopt);
  EXPECT_TRUE(refusals.note({"no frame", "is empty"}, at(14.9))) << "another kind";
  EXPECT_EQ(refusals.note({"late", "by 3 s"}, at(15.0)), "late (2 new, 3 in all): by 3 s");
}

TEST(Refusals, AClockThatGoesBackDoesNotSilenceTheWarnings) {
  Refusals refusals;
  refusals.note({"late", ""}, at(100.0));
  EXPECT_TRUE(refusals.note({"late", ""}, at(1.0)));
}

TEST(Refusals, DiagnosticsCountEachKindAndWarnOfNewOnesOnly) {
  Refusals refusals;
  refusals.note({"late", ""}, at(1.0));
  refusals.note({"late", ""}, at(1.1));
  diagnostic_updater::DiagnosticStatusWrapper first, second;
  first.summary(diagnostic_msgs::DiagnosticStatus::OK, "looking");
  refusals.diagnose(first);
  EXPECT_EQ(first.level, diagnostic_msgs::DiagnosticStatus::WARN);
  EXPECT_EQ(first.message, "refused, late: 2 new");
  EXPECT_EQ(valuesOf(first).at("refused, late"), "2");
  second.summary(diagnostic_msgs::DiagnosticStatus::OK, "looking");
  refusals.diagnose(second);
  EXPECT_EQ(second.level, diagnostic_msgs::DiagnosticStatus::OK);
  EXPECT_EQ(valuesOf(second).at("refused, late"), "2");
}

}  // namespace
