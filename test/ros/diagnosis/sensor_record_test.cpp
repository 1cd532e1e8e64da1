#include "sightline/ros/diagnosis/sensor_record.h"

#include <cmath>
#include <functional>
#include <string>

#include <gtest/gtest.h>

#include "support/scans.h"

namespace {

namespace core = sightline::core;
using sightline::SightingArray;
using sightline_ros::Finding;
using sightline_ros::InputLimits;
using sightline_ros::SensorRecord;

using Change = std::function<void(int number, SightingArray& scan, double& latency)>;

constexpr double kRecordPeriod = 0.05, kRecordLatency = 0.02;  // [s]

/// A hundred scans of a sensor; `change` spoils it.
SensorRecord recordOf(const Change& change = [](int, SightingArray&, double&) {}) {
  SensorRecord record;
  for (int k = 0; k < 100; ++k) {
    const double time = 1000.0 + kRecordPeriod * k;
    SightingArray scan = scanOf("eye", time, {{0.1, 0.2}}, 2e-3);
    double latency = kRecordLatency;
    change(k, scan, latency);
    record.take(scan, core::Time(core::durationOf(time + latency)));
  }
  return record;
}

/// Everything that is found, a line each.
std::string wordsOf(const SensorRecord& record) {
  std::string words;
  for (const Finding& finding : record.findings("eye", InputLimits{}))
    words += (finding.is_note ? "note: " : "") + finding.words + "\n";
  return words;
}

TEST(SensorRecord, KnowsPaceDelayAndSigmaOfAHealthySensor) {
  const SensorRecord record = recordOf();
  EXPECT_EQ(wordsOf(record), "");
  EXPECT_EQ(record.scans(), 100u);
  EXPECT_EQ(record.sightings(), 100u);
  EXPECT_NEAR(record.interval(0.5).value(), kRecordPeriod, 1e-6);
  EXPECT_NEAR(record.latency(0.5).value(), kRecordLatency, 1e-6);
  EXPECT_NEAR(record.statedSigma().value(), 2e-3, 1e-9);
  EXPECT_EQ(record.frames(), std::set<std::string>{"platform_enu"});
}

TEST(SensorRecord, RefusedScansAreCountedByKindWithTheFirstInFull) {
  const std::string words = wordsOf(recordOf([](int k, SightingArray& scan, double&) {
    if (k % 2 == 0) scan.ifov = -1.0 - k;
  }));
  EXPECT_NE(words.find("50 of 100 scans: ifov is -1 rad"), std::string::npos) << words;
}

TEST(SensorRecord, SightingsThatCannotBeUsedAreCounted) {
  const SensorRecord record = recordOf([](int k, SightingArray& scan, double&) {
    if (k < 60) scan.sightings[0].azimuth = 400.0;
  });
  EXPECT_TRUE(record.isMostlyRefused());
  EXPECT_NE(wordsOf(record).find("60 of 100 sightings cannot be used"), std::string::npos) << wordsOf(record);
}

TEST(SensorRecord, StampsThatGoBackRepeatOrStopAreFound) {
  EXPECT_NE(wordsOf(recordOf([](int k, SightingArray& scan, double&) {
              if (k % 10 == 9) scan.header.stamp -= ros::Duration(2.0);
            })).find("stamped before the one that came before them"),
            std::string::npos);
  EXPECT_NE(wordsOf(recordOf([](int k, SightingArray& scan, double&) {
              scan.header.stamp = ros::Time(1000.0 + kRecordPeriod * (k / 2));
            })).find("repeat the stamp"),
            std::string::npos);
  EXPECT_NE(wordsOf(recordOf([](int k, SightingArray& scan, double&) {
              if (k >= 50) scan.header.stamp += ros::Duration(3.0);
            })).find("was silent for up to"),
            std::string::npos);
}

TEST(SensorRecord, ASensorThatSeesNothingIsANote) {
  const std::string words =
      wordsOf(recordOf([](int, SightingArray& scan, double&) { scan.sightings.clear(); }));
  EXPECT_EQ(words.find("note: saw nothing in 100 scans"), 0u) << words;
}

TEST(SensorRecord, LargeInnovationsAreFoundWhenThereAreEnough) {
  SensorRecord record = recordOf();
  for (int i = 0; i < 20; ++i) record.takeInnovation(20.0);
  EXPECT_EQ(wordsOf(record), "");
  for (int i = 0; i < 20; ++i) record.takeInnovation(20.0);
  EXPECT_NE(wordsOf(record).find("its covariance is too small, or it is misaligned"), std::string::npos);
}

}  // namespace
