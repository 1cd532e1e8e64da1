#include "sightline/ros/diagnosis/callback_guard.h"

#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <diagnostic_msgs/DiagnosticStatus.h>

namespace {

using diagnostic_msgs::DiagnosticStatus;
using sightline_ros::CallbackGuard;

std::string valueOf(const diagnostic_updater::DiagnosticStatusWrapper& status, const std::string& key) {
  for (const auto& value : status.values) {
    if (value.key == key) return value.value;
  }
  return "(absent)";
}

TEST(CallbackGuard, WhatDoesNotThrowGoesThroughUntouched) {
  CallbackGuard guard("node");
  std::vector<int> seen;
  const auto callback = guard("/topic", [&seen](int value) { seen.push_back(value); });
  callback(1);
  callback(2);
  EXPECT_EQ(seen, (std::vector<int>{1, 2}));
  diagnostic_updater::DiagnosticStatusWrapper status;
  guard.diagnose(status);
  EXPECT_TRUE(status.values.empty());
  EXPECT_EQ(status.level, DiagnosticStatus::OK);
}

TEST(CallbackGuard, WhatThrowsIsCountedByItsTopicAndSaidInTheDiagnosticsOnce) {
  CallbackGuard guard("node");
  const auto bad = guard("/bad", [](int) { throw std::runtime_error("a cost is NaN"); });
  const auto odd = guard("a timer", [] { throw 7; });
  EXPECT_NO_THROW(bad(1));
  EXPECT_NO_THROW(bad(2));
  EXPECT_NO_THROW(odd());
  diagnostic_updater::DiagnosticStatusWrapper status;
  guard.diagnose(status);
  EXPECT_EQ(valueOf(status, "failed, /bad"), "2, the last: a cost is NaN");
  EXPECT_EQ(valueOf(status, "failed, a timer"), "1, the last: an exception of an unknown kind");
  EXPECT_EQ(status.level, DiagnosticStatus::ERROR);
  EXPECT_NE(status.message.find("2 messages of /bad failed"), std::string::npos) << status.message;

  diagnostic_updater::DiagnosticStatusWrapper calm;
  guard.diagnose(calm);
  EXPECT_EQ(calm.level, DiagnosticStatus::OK) << calm.message;
  EXPECT_EQ(valueOf(calm, "failed, /bad"), "2, the last: a cost is NaN");
}

}  // namespace
