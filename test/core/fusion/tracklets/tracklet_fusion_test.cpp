// Fusion by tracklets against one tracker that is given every sighting.
#include "sightline/core/fusion/tracklets/tracklet_fusion.h"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <set>

#include <gtest/gtest.h>

#include "support/tracklet_platform.h"

namespace sightline::core {
namespace {

using Eigen::Vector2d;
using test::disagreement;
using test::Platform;
using test::PlatformRun;
using test::PlatformSensor;
using test::platformTime;

Vector2d sinusoid(double t) {
  return {0.02 * std::sin(t), 0.3 + 0.02 * std::cos(t)};
}

/// Three asynchronous sensors, each with a tracker of its own, whose gates let every sighting in.
Platform threeSensors() {
  Platform platform;
  platform.tracker.gate.probability = 1.0 - 1e-12;
  platform.tracker.max_lag = 2.0;
  platform.fusion.rule = FusionRule::best;
  platform.path = sinusoid;
  platform.sensors = {{"a", "camera a", 0.03, 0.0, 1e-3, 0.0},
                      {"b", "camera b", 0.04, 0.007, 1e-3, 0.0},
                      {"c", "camera c", 0.05, 0.013, 2e-3, 0.0}};
  return platform;
}

/// The central tracker's track at a time when it took a sighting.
const Track* centralAt(const PlatformRun& run, Time time) {
  const auto found = std::find(run.central_times.rbegin(), run.central_times.rend(), time);
  if (found == run.central_times.rend()) return nullptr;
  return &run.central[run.central.size() - 1 - static_cast<std::size_t>(found - run.central_times.rbegin())];
}

/// Largest disagreement with the central tracker over all fusions later than `from` [s].
double worstDisagreement(const PlatformRun& run, double from, FusionRule rule = FusionRule::tracklets) {
  double worst = 0.0;
  int compared = 0;
  for (const FusionReport& report : run.fused) {
    if (report.time < platformTime(from)) continue;
    const Track* central = centralAt(run, report.time);
    if (central == nullptr) continue;
    EXPECT_EQ(report.tracks.size(), 1u);
    const FusedTrack& fused = report.tracks.at(0);
    EXPECT_EQ(nameOf(fused.rule), nameOf(rule)) << textOf(fused.why_not_tracklets.value_or(Refusal{}));
    worst = std::max(worst, disagreement(fused.track.state, central->state));
    ++compared;
  }
  EXPECT_GT(compared, 10);
  return worst;
}

EstimatorParams estimatorOf(EstimatorKind kind) {
  EstimatorParams estimator;
  estimator.kind = kind;
  return estimator;
}

std::vector<EstimatorKind> everyKind() {
  std::vector<EstimatorKind> kinds;
  for (const EstimatorEntry& entry : estimatorTable()) kinds.push_back(entry.kind);
  return kinds;
}

TEST(TrackletFusion, EqualsTheCentralTracker) {
  // The same estimator on the same sightings in the same order: nothing but rounding may differ. That grows
  // with the estimator's memory, and angles of 0.3 rad against sigmas of 1e-4 rad leave 1e-12 of a sigma.
  for (const EstimatorKind kind : everyKind()) {
    Platform platform = threeSensors();
    platform.tracker.estimator = platform.fusion.tracklets.estimator = estimatorOf(kind);
    EXPECT_LT(worstDisagreement(run(platform), 0.5), 1e-7) << static_cast<int>(kind);
  }
}

TEST(TrackletFusion, EqualsTheCentralTrackerAtTheWrapAndAcrossTheZenith) {
  for (const bool zenith : {false, true}) {
    Platform platform = threeSensors();
    platform.path = [zenith](double t) {
      return zenith ? anglesOf({0.1 * (t - 2.0), 0.05, 1.0}) : Vector2d(wrapAngle(3.1 + 0.02 * t), 0.3);
    };
    platform.tracker.estimator = platform.fusion.tracklets.estimator = estimatorOf(EstimatorKind::noga);
    // Sightings at the zenith come with the azimuth's huge variance; the platform states round ones instead.
    if (zenith) {
      for (PlatformSensor& sensor : platform.sensors) sensor.sigma *= 0.1;
    }
    EXPECT_LT(worstDisagreement(run(platform), 0.5), 1e-6) << zenith;
  }
}

TEST(TrackletFusion, ReportsEvery300MillisecondsAreAsAccurateAsTheCentralTracker) {
  for (const EstimatorKind kind : {EstimatorKind::noga, EstimatorKind::kalman}) {
    double squares = 0.0, central_squares = 0.0, nees = 0.0, central_nees = 0.0;
    int compared = 0;
    for (unsigned seed = 1; seed <= 20; ++seed) {
      Platform platform = threeSensors();
      platform.seed = seed;
      platform.duration = 6.0;
      platform.tracker.estimator = platform.fusion.tracklets.estimator = estimatorOf(kind);
      platform.tracklets.interval = 0.3;
      for (PlatformSensor& sensor : platform.sensors) sensor.interval = 0.03;
      const PlatformRun result = run(platform);
      for (const FusionReport& report : result.fused) {
        // All three report 0.3 s after 0.3 s; the last of them completes what the central tracker knows.
        const double t = seconds(report.time - platformTime(0.0)), in_interval = std::fmod(t - 0.013, 0.3);
        const bool is_complete = std::min(in_interval, 0.3 - in_interval) < 1e-6;
        if (t < 1.0 || !is_complete) continue;
        const FusedTrack& fused = report.tracks.at(0);
        const Track& central = *centralAt(result, report.time);
        EXPECT_EQ(nameOf(fused.rule), "tracklets");
        const auto add = [t](const AngularState& state, double& sum, double& nees_sum) {
          const Vector2d error = state.angles() - sinusoid(t);
          sum += error.squaredNorm();
          nees_sum += error.dot(state.anglesCovariance().llt().solve(error)) / 2.0;
        };
        add(fused.track.state, squares, nees);
        add(central.state, central_squares, central_nees);
        ++compared;
      }
    }
    EXPECT_GT(compared, 300);
    EXPECT_LT(std::sqrt(squares / central_squares), 1.01);
    EXPECT_NEAR(nees / central_nees, 1.0, 0.05);
  }
}

TEST(TrackletFusion, OrderOfArrivalDoesNotMatter) {
  for (const EstimatorKind kind : everyKind()) {
    Platform platform = threeSensors();
    platform.tracker.estimator = platform.fusion.tracklets.estimator = estimatorOf(kind);
    platform.duration = 3.0;
    const PlatformRun in_order = run(platform);
    platform.delay = [](std::mt19937_64& random) {
      return std::uniform_real_distribution<double>(0.0, 0.5)(random);
    };
    const PlatformRun shuffled = run(platform);
    const FusionReport &a = in_order.fused.back(), &b = shuffled.fused.back();
    ASSERT_EQ(a.tracks.size(), 1u);
    ASSERT_EQ(b.tracks.size(), 1u);
    ASSERT_EQ(a.time, b.time);
    EXPECT_LT(disagreement(b.tracks[0].track.state, a.tracks[0].track.state), 1e-7)
        << static_cast<int>(kind) << " " << textOf(b.tracks[0].why_not_tracklets.value_or(Refusal{}));
  }
}

TEST(TrackletFusion, SlowAndLateSourceStandsBesideAFastOne) {
  // 1 Hz and 500 ms beside 100 Hz and 5 ms; a third so that there is more than one fast track.
  Platform platform = threeSensors();
  platform.sensors = {{"fast", "fast camera", 0.01, 0.0, 1e-3, 0.005},
                      {"slow", "slow camera", 1.0, 0.003, 1e-4, 0.5},
                      {"other", "other camera", 0.02, 0.001, 1e-3, 0.005}};
  platform.duration = 12.0;
  platform.path = [](double t) { return Vector2d(0.002 * t, 0.3 - 0.001 * t); };
  platform.tracker.estimator = platform.fusion.tracklets.estimator = estimatorOf(EstimatorKind::kalman);
  const PlatformRun result = run(platform);
  int with_slow = 0, whole = 0, all = 0;
  for (const FusionReport& report : result.fused) {
    if (report.time < platformTime(6.0)) continue;  // the slow one is confirmed by its fourth sighting
    ASSERT_EQ(report.tracks.size(), 1u);
    const FusedTrack& fused = report.tracks[0];
    ++all;
    for (const SourceTrack& source : fused.sources) with_slow += source.tracker == "slow" ? 1 : 0;
    const Track* central = centralAt(result, report.time);
    // The slow sighting of t = 6, 7, ... is here from 0.5 s later on, until the next one is taken.
    const double t = seconds(report.time - platformTime(0.0)), since = t - std::floor(t);
    if (central != nullptr && since > 0.52 && since < 0.98) {
      EXPECT_LT(disagreement(fused.track.state, central->state), 0.5) << t;
      ++whole;
    }
  }
  EXPECT_GT(whole, 100);
  EXPECT_GT(with_slow, 9 * all / 10) << "it counts as long as it keeps its own pace";
}

TEST(TrackletFusion, OneSensorAt200HertzBesideOneAMinuteIsAsAccurateAsTheBetter) {
  test::Platform platform;
  platform.path = [](double t) { return Eigen::Vector2d(0.1 + 0.002 * t, 0.3 - 0.0005 * t); };
  platform.duration = 190.0;  // the slow one's track is confirmed by its fourth sighting
  const test::PlatformSensor fast{"fast", "fast eye", 0.005, 0.0, 1e-3};
  const auto rms = [&](const std::vector<test::PlatformSensor>& sensors) {
    platform.sensors = sensors;
    double squared = 0.0;
    int reports = 0, of_all = 0;
    std::set<std::uint32_t> ids;
    for (const FusionReport& report : test::run(platform).fused) {
      const double t = seconds(report.time - test::platformTime(0.0));
      if (t < 5.0) continue;
      EXPECT_EQ(report.tracks.size(), 1u) << t;
      if (report.tracks.empty()) continue;
      ids.insert(report.tracks[0].track.id);
      squared += (report.tracks[0].track.state.angles() - platform.path(t)).squaredNorm();
      ++reports;
      of_all += report.tracks[0].sources.size() == sensors.size();
    }
    EXPECT_EQ(ids.size(), 1u);
    EXPECT_GT(of_all, 0) << "the slow one contributes nothing";
    return std::sqrt(squared / 2.0 / reports);
  };
  const double alone = rms({fast});
  EXPECT_LT(alone, 0.2 * fast.sigma);
  for (const double sigma : {1e-3, 1e-4}) {  // the noise of the fast one is the same in all runs
    const test::PlatformSensor slow{"slow", "slow eye", 60.0, 1.0, sigma};
    EXPECT_LE(rms({fast, slow}), 1.01 * alone) << sigma;
  }
}

TEST(TrackletFusion, SourceThatStopsAndReturnsCountsAgain) {
  Platform platform = threeSensors();
  platform.sights = [](const PlatformSensor& sensor, double t) {
    return sensor.tracker != "b" || t < 1.5 || t > 4.5;  // longer than a local track lives
  };
  platform.duration = 8.0;
  platform.tracker.estimator = platform.fusion.tracklets.estimator = estimatorOf(EstimatorKind::noga);
  const PlatformRun result = run(platform);
  std::set<std::uint32_t> ids;
  std::size_t sources_at_end = 0;
  for (const FusionReport& report : result.fused) {
    if (report.time < platformTime(0.5)) continue;
    for (const FusedTrack& fused : report.tracks) ids.insert(fused.track.id);
    sources_at_end = report.tracks.at(0).sources.size();
  }
  EXPECT_EQ(ids.size(), 1u) << "one target, one track";
  EXPECT_EQ(sources_at_end, 3u);
  EXPECT_LT(worstDisagreement(result, 6.0), 1e-6) << "its first sightings after the pause are in, too";
}

TEST(TrackletFusion, SensorInTwoLocalTracksCountsOnce) {
  Platform platform = threeSensors();
  // Tracker "ab" is given camera a's sightings too.
  platform.sensors[1].tracker = "ab";
  PlatformSensor again = platform.sensors[0];
  again.tracker = "ab";
  const PlatformRun alone = run(platform);
  platform.sensors.push_back(again);
  std::vector<std::pair<const PlatformSensor*, Scan>> scans = test::scansOf(platform);
  // The same sightings, not new ones of the same sensor: run by hand.
  std::map<std::string, LocalTracker> trackers;
  std::map<std::string, TrackletBuilder> builders;
  TrackFusion fusion(platform.fusion);
  FusionReport report;
  std::map<Time, Sighting> of_a;
  for (const auto& [sensor, scan] : scans) {
    if (sensor->tracker == "a") of_a.emplace(scan.time, scan.sightings[0]);
  }
  Platform original = threeSensors();
  std::map<std::pair<std::string, Time>, Sighting> genuine;
  for (const auto& [sensor, scan] : test::scansOf(original))
    genuine.emplace(std::make_pair(scan.sensor, scan.time), scan.sightings[0]);
  LocalTracker central(platform.tracker);
  AngularState central_state;
  double worst = 0.0;
  for (auto& [sensor, scan] : scans) {
    scan.sightings = {genuine.at({scan.sensor, scan.time})};
    auto& tracker = trackers.try_emplace(sensor->tracker, platform.tracker).first->second;
    auto& builder = builders.try_emplace(sensor->tracker, platform.tracklets).first->second;
    const ScanReport tracked = tracker.onScan(scan);
    TrackletReport tracklets = *builder.onScan(scan, tracked);
    tracklets.tracker = sensor->tracker;
    EXPECT_FALSE(fusion.onTracklets(tracklets));
    report = fusion.onReport({sensor->tracker, tracked.time, tracked.tracks});
    const ScanReport whole = central.onScan(scan);  // the second copy is refused as a duplicate
    if (whole.time < platformTime(1.0)) continue;
    ASSERT_EQ(report.tracks.size(), 1u);
    if (sensor->tracker == "ab" && sensor->name == "camera a") {
      worst = std::max(worst, disagreement(report.tracks[0].track.state, whole.tracks.at(0).state));
      EXPECT_EQ(report.tracks[0].sources.size(), 3u);
    }
  }
  EXPECT_LT(worst, 1e-6);
}

TEST(TrackletFusion, OneLostMessageIsBorneAndManyAreNot) {
  Platform platform = threeSensors();
  platform.tracker.estimator = platform.fusion.tracklets.estimator = estimatorOf(EstimatorKind::noga);
  platform.duration = 5.0;
  const auto rulesIn = [&platform](double lost_from, double lost_to) {
    platform.loses = [=](const std::string& tracker, double t) {
      return tracker != "c" && t > lost_from && t < lost_to;
    };
    std::set<std::string> rules;
    for (const FusionReport& report : run(platform).fused) {
      if (report.time < platformTime(1.0)) continue;
      const FusedTrack& fused = report.tracks.at(0);
      rules.insert(nameOf(fused.rule));
      EXPECT_EQ(fused.rule == FusionRule::tracklets, !fused.why_not_tracklets);
      if (fused.why_not_tracklets) {
        EXPECT_EQ(fused.why_not_tracklets->kind, "tracklets lost");
      }
    }
    EXPECT_EQ(nameOf(run(platform).fused.back().tracks.at(0).rule), "tracklets") << "it recovers";
    return rules;
  };
  EXPECT_EQ(rulesIn(2.0, 2.1), (std::set<std::string>{"tracklets"}));
  EXPECT_EQ(rulesIn(2.0, 2.6), (std::set<std::string>{"cross_covariance", "tracklets"}));
}

TEST(TrackletFusion, WithoutTrackletsOfEverySourceTheNextBestRuleIsTakenAndTheReportSaysWhy) {
  Platform platform = threeSensors();
  platform.loses = [](const std::string& tracker, double) { return tracker == "b"; };
  const FusedTrack last = run(platform).fused.back().tracks.at(0);
  EXPECT_EQ(last.rule, FusionRule::cross_covariance);
  EXPECT_EQ(last.why_not_tracklets.value_or(Refusal{}).detail, "no tracklets from b");
}

TEST(TrackletFusion, ContradictingSourceIsTakenBack) {
  Platform platform = threeSensors();
  platform.tracker.estimator = platform.fusion.tracklets.estimator = estimatorOf(EstimatorKind::kalman);
  platform.bias = [](const PlatformSensor& sensor, double t) {
    return Vector2d(sensor.tracker == "b" && t > 2.0 ? 0.1 * (t - 2.0) : 0.0, 0.0);  // it slides away
  };
  const PlatformRun result = run(platform);
  bool was_left_out = false;
  for (const FusionReport& report : result.fused) {
    const double t = seconds(report.time - platformTime(0.0));
    if (t < 2.5) continue;
    const FusedTrack& fused = report.tracks.at(0);
    const Vector2d error = fused.track.state.angles() - sinusoid(t);
    EXPECT_LT(error.norm(), 5e-3) << t << ": a tenth of where the source is at the end";
    for (const SourceTrack& row : fused.left_out)
      was_left_out |= row.reason && row.reason->kind == "contradiction";
  }
  EXPECT_TRUE(was_left_out);
}

TEST(TrackletFusion, HarmfulSourceStaysASupporterAndIsNotUsedUntilItRecovers) {
  for (const bool is_bias : {true, false}) {
    Platform platform = threeSensors();
    platform.tracker.estimator = platform.fusion.tracklets.estimator = estimatorOf(EstimatorKind::kalman);
    platform.tracker.guard.enabled = false;  // the central one's
    for (PlatformSensor& sensor : platform.sensors) sensor.interval = 0.03;
    platform.duration = 8.0;
    std::mt19937_64 random(7);
    std::normal_distribution<double> normal;
    platform.bias = [&](const PlatformSensor& sensor, double t) {
      if (sensor.tracker != "b" || t < 2.0 || t > 4.0) return Vector2d(0.0, 0.0);
      return is_bias ? Vector2d(3e-3, 0.0) : Vector2d(4e-3 * Vector2d(normal(random), normal(random)));
    };
    const PlatformRun result = run(platform);
    std::set<std::string> verdicts;
    std::set<std::uint32_t> ids;
    int left_out = 0, others_left_out = 0;
    double worst = 0.0;
    for (const FusionReport& report : result.fused) {
      const double t = seconds(report.time - platformTime(0.0));
      if (t < 1.0) continue;
      for (const FusedTrack& fused : report.tracks) ids.insert(fused.track.id);
      const FusedTrack& fused = report.tracks.at(0);
      worst = std::max(worst, (fused.track.state.angles() - sinusoid(t)).norm());
      for (const SensorChange& change : fused.sensor_changes) {
        EXPECT_EQ(change.sensor, "camera b");
        verdicts.insert(change.change.verdict == SensorVerdict::healthy  ? "healthy"
                        : change.change.verdict == SensorVerdict::biased ? "biased"
                                                                         : "noisy");
      }
      for (const SourceTrack& row : fused.left_out) {
        (row.tracker == "b" && row.reason && row.reason->kind == "biased" ? left_out : others_left_out) += 1;
      }
    }
    EXPECT_EQ(verdicts, (std::set<std::string>{is_bias ? "biased" : "noisy", "healthy"}));
    EXPECT_EQ(ids.size(), 1u) << "one target, one track";
    EXPECT_LT(worst, 2.5e-3);
    EXPECT_LT(others_left_out, 30);
    EXPECT_EQ(left_out > 100, is_bias) << left_out;
    EXPECT_EQ(result.fused.back().tracks.at(0).sources.size(), 3u) << "it is used again";
  }
}

}  // namespace
}  // namespace sightline::core
