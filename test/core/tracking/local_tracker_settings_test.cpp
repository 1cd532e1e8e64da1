// Settings of a LocalTracker that change while it runs.
#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "sightline/core/model/sphere.h"
#include "sightline/core/tracking/local_tracker.h"

namespace sightline::core {
namespace {

constexpr double kSigma = 1e-3;  // [rad]

/// Scans of one target by `sensors` sensors in turn, every 10 ms. From `from` on [s] the last sensor is off
/// by `bias` sigmas in both angles. Each states `stated` times its variance.
std::vector<Scan> scansOf(int count, int sensors, double bias = 0.0, double from = 0.0, double stated = 1.0) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  std::vector<Scan> scans;
  for (int k = 0; k < count; ++k) {
    const double t = 0.01 * k;
    const bool is_off = k % sensors == sensors - 1 && t >= from;
    const double n1 = normal(random), n2 = normal(random);
    Scan scan;
    scan.time = Time(std::chrono::seconds(1000)) + durationOf(t);
    scan.sensor = "sensor_" + std::to_string(k % sensors);
    const Eigen::Vector2d error = Eigen::Vector2d(n1, n2) + (is_off ? bias : 0.0) * Eigen::Vector2d::Ones();
    scan.sightings = {sightingOf(Eigen::Vector2d(0.1 + 0.02 * t, 0.05) + kSigma * error,
                                 stated * kSigma * kSigma * Eigen::Matrix2d::Identity())};
    scans.push_back(scan);
  }
  return scans;
}

/// Everything that a person sees of the tracks, to compare to the last bit.
std::vector<double> bitsOf(const ScanReport& report) {
  std::vector<double> bits;
  for (const Track& track : report.tracks) {
    bits.insert(bits.end(), {static_cast<double>(track.id), static_cast<double>(track.status),
                             static_cast<double>(track.hits), track.existence});
    bits.insert(bits.end(), track.state.mean.data(), track.state.mean.data() + 4);
    bits.insert(bits.end(), track.state.covariance.data(), track.state.covariance.data() + 16);
    bits.insert(bits.end(), {track.gate.half_width.x(), track.gate.half_width.y()});
  }
  return bits;
}

LocalTracker trackerAfter(const std::vector<Scan>& scans, std::size_t count,
                          const LocalTrackerParams& params = {}) {
  LocalTracker tracker(params);
  for (std::size_t k = 0; k < count; ++k) tracker.onScan(scans[k]);
  return tracker;
}

LocalTrackerParams withGate(double probability) {
  LocalTrackerParams params;
  params.gate.probability = probability;
  return params;
}

LocalTrackerParams withThresholds(double threshold) {
  LocalTrackerParams params;
  params.guard.health.noise_threshold = params.guard.health.bias_threshold = threshold;
  return params;
}

LocalTrackerParams withCalibration(bool enabled) {
  LocalTrackerParams params;
  params.noise_calibration.enabled = enabled;
  params.estimator.twbls_consistent.noise.enabled = params.estimator.noga_consistent.noise.enabled = enabled;
  return params;
}

WatchedSensor verdictOn(const LocalTracker& tracker, const std::string& sensor) {
  for (const WatchedSensor& watched : tracker.sensors())
    if (watched.sensor == sensor) return watched;
  ADD_FAILURE() << sensor << " is not watched";
  return {};
}

TEST(LocalTrackerSettings, AnotherGateProbabilityHoldsForTheNextScanAndTracksGoOn) {
  const std::vector<Scan> scans = scansOf(101, 2);
  LocalTracker tracker = trackerAfter(scans, 100), as_before = tracker;
  ASSERT_FALSE(tracker.reconfigure(withGate(0.9)));
  const ScanReport now = tracker.onScan(scans[100]), before = as_before.onScan(scans[100]);
  ASSERT_EQ(now.associations.size(), 1u);
  ASSERT_EQ(now.associations[0].decision, Decision::accepted);
  EXPECT_NEAR(now.associations[0].threshold, -2.0 * std::log(1.0 - 0.9), 1e-12);
  EXPECT_NEAR(before.associations[0].threshold, -2.0 * std::log(1.0 - 0.9995), 1e-9);
  ASSERT_EQ(now.tracks.size(), 1u);
  EXPECT_EQ(now.tracks[0].id, before.tracks[0].id);
  EXPECT_EQ(now.tracks[0].hits, before.tracks[0].hits);
  EXPECT_EQ(now.tracks[0].state.mean, before.tracks[0].state.mean) << "the sighting is inside both gates";
  EXPECT_NEAR(now.tracks[0].gate.half_width.x() / before.tracks[0].gate.half_width.x(),
              std::sqrt(std::log(0.1) / std::log(0.0005)), 1e-9);
}

TEST(LocalTrackerSettings, ATentativeTrackIsConfirmedByTheNewCountOfSightings) {
  LocalTrackerParams slow;
  slow.lifecycle.confirm_scans = slow.lifecycle.confirm_hits = 50;
  const std::vector<Scan> scans = scansOf(21, 1);
  LocalTracker tracker = trackerAfter(scans, 19, slow);
  const ScanReport before = tracker.onScan(scans[19]);
  ASSERT_EQ(before.tracks.size(), 1u);
  EXPECT_EQ(before.tracks[0].status, TrackStatus::tentative);
  ASSERT_FALSE(tracker.reconfigure(LocalTrackerParams{}));
  const ScanReport now = tracker.onScan(scans[20]);
  ASSERT_EQ(now.tracks.size(), 1u);
  EXPECT_EQ(now.tracks[0].status, TrackStatus::confirmed);
  EXPECT_EQ(now.tracks[0].id, before.tracks[0].id);
}

TEST(LocalTrackerSettings, ARefusalLeavesEverythingAsItWas) {
  const std::vector<Scan> scans = scansOf(300, 3);
  LocalTracker tracker = trackerAfter(scans, 100), untouched = tracker;
  LocalTrackerParams wanted = withGate(0.9);
  wanted.estimator.kind = EstimatorKind::kalman;
  const auto fixed = tracker.reconfigure(wanted);
  ASSERT_TRUE(fixed);
  EXPECT_EQ(fixed->kind, "fixed");
  EXPECT_EQ(tracker.reconfigure(withGate(1.5))->kind, "invalid");
  EXPECT_EQ(tracker.params().gate.probability, LocalTrackerParams{}.gate.probability);
  for (std::size_t k = 100; k < scans.size(); ++k)
    ASSERT_EQ(bitsOf(tracker.onScan(scans[k])), bitsOf(untouched.onScan(scans[k]))) << k;
}

TEST(LocalTrackerSettings, AChangeHoldsAlsoWhenALateScanRollsBackToBeforeIt) {
  // At 0.6 many sightings of the target are outside, so that it matters which gate a scan is held against.
  const std::vector<Scan> scans = scansOf(200, 2);
  constexpr std::size_t kLate = 95, kChange = 100;  // the late scan is one of before the change
  LocalTracker in_order = trackerAfter(scans, kChange);
  ASSERT_FALSE(in_order.reconfigure(withGate(0.6)));
  LocalTracker never = trackerAfter(scans, kChange);
  LocalTracker always = trackerAfter(scans, kChange, withGate(0.6));

  LocalTracker with_late{LocalTrackerParams{}};
  for (std::size_t k = 0; k < kChange; ++k)
    if (k != kLate) with_late.onScan(scans[k]);
  ASSERT_FALSE(with_late.reconfigure(withGate(0.6)));
  for (std::size_t k = kChange; k < kChange + 20; ++k) {
    for (LocalTracker* tracker : {&in_order, &never, &always, &with_late}) tracker->onScan(scans[k]);
  }
  const ScanReport late = with_late.onScan(scans[kLate]);
  ASSERT_FALSE(late.refusal);
  ASSERT_EQ(late.associations.size(), 1u);
  EXPECT_NEAR(late.associations[0].threshold, -2.0 * std::log(1.0 - 0.9995), 1e-9)
      << "the late scan is held against the gate of its time";
  bool differs_from_never = false, differs_from_always = false;
  for (std::size_t k = kChange + 20; k < scans.size(); ++k) {
    const auto bits = bitsOf(in_order.onScan(scans[k]));
    ASSERT_EQ(bitsOf(with_late.onScan(scans[k])), bits) << k;
    differs_from_never = differs_from_never || bitsOf(never.onScan(scans[k])) != bits;
    differs_from_always = differs_from_always || bitsOf(always.onScan(scans[k])) != bits;
  }
  EXPECT_TRUE(differs_from_never);
  EXPECT_TRUE(differs_from_always);
}

TEST(LocalTrackerSettings, ManyChangesAndLateScansLeaveTheStateOfScansInOrder) {
  const std::vector<Scan> scans = scansOf(400, 4, 3.0, 1.5);
  LocalTracker in_order{LocalTrackerParams{}}, shuffled{LocalTrackerParams{}};
  std::mt19937_64 random(11);
  const auto paramsAt = [](std::size_t k) {
    LocalTrackerParams params = k % 3 == 0 ? withThresholds(8.0) : withThresholds(20.0);
    params.gate.probability = k % 2 == 0 ? 0.7 : 0.999;
    params.noise_calibration.enabled = k % 5 != 0;
    params.estimator.twbls_consistent.noise.enabled = params.estimator.noga_consistent.noise.enabled =
        k % 5 != 0;
    return params;
  };
  // Of every twenty scans the last comes first and has a change behind it; the others come in any order.
  for (std::size_t begin = 0; begin < scans.size(); begin += 20) {
    for (std::size_t k = begin; k < begin + 20; ++k) in_order.onScan(scans[k]);
    std::vector<std::size_t> order;
    for (std::size_t k = begin; k < begin + 19; ++k) order.push_back(k);
    std::shuffle(order.begin(), order.end(), random);
    shuffled.onScan(scans[begin + 19]);
    ASSERT_FALSE(in_order.reconfigure(paramsAt(begin / 20)));
    ASSERT_FALSE(shuffled.reconfigure(paramsAt(begin / 20)));
    for (const std::size_t k : order) ASSERT_FALSE(shuffled.onScan(scans[k]).refusal);
  }
  const Scan last = scansOf(401, 4, 3.0, 1.5).back();
  EXPECT_EQ(bitsOf(shuffled.onScan(last)), bitsOf(in_order.onScan(last)));
  EXPECT_TRUE(verdictOn(in_order, "sensor_3").last) << "the guard had something to judge";
}

TEST(LocalTrackerSettings, TheGuardJudgesByTheNewThresholdsAlsoAfterRollingBack) {
  const std::vector<Scan> scans = scansOf(400, 4, 5.0, 2.0);
  LocalTracker judged = trackerAfter(scans, 100), lenient = judged;
  ASSERT_FALSE(lenient.reconfigure(withThresholds(1e9)));
  for (std::size_t k = 100; k < scans.size(); ++k) {
    judged.onScan(scans[k]);
    if (k % 10 == 1) continue;
    lenient.onScan(scans[k]);
    if (k % 10 == 3) lenient.onScan(scans[k - 2]);  // late
  }
  EXPECT_EQ(verdictOn(judged, "sensor_3").verdict, SensorVerdict::biased);
  EXPECT_FALSE(verdictOn(lenient, "sensor_3").last);
  ASSERT_FALSE(lenient.reconfigure(LocalTrackerParams{}));
  lenient.onScan(scansOf(404, 4, 5.0, 2.0)[403]);
  EXPECT_NE(verdictOn(lenient, "sensor_3").verdict, SensorVerdict::healthy) << "what was summed up counts";
}

TEST(LocalTrackerSettings, SwitchingNoiseCalibrationForgetsWhatWasLearnt) {
  for (const EstimatorKind kind : {EstimatorKind::noga, EstimatorKind::twbls}) {
    const std::vector<Scan> scans = scansOf(900, 1, 0.0, 0.0, 100.0);  // the variance is stated a hundredfold
    LocalTrackerParams on = withCalibration(true), off = withCalibration(false);
    on.estimator.kind = off.estimator.kind = kind;
    LocalTracker tracker(on);
    ScanReport report;
    for (std::size_t k = 0; k < 300; ++k) report = tracker.onScan(scans[k]);
    ASSERT_EQ(report.tracks.size(), 1u);
    const std::uint32_t id = report.tracks[0].id;
    ASSERT_EQ(tracker.calibratedSensors().size(), 1u);
    EXPECT_LT(tracker.calibratedSensors()[0].scale, 0.5);
    const double learnt = report.tracks[0].gate.half_width.x();

    ASSERT_FALSE(tracker.reconfigure(off));
    for (std::size_t k = 300; k < 600; ++k) report = tracker.onScan(scans[k]);
    EXPECT_TRUE(tracker.calibratedSensors().empty());
    ASSERT_EQ(report.tracks.size(), 1u);
    EXPECT_EQ(report.tracks[0].id, id);
    EXPECT_GT(report.tracks[0].gate.half_width.x(), 2.0 * learnt) << "the stated noise counts";

    ASSERT_FALSE(tracker.reconfigure(on));
    for (std::size_t k = 600; k < 900; ++k) report = tracker.onScan(scans[k]);
    EXPECT_EQ(report.tracks.at(0).id, id);
    EXPECT_LT(tracker.calibratedSensors().at(0).scale, 0.5);
    EXPECT_LT(report.tracks[0].gate.half_width.x(), 1.5 * learnt);
  }
}

TEST(LocalTrackerSettings, WhatHoldsNowHoldsAfterTimeWentBackAndBeforeTheFirstScan) {
  const std::vector<Scan> scans = scansOf(60, 1);
  LocalTracker tracker{LocalTrackerParams{}};
  ASSERT_FALSE(tracker.reconfigure(withGate(0.9)));
  tracker.onScan(scans[40]);
  EXPECT_NEAR(tracker.onScan(scans[41]).associations.at(0).threshold, -2.0 * std::log(0.1), 1e-9);
  ASSERT_FALSE(tracker.reconfigure(withGate(0.99)));
  tracker.startAnew(scans[0].time);
  tracker.onScan(scans[0]);
  EXPECT_NEAR(tracker.onScan(scans[1]).associations.at(0).threshold, -2.0 * std::log(0.01), 1e-9);
}

}  // namespace
}  // namespace sightline::core
