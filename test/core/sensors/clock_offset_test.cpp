#include "sightline/core/sensors/clock_offset.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "sightline/core/tracking/local_tracker.h"

namespace sightline::core {
namespace {

constexpr double kSigma = 8e-4;  // of every sensor [rad]
using Path = std::function<Eigen::Vector2d(double)>;

const Path kSine = [](double t) { return Eigen::Vector2d(0.01 * std::sin(t), 0.01 * std::cos(t)); };
const Path kStill = [](double) { return Eigen::Vector2d(0.3, 0.2); };
const Path kStraight = [](double t) { return Eigen::Vector2d(0.01 * t, 0.1 - 0.005 * t); };

Time at(double t) {
  return Time(std::chrono::seconds(1000) + durationOf(t));
}

/// Sensors of 33 Hz; `behind`: of their clocks [s], one for each; `bias` of the first [sigma].
std::vector<Scan> scansOf(const Path& path, const std::vector<double>& behind, double duration, unsigned seed,
                          double bias = 0.0) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::vector<Scan> scans;
  for (std::size_t sensor = 0; sensor < behind.size(); ++sensor) {
    std::uniform_real_distribution<double> phase(0.0, 0.03);
    for (double t = phase(random); t < duration; t += 0.03) {
      const Eigen::Vector2d noise(normal(random) + (sensor == 0 ? bias : 0.0), normal(random));
      Scan scan;
      scan.time = at(t - behind[sensor]);
      scan.sensor = "camera_" + std::to_string(sensor);
      scan.sightings = {sightingOf(path(t) + kSigma * noise, kSigma * kSigma * Eigen::Matrix2d::Identity())};
      scans.push_back(scan);
    }
  }
  std::sort(scans.begin(), scans.end(), [](const Scan& a, const Scan& b) { return precedes(a, b); });
  return scans;
}

std::vector<WatchedSensor> watchedAfter(const std::vector<Scan>& scans,
                                        EstimatorKind kind = EstimatorKind::noga) {
  LocalTrackerParams params;
  params.estimator.kind = kind;
  LocalTracker tracker(params);
  for (const Scan& scan : scans) tracker.onScan(scan);
  return tracker.sensors();
}

class Clock : public testing::TestWithParam<EstimatorKind> {};

TEST_P(Clock, AnOffsetIsFoundWithinItsErrorBarsAndOnlyThere) {
  for (const double behind : {0.06, -0.03}) {
    double normalised = 0.0;
    const int runs = 12;
    for (unsigned seed = 1; seed <= runs; ++seed) {
      const auto sensors = watchedAfter(scansOf(kSine, {0.0, behind, 0.0, 0.0}, 30.0, seed), GetParam());
      ASSERT_EQ(sensors.size(), 4u);
      ASSERT_TRUE(sensors[1].clock) << "seed " << seed;
      EXPECT_FALSE(sensors[1].clock_undecided);
      EXPECT_LT(sensors[1].clock->sigma, 0.01);
      const double error = (sensors[1].clock->behind - behind) / sensors[1].clock->sigma;
      EXPECT_LT(std::abs(error), 5.0) << sensors[1].clock->behind << " +- " << sensors[1].clock->sigma;
      normalised += error * error / runs;
      for (const std::size_t other : {0u, 2u, 3u}) EXPECT_FALSE(sensors[other].clock);
    }
    EXPECT_LT(normalised, 3.0);  // chi^2 of 12 runs over 12 is below 2.2 in 99 % where the bars are exact
  }
}

TEST_P(Clock, NoneIsClaimedWhereThereIsNone) {
  int claims = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    for (const WatchedSensor& sensor : watchedAfter(scansOf(kSine, {0.0, 0.0, 0.0}, 30.0, seed), GetParam()))
      claims += sensor.clock ? 1 : 0;
  }
  EXPECT_EQ(claims, 0);  // of 60; five standard errors
}

INSTANTIATE_TEST_SUITE_P(Estimators, Clock, testing::Values(EstimatorKind::twbls, EstimatorKind::noga),
                         [](const auto& parameters) {
                           return parameters.param == EstimatorKind::noga ? "noga" : "twbls";
                         });

TEST(ClockOffset, ATargetThatStandsStillOrFliesStraightSaysNothing) {
  for (const Path& path : {kStill, kStraight}) {
    for (const WatchedSensor& sensor : watchedAfter(scansOf(path, {0.0, 0.1, 0.0}, 20.0, 3)))
      EXPECT_FALSE(sensor.clock);
  }
}

TEST(ClockOffset, AMisalignedSensorIsNotTakenForOneWithAWrongClock) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    for (const WatchedSensor& sensor : watchedAfter(scansOf(kSine, {0.0, 0.0, 0.0}, 20.0, seed, 0.5)))
      EXPECT_FALSE(sensor.clock);
  }
}

TEST(ClockOffset, OfTwoClocksThatDifferBothAreNamed) {
  const auto sensors = watchedAfter(scansOf(kSine, {0.0, 0.06}, 30.0, 1));
  ASSERT_EQ(sensors.size(), 2u);
  for (const WatchedSensor& sensor : sensors) {
    ASSERT_TRUE(sensor.clock);
    EXPECT_TRUE(sensor.clock_undecided);
  }
  EXPECT_EQ(sensors[0].clock->behind, -sensors[1].clock->behind);
  EXPECT_NEAR(sensors[1].clock->behind, 0.06, 5.0 * sensors[1].clock->sigma);
}

TEST(ClockOffset, OfTwoClocksThatDifferNothingChangesToTheLastBit) {
  LocalTrackerParams params, unguarded;
  unguarded.guard.enabled = false;
  LocalTracker with(params), without(unguarded);
  bool is_said = false;
  for (const Scan& scan : scansOf(kSine, {0.0, 0.06}, 30.0, 1)) {
    const ScanReport a = with.onScan(scan), b = without.onScan(scan);
    ASSERT_EQ(a.tracks.size(), b.tracks.size());
    for (std::size_t i = 0; i < a.tracks.size(); ++i) {
      ASSERT_EQ(a.tracks[i].state.mean, b.tracks[i].state.mean);
      ASSERT_EQ(a.tracks[i].state.covariance, b.tracks[i].state.covariance);
    }
    is_said = is_said || (!with.sensors().empty() && with.sensors()[0].clock);
  }
  EXPECT_TRUE(is_said);
}

TEST(ClockOffset, TheOrderOfArrivalChangesNothing) {
  std::vector<Scan> scans = scansOf(kSine, {0.0, 0.06, 0.0}, 20.0, 2), shuffled = scans;
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> latency(0.0, 0.4);
  std::vector<std::pair<double, std::size_t>> arrivals;
  for (std::size_t k = 0; k < scans.size(); ++k)
    arrivals.emplace_back(seconds(scans[k].time - at(0.0)) + latency(random), k);
  std::sort(arrivals.begin(), arrivals.end());
  for (std::size_t k = 0; k < scans.size(); ++k) shuffled[k] = scans[arrivals[k].second];
  const auto a = watchedAfter(scans), b = watchedAfter(shuffled);
  ASSERT_TRUE(a.at(1).clock && b.at(1).clock);
  EXPECT_EQ(a[1].clock->behind, b[1].clock->behind);
  EXPECT_EQ(a[1].clock->sigma, b[1].clock->sigma);
}

TEST(WrongClocks, TheOneThatIsOffIsNamedAndNotTheOthersAgainstIt) {
  const std::vector<std::optional<ClockOffset>> against = {
      ClockOffset{-0.02, 0.001}, ClockOffset{0.08, 0.002}, std::nullopt, ClockOffset{-0.021, 0.001}};
  const auto findings = wrongClocks(against, ClockOffsetParams{});
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].sensor, 1u);
  EXPECT_NEAR(findings[0].offset.behind, 0.1005, 1e-12);
  EXPECT_NEAR(findings[0].offset.sigma, std::sqrt(4e-6 + 0.5e-6), 1e-12);
}

TEST(WrongClocks, SmallOrUncertainDifferencesAreNone) {
  EXPECT_TRUE(
      wrongClocks({ClockOffset{0.0, 1e-4}, ClockOffset{0.001, 1e-4}, ClockOffset{0.0, 1e-4}}, {}).empty());
  EXPECT_TRUE(
      wrongClocks({ClockOffset{0.0, 0.05}, ClockOffset{0.1, 0.05}, ClockOffset{0.0, 0.05}}, {}).empty());
  EXPECT_TRUE(wrongClocks({ClockOffset{0.3, 0.001}, std::nullopt}, {}).empty());
}

}  // namespace
}  // namespace sightline::core
