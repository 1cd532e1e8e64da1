#include "sightline/core/sensors/sensor_guard.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "sightline/core/tracking/local_tracker.h"

namespace sightline::core {
namespace {

constexpr double kSigma = 8e-4;     // of every sensor [rad]
constexpr double kInterval = 0.03;  // of every sensor [s]
constexpr double kChange = 4.0;     // when the last sensor degrades [s]

struct Trouble {
  double noise = 1.0;      // factor on the sigma of the last sensor, from kChange on
  double bias = 0.0;       // in its azimuth [sigma]
  double until = 1e9;      // [s]
  double manoeuvre = 0.0;  // azimuth acceleration of the target in [kChange, kChange + 1) [rad/s^2]
};

Time at(double t) {
  return Time(std::chrono::seconds(1000) + durationOf(t));
}

Eigen::Vector2d targetAt(double t, double manoeuvre) {
  const double turned = std::clamp(t - kChange, 0.0, 1.0), after = std::max(0.0, t - kChange - 1.0);
  return {0.01 * std::sin(t) + manoeuvre * (0.5 * turned * turned + after), 0.01 * std::cos(t)};
}

/// Scans of several sensors that see one target, in order of time.
std::vector<Scan> scansOf(int sensors, double duration, const Trouble& trouble, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::vector<Scan> scans;
  for (int k = 0; kInterval * k < duration; ++k) {
    for (int sensor = 0; sensor < sensors; ++sensor) {
      const double t = kInterval * (k + static_cast<double>(sensor) / sensors);
      const bool is_bad = sensor == sensors - 1 && t >= kChange && t < trouble.until;
      const double sigma = kSigma * (is_bad ? trouble.noise : 1.0);
      Eigen::Vector2d angles = targetAt(t, trouble.manoeuvre);
      angles += sigma * Eigen::Vector2d(normal(random), normal(random));
      if (is_bad) angles.x() += trouble.bias * kSigma;
      Scan scan;
      scan.time = at(t);
      scan.sensor = "sensor_" + std::to_string(sensor);
      scan.sightings = {sightingOf(angles, kSigma * kSigma * Eigen::Matrix2d::Identity())};
      scans.push_back(scan);
    }
  }
  return scans;
}

struct Outcome {
  std::vector<ScanReport> reports;
  std::vector<SensorChange> changes;
};

Outcome track(LocalTracker& tracker, const std::vector<Scan>& scans) {
  Outcome outcome;
  for (const Scan& scan : scans) {
    outcome.reports.push_back(tracker.onScan(scan));
    for (const SensorChange& change : outcome.reports.back().changes) outcome.changes.push_back(change);
  }
  return outcome;
}

LocalTrackerParams paramsWith(bool enabled, EstimatorKind kind = EstimatorKind::twbls) {
  LocalTrackerParams params;
  params.noise_calibration.enabled = false;  // what is found must be the guard's
  params.guard.enabled = enabled;
  params.estimator.kind = kind;
  return params;
}

void expectSameTracks(const std::vector<Track>& a, const std::vector<Track>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].id, b[i].id);
    EXPECT_EQ(a[i].status, b[i].status);
    EXPECT_EQ(a[i].state.mean, b[i].state.mean);
    EXPECT_EQ(a[i].state.covariance, b[i].state.covariance);
  }
}

class Guard : public testing::TestWithParam<EstimatorKind> {};

TEST_P(Guard, ChangesNothingToTheLastBitWhileSensorsAreHealthy) {
  const std::vector<Scan> scans = scansOf(6, 10.0, {}, 1);
  LocalTracker guarded(paramsWith(true, GetParam())), plain(paramsWith(false, GetParam()));
  const Outcome with = track(guarded, scans), without = track(plain, scans);
  ASSERT_TRUE(with.changes.empty());
  for (std::size_t k = 0; k < scans.size(); ++k)
    expectSameTracks(with.reports[k].tracks, without.reports[k].tracks);
}

TEST_P(Guard, AfterABiasTheStateIsThatOfATrackerThatNeverSawIt) {
  const std::vector<Scan> scans = scansOf(6, 5.0, {1.0, 3.0}, 2);
  LocalTracker guarded(paramsWith(true, GetParam()));
  const Outcome outcome = track(guarded, scans);
  ASSERT_FALSE(outcome.changes.empty());
  for (const SensorChange& each : outcome.changes) EXPECT_EQ(each.sensor, "sensor_5");
  const HealthChange& change = outcome.changes.back().change;
  EXPECT_EQ(change.verdict, SensorVerdict::biased);
  EXPECT_NEAR(seconds(change.began - at(kChange)), 0.0, 0.3);
  EXPECT_TRUE(outcome.reports.back().use.is_excluded);

  std::vector<Scan> good;
  for (const Scan& scan : scans) {
    if (scan.sensor != "sensor_5" || scan.time < change.began) good.push_back(scan);
  }
  LocalTracker plain(paramsWith(false, GetParam()));
  const Outcome never = track(plain, good);
  // The last scan is the excluded sensor's: the state of both at its time is compared a scan earlier.
  const ScanReport& before_last = outcome.reports[outcome.reports.size() - 2];
  ASSERT_EQ(before_last.time, never.reports.back().time);
  expectSameTracks(before_last.tracks, never.reports.back().tracks);
}

TEST_P(Guard, GrownNoiseIsTakenForWhatItIsSinceItBegan) {
  const std::vector<Scan> scans = scansOf(6, kChange + 0.5, {6.0}, 3);
  LocalTracker guarded(paramsWith(true, GetParam()));
  const Outcome outcome = track(guarded, scans);
  ASSERT_FALSE(outcome.changes.empty());
  EXPECT_EQ(outcome.changes.back().change.verdict, SensorVerdict::noisy);
  EXPECT_FALSE(outcome.reports.back().use.is_excluded);
  EXPECT_GT(outcome.reports.back().use.noise_scale, 4.0);
  EXPECT_LT(outcome.reports.back().use.noise_scale, 200.0);
}

TEST_P(Guard, TheOrderOfArrivalChangesNothing) {
  for (const Trouble& trouble : {Trouble{5.0}, Trouble{1.0, 3.0}, Trouble{1.0, 8.0, 5.5}}) {
    const std::vector<Scan> scans = scansOf(4, 8.0, trouble, 4);
    std::mt19937_64 random(9);
    std::uniform_real_distribution<double> latency(0.0, 0.45);
    std::vector<std::pair<double, Scan>> arrivals;
    for (const Scan& scan : scans)
      arrivals.emplace_back(seconds(scan.time - at(0.0)) + latency(random), scan);
    std::stable_sort(arrivals.begin(), arrivals.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<Scan> shuffled;
    for (const auto& arrival : arrivals) shuffled.push_back(arrival.second);

    LocalTracker in_order(paramsWith(true, GetParam())), out_of_order(paramsWith(true, GetParam()));
    const Outcome first = track(in_order, scans), second = track(out_of_order, shuffled);
    ASSERT_FALSE(first.changes.empty());
    expectSameTracks(first.reports.back().tracks, second.reports.back().tracks);
    const auto a = in_order.sensors(), b = out_of_order.sensors();
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
      EXPECT_EQ(a[i].verdict, b[i].verdict);
      EXPECT_EQ(a[i].is_excluded, b[i].is_excluded);
      EXPECT_EQ(a[i].noise_scale, b[i].noise_scale);
      ASSERT_EQ(a[i].last.has_value(), b[i].last.has_value());
      if (a[i].last) {
        EXPECT_EQ(a[i].last->time, b[i].last->time);
      }
    }
  }
}

TEST_P(Guard, AnExcludedSensorLeavesNoGhostAndComesBack) {
  for (const double bias : {3.0, 6.0, 30.0}) {
    const std::vector<Scan> scans = scansOf(6, 12.0, {1.0, bias, 7.0}, 5);
    LocalTracker tracker(paramsWith(true, GetParam()));
    const Outcome outcome = track(tracker, scans);
    ASSERT_GE(outcome.changes.size(), 2u) << "bias of " << bias << " sigma";
    EXPECT_EQ(outcome.changes.front().sensor, "sensor_5");
    EXPECT_EQ(outcome.changes.back().change.verdict, SensorVerdict::healthy);
    EXPECT_GE(outcome.changes.back().change.time, at(7.0));
    EXPECT_TRUE(outcome.reports.back().use.isAsStated());
    for (std::size_t k = 0; k < scans.size(); ++k) {
      if (scans[k].time < at(kChange + 0.5)) continue;
      ASSERT_EQ(outcome.reports[k].tracks.at(0).id, 1u) << "bias of " << bias << " sigma";
      for (const Track& found : outcome.reports[k].tracks)  // a sighting in 2000 is outside its gate
        EXPECT_EQ(found.status == TrackStatus::tentative, found.id != 1u);
    }
  }
}

TEST_P(Guard, WithOneSensorNothingIsSaidOfItWhateverTheTargetDoes) {
  for (const Trouble& trouble : {Trouble{6.0}, Trouble{1.0, 3.0}, Trouble{1.0, 0.0, 1e9, 0.2}}) {
    LocalTracker tracker(paramsWith(true, GetParam()));
    EXPECT_TRUE(track(tracker, scansOf(1, 8.0, trouble, 6)).changes.empty());
    EXPECT_TRUE(tracker.sensors().empty());
  }
}

TEST_P(Guard, OfTwoSensorsThatDisagreeNoneIsLeftOutButItIsSaid) {
  LocalTracker tracker(paramsWith(true, GetParam()));
  const Outcome outcome = track(tracker, scansOf(2, 8.0, {1.0, 3.0}, 7));
  ASSERT_FALSE(outcome.changes.empty());
  for (const SensorChange& change : outcome.changes) EXPECT_TRUE(change.undecided);
  for (const ScanReport& report : outcome.reports) EXPECT_TRUE(report.use.isAsStated());
}

INSTANTIATE_TEST_SUITE_P(Estimators, Guard, testing::Values(EstimatorKind::twbls, EstimatorKind::noga),
                         [](const auto& parameters) {
                           return parameters.param == EstimatorKind::noga ? "noga" : "twbls";
                         });

/// Sensors at different phases that look at a target which bends more than the filter takes for possible.
class LaggingFilter : public testing::TestWithParam<int> {
 protected:
  static std::vector<Scan> scansOnACurve(int sensors, unsigned seed) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> noise(0.0, 1e-3);
    const std::array<double, 6> phases = {0.0, 0.011, 0.007, 0.003, 0.024, 0.017};  // [s]
    std::vector<Scan> scans;
    for (int k = 0; k < 600; ++k) {
      for (int sensor = 0; sensor < sensors; ++sensor) {
        const double t = 0.03 * k + phases[static_cast<std::size_t>(sensor)];
        Scan scan;
        scan.time = at(t);
        scan.sensor = "sensor_" + std::to_string(sensor);
        const Eigen::Vector2d angles(0.3 * std::sin(t) + noise(random),
                                     0.1 * std::cos(2.0 * t) + noise(random));
        scan.sightings = {sightingOf(angles, 1e-6 * Eigen::Matrix2d::Identity())};
        scans.push_back(scan);
      }
    }
    std::sort(scans.begin(), scans.end(), [](const Scan& a, const Scan& b) { return precedes(a, b); });
    return scans;
  }
};

TEST_P(LaggingFilter, IsHeldAgainstNoSensorAndChangesNothingToTheLastBit) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    LocalTracker guarded(paramsWith(true, EstimatorKind::kalman));
    LocalTracker plain(paramsWith(false, EstimatorKind::kalman));
    const std::vector<Scan> scans = scansOnACurve(GetParam(), seed);
    const Outcome with = track(guarded, scans), without = track(plain, scans);
    for (const SensorChange& change : with.changes)
      ADD_FAILURE() << change.sensor << " since " << seconds(change.change.began - at(0.0)) << " s, seed "
                    << seed;
    for (const WatchedSensor& sensor : guarded.sensors()) EXPECT_FALSE(sensor.clock) << sensor.sensor;
    for (std::size_t k = 0; k < scans.size(); ++k)
      expectSameTracks(with.reports[k].tracks, without.reports[k].tracks);
  }
}

INSTANTIATE_TEST_SUITE_P(Sensors, LaggingFilter, testing::Values(2, 3, 6));

TEST(SensorGuard, ATargetThatTheExcludedSensorAloneSeesIsStillTracked) {
  std::vector<Scan> scans = scansOf(4, 8.0, {1.0, 3.0}, 8);
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  for (Scan& scan : scans) {
    if (scan.sensor != "sensor_3") continue;
    const Eigen::Vector2d angles(0.5 + kSigma * normal(random), 0.2 + kSigma * normal(random));
    scan.sightings.push_back(sightingOf(angles, kSigma * kSigma * Eigen::Matrix2d::Identity()));
  }
  LocalTracker tracker(paramsWith(true));
  const Outcome outcome = track(tracker, scans);
  ASSERT_FALSE(outcome.changes.empty());
  ASSERT_EQ(outcome.reports.back().tracks.size(), 2u);
  for (const Track& found : outcome.reports.back().tracks) EXPECT_EQ(found.status, TrackStatus::confirmed);
}

TEST(SensorGuard, ASensorThatLooksAtANewcomerInsteadIsNotHeldGuiltyForEver) {
  // From 4 s on sensor_3 sees another target, 20 sigma away, instead of the one that all the others see; from
  // 7 s on they see the newcomer too.
  std::vector<Scan> scans = scansOf(4, 20.0, {}, 11);
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  for (Scan& scan : scans) {
    const double t = seconds(scan.time - at(0.0));
    if (t < 4.0 || (scan.sensor != "sensor_3" && t < 7.0)) continue;
    const Eigen::Vector2d newcomer = targetAt(0.0, 0.0) + 20.0 * kSigma * Eigen::Vector2d(1.0, 1.0);
    const Eigen::Vector2d angles = newcomer + kSigma * Eigen::Vector2d(normal(random), normal(random));
    if (scan.sensor == "sensor_3") scan.sightings.clear();
    scan.sightings.push_back(sightingOf(angles, kSigma * kSigma * Eigen::Matrix2d::Identity()));
  }
  LocalTracker tracker(paramsWith(true));
  const Outcome outcome = track(tracker, scans);
  for (const WatchedSensor& sensor : tracker.sensors()) EXPECT_EQ(sensor.verdict, SensorVerdict::healthy);
  ASSERT_EQ(outcome.reports.back().tracks.size(), 2u);
  for (const Track& found : outcome.reports.back().tracks) EXPECT_EQ(found.status, TrackStatus::confirmed);
  EXPECT_EQ(outcome.reports.back().tracks[1].sources.size(), 4u);
}

TEST(SensorGuard, FalseSightingsBesideAMissedTargetAreNotHeldAgainstTheSensor) {
  std::vector<Scan> scans = scansOf(4, 30.0, {}, 10);
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> uniform;
  for (Scan& scan : scans) {  // one false sighting in the neighbourhood, the target seen nine times in ten
    const Eigen::Vector2d target = anglesOf(scan.sightings[0].direction);
    if (uniform(random) < 0.1) scan.sightings.clear();
    const Eigen::Vector2d stray =
        target + 80.0 * kSigma * Eigen::Vector2d(2.0 * uniform(random) - 1.0, 2.0 * uniform(random) - 1.0);
    scan.sightings.push_back(sightingOf(stray, kSigma * kSigma * Eigen::Matrix2d::Identity()));
  }
  LocalTracker tracker(paramsWith(true));
  EXPECT_TRUE(track(tracker, scans).changes.empty());
}

TEST(SensorGuard, RefusesParametersThatCannotWork) {
  GuardParams params;
  params.reach = 0.0;
  EXPECT_THROW(SensorGuard{params}, std::invalid_argument);
  params = {};
  params.health.noise_ratio = 0.5;
  EXPECT_THROW(SensorGuard{params}, std::invalid_argument);
}

}  // namespace
}  // namespace sightline::core
