#include "sightline/report/sensor_text.h"

#include <string>

#include <gtest/gtest.h>

using namespace sightline::report;
namespace core = sightline::core;

namespace {

core::HealthChange change(core::SensorVerdict verdict) {
  core::HealthChange result;
  result.time = core::timeOf(12'500'000'000);
  result.began = core::timeOf(12'000'000'000);
  result.verdict = verdict;
  result.scale = 9.0;
  result.bias = Eigen::Array2d(1.5, -2.0);
  return result;
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(SensorText, AChangeNamesSensorVerdictSizeTimesAndConsequence) {
  const std::string noisy = textOf(core::SensorChange{"eye", change(core::SensorVerdict::noisy), false});
  EXPECT_TRUE(contains(noisy, "sensor \"eye\"")) << noisy;
  EXPECT_TRUE(contains(noisy, "3 times its stated sigma")) << noisy;
  EXPECT_TRUE(contains(noisy, "since 12.000")) << noisy;
  EXPECT_TRUE(contains(noisy, "12.500")) << noisy;
  EXPECT_TRUE(contains(noisy, "used with that noise")) << noisy;
  const std::string biased = textOf(core::SensorChange{"eye", change(core::SensorVerdict::biased), false});
  EXPECT_TRUE(contains(biased, "(1.5, -2) sigma")) << biased;
  EXPECT_TRUE(contains(biased, "not used")) << biased;
}

TEST(SensorText, OfTwoSensorsNothingIsDone) {
  const std::string text = textOf(core::SensorChange{"eye", change(core::SensorVerdict::biased), true});
  EXPECT_TRUE(contains(text, "nothing is done")) << text;
}

TEST(SensorText, AWatchedSensorIsHealthyUntilAndAfterAVerdict) {
  core::WatchedSensor sensor;
  EXPECT_EQ(textOf(sensor), "healthy");
  sensor.last = change(core::SensorVerdict::healthy);
  EXPECT_EQ(textOf(sensor), "healthy, recovered at 12.500");
  sensor.verdict = core::SensorVerdict::noisy;
  sensor.noise_scale = 4.0;
  sensor.last = change(core::SensorVerdict::noisy);
  EXPECT_TRUE(contains(textOf(sensor), "now 2 times")) << textOf(sensor);
}

TEST(SensorText, AClockIsBehindOrAhead) {
  core::WatchedSensor sensor;
  sensor.sensor = "eye";
  EXPECT_EQ(clockTextOf(sensor), "");
  sensor.clock = core::ClockOffset{0.05, 0.001};
  EXPECT_TRUE(contains(clockTextOf(sensor), "clock of eye is 0.05 +- 0.001 s behind")) << clockTextOf(sensor);
  sensor.clock->behind = -0.05;
  EXPECT_TRUE(contains(clockTextOf(sensor), "0.05 +- 0.001 s ahead of")) << clockTextOf(sensor);
}

TEST(SensorText, CalibrationsAreGivenWithTheirSupport) {
  core::CalibratedSensor noise;
  noise.scale = 0.25;
  noise.sightings = 300.0;
  EXPECT_EQ(textOf(noise), "0.5 times the stated sigma (from 300 sightings)");
  core::CalibratedDetection detection;
  detection.scans = 10.0;
  detection.clutter = 51.0;
  EXPECT_EQ(textOf(detection), "5.1 false sightings a scan");  // too few targets for their share
  detection.looked = 100.0;
  detection.seen = 83.0;
  EXPECT_EQ(textOf(detection), "83 % of settled targets seen, 5.1 false sightings a scan");
}

}  // namespace
