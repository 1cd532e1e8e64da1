#include "sightline/core/sensors/sensor_changes.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace sightline::core {
namespace {

SensorChange changeOf(const std::string& sensor, double t, SensorVerdict verdict = SensorVerdict::noisy) {
  SensorChange change;
  change.sensor = sensor;
  change.change.time = Time(durationOf(t));
  change.change.verdict = verdict;
  return change;
}

TEST(SensorChanges, EachIsReportedOnceThoughARollBackShowsItAgain) {
  SensorChangeReporter reporter;
  EXPECT_EQ(reporter.unreported({changeOf("a", 1.0)}).size(), 1u);
  EXPECT_TRUE(reporter.unreported({changeOf("a", 1.0)}).empty());
  const auto fresh = reporter.unreported({changeOf("a", 1.0), changeOf("b", 2.0)});
  ASSERT_EQ(fresh.size(), 1u);
  EXPECT_EQ(fresh[0].sensor, "b");
}

TEST(SensorChanges, OthersOfTheSameSensorAreReported) {
  SensorChangeReporter reporter;
  reporter.unreported({changeOf("a", 1.0)});
  EXPECT_EQ(reporter.unreported({changeOf("a", 2.0)}).size(), 1u);
  EXPECT_EQ(reporter.unreported({changeOf("a", 2.0, SensorVerdict::healthy)}).size(), 1u);
}

TEST(SensorChanges, TheLastOnesAreRememberedAndReportedOnceHoweverMany) {
  std::vector<SensorChange> changes;
  SensorChangeReporter reporter;
  for (int k = 0; k < 1000; ++k) {
    remember(changes, changeOf("a", k));
    ASSERT_LE(changes.size(), 64u);
    ASSERT_EQ(reporter.unreported(changes).size(), 1u) << k;
  }
  EXPECT_EQ(changes.back().change.time, Time(durationOf(999.0)));
}

}  // namespace
}  // namespace sightline::core
