#include "sightline/core/ordering/arrival_survey.h"

#include <random>

#include <gtest/gtest.h>

#include "support/times.h"

using namespace sightline::core;
using sightline::test::at;

namespace {

constexpr double kMost = 60.0;  // [s]

/// A scan every tenth of a second; `latency` of a sensor at a time.
template <typename Latency>
ArrivalPlan planOf(const std::vector<std::string>& sensors, const Latency& latency, int scans = 200) {
  ArrivalSurvey survey(kMost);
  for (int k = 0; k < scans; ++k) {
    for (const std::string& sensor : sensors) {
      const double stamp = 1000.0 + 0.1 * k;
      survey.take(sensor, at(stamp), at(stamp + latency(sensor, k)));
    }
  }
  return survey.plan();
}

TEST(ArrivalSurvey, ASensorThatIsLaterThanTheOthersHasThatDelay) {
  const ArrivalPlan plan = planOf(
      {"a", "b", "slow"}, [](const std::string& sensor, int) { return sensor == "slow" ? 0.75 : 0.05; });
  EXPECT_NEAR(plan.delayOf("slow"), 0.7, 1e-9);
  EXPECT_NEAR(plan.delayOf("a"), 0.0, 1e-9);
  EXPECT_NEAR(plan.longestDelay(), 0.7, 1e-9);
  EXPECT_NEAR(plan.jitter, 0.0, 1e-9);
  EXPECT_EQ(plan.ahead, 0.0);
}

TEST(ArrivalSurvey, OfTwoSensorsTheLaterOneIsLate) {
  const ArrivalPlan plan =
      planOf({"a", "b"}, [](const std::string& sensor, int) { return sensor == "a" ? 2.0 : 0.0; });
  EXPECT_NEAR(plan.delayOf("a"), 2.0, 1e-9);
  EXPECT_NEAR(plan.delayOf("b"), 0.0, 1e-9);
}

TEST(ArrivalSurvey, ASensorThatComesWhenTheOthersHaveEndedIsLateByThatMuch) {
  for (const int late : {1, 2}) {  // of three
    ArrivalSurvey survey(kMost);
    for (const bool now : {false, true}) {
      for (int k = 0; k < 100; ++k) {
        for (int sensor = 0; sensor < 3; ++sensor) {
          if ((sensor < late) != now) continue;
          survey.take(std::string(1, static_cast<char>('a' + sensor)), at(1000.0 + 0.1 * k),
                      at(1000.0 + 0.1 * k + (now ? 40.0 : 0.0)));
        }
      }
    }
    EXPECT_NEAR(survey.plan().delayOf("a") - survey.plan().delayOf("c"), 40.0, 1e-9) << late;
  }
}

TEST(ArrivalSurvey, AClockThatIsAnHourOffIsNoDelay) {
  const ArrivalPlan plan = planOf(
      {"a", "b", "third"}, [](const std::string& sensor, int) { return sensor == "third" ? -3600.0 : 0.0; });
  EXPECT_EQ(plan.delays.count("third"), 0u);
  EXPECT_EQ(plan.delayOf("third"), 0.0);
  EXPECT_EQ(plan.longestDelay(), 0.0);
}

TEST(ArrivalSurvey, ARecordingThatStartsAgainOrPlaysFasterIsNoDelay) {
  const ArrivalPlan loop = planOf({"a", "b"}, [](const std::string&, int k) { return k < 99 ? 1.0 : 11.0; });
  EXPECT_NEAR(loop.longestDelay(), 0.0, 1e-9);
  EXPECT_NEAR(loop.jitter, 0.0, 1e-9);
  const ArrivalPlan fast = planOf({"a", "b"}, [](const std::string&, int k) { return -0.05 * k; });
  EXPECT_NEAR(fast.longestDelay(), 0.0, 0.051);
  EXPECT_GE(fast.ahead, 9.8) << "stamps run ahead of a recorder that does not follow their time";
}

TEST(ArrivalSurvey, JitterIsTheUsualChangeOfALatency) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> latency(0.0, 3.0);
  const ArrivalPlan plan = planOf(
      {"a", "b"}, [&](const std::string& sensor, int) { return sensor == "a" ? latency(random) : 0.01; });
  EXPECT_GT(1.5 * plan.jitter, 3.0);
  EXPECT_LT(plan.jitter, 3.0);
}

TEST(ArrivalSurvey, OneStampFarAheadDoesNotMakeThatUsual) {
  const ArrivalPlan plan = planOf(
      {"a"}, [](const std::string&, int k) { return k == 4 ? -1e9 : 0.0; }, 10);
  EXPECT_EQ(plan.ahead, 0.0);
}

TEST(ArrivalSurvey, ManyScansAreSurveyedInBoundedMemoryWithTheSameResult) {
  const ArrivalPlan plan = planOf(
      {"a", "b"}, [](const std::string& sensor, int) { return sensor == "b" ? 0.3 : 0.0; }, 20000);
  EXPECT_NEAR(plan.delayOf("b"), 0.3, 1e-6);
}

}  // namespace
