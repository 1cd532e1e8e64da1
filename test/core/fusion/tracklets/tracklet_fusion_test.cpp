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
    EXPECT_EQ(nameOf(fused.rule), nameOf(rule)) << fused.why_not_tracklets;
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

const EstimatorKind kKinds[] = {EstimatorKind::twbls, EstimatorKind::noga, EstimatorKind::kalman,
                                EstimatorKind::imm};

TEST(TrackletFusion, EqualsTheCentralTracker) {
  // The same estimator on the same sightings in the same order: nothing but rounding may differ. That grows
  // with the estimator's memory, and angles of 0.3 rad against sigmas of 1e-4 rad leave 1e-12 of a sigma.
  for (const EstimatorKind kind : kKinds) {
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
  for (const EstimatorKind kind : kKinds) {
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
        << static_cast<int>(kind) << " " << b.tracks[0].why_not_tracklets;
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
    EXPECT_EQ(fusion.onTracklets(tracklets), "");
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
      EXPECT_EQ(fused.rule == FusionRule::tracklets, fused.why_not_tracklets.empty());
      if (!fused.why_not_tracklets.empty()) {
        EXPECT_EQ(fused.why_not_tracklets.substr(0, 14), "tracklets lost");
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
  EXPECT_EQ(last.why_not_tracklets, "no tracklets from b");
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
    for (const SourceTrack& row : fused.left_out) was_left_out |= row.reason.substr(0, 13) == "contradiction";
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
        (row.tracker == "b" && row.reason.substr(0, 7) == "biased:" ? left_out : others_left_out) += 1;
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

TEST(TrackletTrack, LateTrackletIsPutInItsPlaceAndTooLateOneIsNot) {
  const auto trackletAt = [](double t) {
    Tracklet tracklet;
    tracklet.time = platformTime(t);
    tracklet.sensor = "camera";
    tracklet.sighting = sightingOf({0.1 * std::sin(3.0 * t), 0.1 * t}, 1e-6 * Eigen::Matrix2d::Identity());
    return tracklet;
  };
  TrackletTrack in_order({}, 0.5), shuffled({}, 0.5);
  EXPECT_FALSE(in_order.stateAt(platformTime(0.0)));
  for (int k = 0; k < 100; ++k) in_order.add({"a", 1}, 1, trackletAt(0.02 * k));
  for (int k = 0; k < 100; ++k) {
    if (k % 10 != 0) shuffled.add({"a", 1}, 1, trackletAt(0.02 * k));
    // every tenth comes nine later
    if (k % 10 == 9) {
      shuffled.stateAt(platformTime(0.02 * k));
      EXPECT_TRUE(shuffled.add({"a", 1}, 1, trackletAt(0.02 * (k - 9))));
      EXPECT_TRUE(shuffled.add({"a", 1}, 1, trackletAt(0.02 * (k - 9)))) << "again: not counted twice";
    }
  }
  const AngularState a = *in_order.stateAt(platformTime(2.0)), b = *shuffled.stateAt(platformTime(2.0));
  EXPECT_EQ(a.mean, b.mean);
  EXPECT_EQ(a.covariance, b.covariance);
  EXPECT_FALSE(shuffled.add({"a", 1}, 1, trackletAt(0.5)));
}

TEST(TrackletTrack, AnyOrderGivesTheSameBits) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform;
  for (int repetition = 0; repetition < 20; ++repetition) {
    std::vector<std::pair<double, Tracklet>> arrivals;
    for (int k = 0; k < 150; ++k) {
      Tracklet tracklet;
      tracklet.time = platformTime(0.02 * k);
      tracklet.sensor = "camera";
      tracklet.sighting =
          sightingOf({0.1 * uniform(random), 0.1 * uniform(random)}, 1e-4 * Eigen::Matrix2d::Identity());
      arrivals.emplace_back(0.02 * k + 0.5 * uniform(random), tracklet);
    }
    std::sort(arrivals.begin(), arrivals.end(),
              [](const auto& a, const auto& b) { return a.first < b.first; });
    TrackletTrack track({}, 1.0);
    std::vector<Tracklet> given;
    Time newest{};
    for (const auto& [arrival, tracklet] : arrivals) {
      ASSERT_TRUE(track.add({"a", 1}, 1, tracklet));
      given.push_back(tracklet);
      newest = std::max(newest, tracklet.time);
      if (uniform(random) > 0.1) continue;
      TrackletTrack fresh({}, 100.0);
      for (const Tracklet& it : given) fresh.add({"a", 1}, 1, it);
      ASSERT_EQ(track.stateAt(newest)->mean, fresh.stateAt(newest)->mean);
    }
  }
}

TEST(TrackletTrack, WhatASourceSaidCanBeTakenBack) {
  TrackletTrack with({}, 1.0), without({}, 1.0);
  for (int k = 0; k < 50; ++k) {
    Tracklet tracklet;
    tracklet.time = platformTime(0.02 * k);
    tracklet.sensor = "camera";
    tracklet.sighting = sightingOf({0.01 * k, 0.0}, 1e-6 * Eigen::Matrix2d::Identity());
    with.add({"a", 1}, 1, tracklet);
    without.add({"a", 1}, 1, tracklet);
    if (k < 30) continue;
    tracklet.sensor = "other";
    tracklet.sighting = sightingOf({0.3, 0.1}, 1e-6 * Eigen::Matrix2d::Identity());
    with.add({"b", 2}, static_cast<std::uint64_t>(k), tracklet);
    if (k % 7 == 0) with.stateAt(tracklet.time);
  }
  EXPECT_EQ(with.remove({"b", 2}, platformTime(0.0)), std::uint64_t{30});
  EXPECT_FALSE(with.remove({"b", 2}, platformTime(0.0)));
  const AngularState a = *with.stateAt(platformTime(1.0)), b = *without.stateAt(platformTime(1.0));
  EXPECT_EQ(a.mean, b.mean);
  EXPECT_EQ(a.covariance, b.covariance);
  EXPECT_EQ(with.informationBySource().size(), 1u);
}

/// A target on a straight path, seen by `sensors` sensors every 30 ms each, one after the other; the last one
/// may harm from t = 2 s on.
struct Watched {
  int sensors = 3;
  double duration = 5.0;           // [s]
  double bias = 0.0;               // [sigma], in both angles
  double noise = 1.0;              // factor on the last one's sigma
  double from = 2.0, until = 1e9;  // of the harm [s]
  unsigned seed = 1;
};

constexpr double kWatchedSigma = 1e-3;  // [rad]

Vector2d straight(double t) {
  return {0.01 * t, 0.2 - 0.005 * t};
}

std::vector<Tracklet> trackletsOf(const Watched& watched) {
  std::mt19937_64 random(watched.seed);
  std::normal_distribution<double> normal;
  std::vector<Tracklet> tracklets;
  for (int k = 0; 0.03 * k / watched.sensors < watched.duration; ++k) {
    const double t = 0.03 * k / watched.sensors;
    const bool is_last = k % watched.sensors == watched.sensors - 1;
    const bool harms = is_last && t >= watched.from && t < watched.until;
    const double n1 = normal(random), n2 = normal(random);
    Tracklet tracklet;
    tracklet.time = platformTime(t);
    tracklet.sensor = std::string("camera ") + static_cast<char>('a' + k % watched.sensors);
    const Vector2d error =
        (harms ? watched.noise : 1.0) * Vector2d(n1, n2) + (harms ? watched.bias : 0.0) * Vector2d::Ones();
    tracklet.sighting = sightingOf(straight(t) + kWatchedSigma * error,
                                   kWatchedSigma * kWatchedSigma * Eigen::Matrix2d::Identity());
    tracklets.push_back(tracklet);
  }
  return tracklets;
}

EstimatorParams kalmanOf(double ratio) {
  EstimatorParams estimator = estimatorOf(EstimatorKind::kalman);
  estimator.kalman.process_noise_ratio = ratio;
  return estimator;
}

GuardParams noGuard() {
  GuardParams guard;
  guard.enabled = false;
  return guard;
}

LocalKey sourceOf(const Tracklet& tracklet) {
  return {"tracker of " + tracklet.sensor, 1};
}

/// A track that has taken them in this order.
TrackletTrack trackOf(const std::vector<Tracklet>& tracklets, const GuardParams& guard = {}) {
  TrackletTrack track(kalmanOf(1.0), 1.0, guard);
  for (const Tracklet& tracklet : tracklets) {
    track.add(sourceOf(tracklet), 1, tracklet);
    track.stateAt(tracklet.time);
  }
  return track;
}

WatchedSensor verdictOn(const TrackletTrack& track, const std::string& sensor) {
  for (const WatchedSensor& watched : track.sensors()) {
    if (watched.sensor == sensor) return watched;
  }
  ADD_FAILURE() << sensor << " is not watched";
  return {};
}

TEST(TrackletGuard, BiasedSourceIsOutOfTheStateFromWhenItBegan) {
  Watched watched;
  watched.bias = 4.0;
  const std::vector<Tracklet> tracklets = trackletsOf(watched);
  TrackletTrack track = trackOf(tracklets);
  const WatchedSensor found = verdictOn(track, "camera c");
  EXPECT_EQ(found.verdict, SensorVerdict::biased);
  ASSERT_TRUE(found.last);
  const Time began = found.last->began;
  EXPECT_NEAR(seconds(began - platformTime(2.0)), 0.0, 0.1);
  EXPECT_NEAR(found.last->bias(0), 4.0, 1.5);

  std::vector<Tracklet> rest;  // what a fusion has that never had them
  for (const Tracklet& tracklet : tracklets) {
    if (tracklet.sensor != "camera c" || tracklet.time < began) rest.push_back(tracklet);
  }
  TrackletTrack without = trackOf(rest, noGuard());
  const Time end = tracklets.back().time;
  EXPECT_EQ(track.stateAt(end)->mean, without.stateAt(end)->mean);
  EXPECT_EQ(track.stateAt(end)->covariance, without.stateAt(end)->covariance);
  EXPECT_EQ(track.informationBySource().at({"tracker of camera c", 1}), 0.0);
  const std::vector<SensorChange> changes = track.newChanges();
  ASSERT_EQ(changes.size(), 1u);
  EXPECT_EQ(changes[0].sensor, "camera c");
  EXPECT_TRUE(track.newChanges().empty()) << "each is told once";
}

TEST(TrackletGuard, GrownNoiseCountsWithItsVariance) {
  Watched watched;
  watched.noise = 5.0;
  TrackletTrack track = trackOf(trackletsOf(watched));
  const WatchedSensor found = verdictOn(track, "camera c");
  EXPECT_EQ(found.verdict, SensorVerdict::noisy);
  EXPECT_GT(std::sqrt(found.noise_scale), 3.0);
  EXPECT_LT(std::sqrt(found.noise_scale), 8.0);
  auto information = track.informationBySource();
  EXPECT_LT(information.at({"tracker of camera c", 1}), 0.2 * information.at({"tracker of camera a", 1}));
}

TEST(TrackletGuard, RecoveredSourceCountsAgain) {
  for (const double bias : {0.0, 4.0}) {
    Watched watched;
    watched.bias = bias;
    watched.noise = bias == 0.0 ? 5.0 : 1.0;
    watched.until = 4.0;
    watched.duration = 10.0;
    TrackletTrack track = trackOf(trackletsOf(watched));
    EXPECT_EQ(verdictOn(track, "camera c").verdict, SensorVerdict::healthy) << bias;
    const std::vector<SensorChange> changes = track.newChanges();
    ASSERT_GE(changes.size(), 2u) << bias;
    EXPECT_EQ(changes.front().change.verdict, bias > 0.0 ? SensorVerdict::biased : SensorVerdict::noisy);
    EXPECT_EQ(changes.back().change.verdict, SensorVerdict::healthy);
    auto information = track.informationBySource();
    EXPECT_NEAR(information.at({"tracker of camera c", 1}) / information.at({"tracker of camera a", 1}), 1.0,
                0.1);
  }
}

TEST(TrackletGuard, HealthySourcesChangeNotOneBit) {
  Watched watched;
  watched.duration = 20.0;
  const std::vector<Tracklet> tracklets = trackletsOf(watched);
  TrackletTrack with = trackOf(tracklets), without = trackOf(tracklets, noGuard());
  const Time end = tracklets.back().time;
  EXPECT_TRUE(with.newChanges().empty());
  EXPECT_EQ(with.sensors().size(), 3u);
  EXPECT_EQ(with.stateAt(end)->mean, without.stateAt(end)->mean);
  EXPECT_EQ(with.stateAt(end)->covariance, without.stateAt(end)->covariance);
}

TEST(TrackletGuard, AnyOrderOfArrivalGivesTheSameBitsThroughAlarmsAndRecoveries) {
  int alarms = 0;
  for (unsigned seed = 1; seed <= 10; ++seed) {
    Watched watched;
    watched.seed = seed;
    watched.sensors = 4;
    watched.until = 3.0;
    (seed % 2 == 0 ? watched.bias : watched.noise) = 4.0;
    const std::vector<Tracklet> tracklets = trackletsOf(watched);
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> late(0.0, 0.8);
    std::vector<std::pair<Time, Tracklet>> arrivals;
    for (const Tracklet& it : tracklets) arrivals.emplace_back(it.time + durationOf(late(random)), it);
    std::sort(arrivals.begin(), arrivals.end(),
              [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<Tracklet> shuffled;
    for (const auto& arrival : arrivals) shuffled.push_back(arrival.second);
    TrackletTrack in_order = trackOf(tracklets);
    TrackletTrack out_of_order(kalmanOf(1.0), 1.0);
    Time newest{};
    for (const Tracklet& tracklet : shuffled) {
      EXPECT_TRUE(out_of_order.add(sourceOf(tracklet), 1, tracklet));
      newest = std::max(newest, tracklet.time);
      out_of_order.stateAt(newest);
    }
    const Time end = tracklets.back().time;
    ASSERT_EQ(in_order.stateAt(end)->mean, out_of_order.stateAt(end)->mean) << seed;
    ASSERT_EQ(in_order.stateAt(end)->covariance, out_of_order.stateAt(end)->covariance) << seed;
    alarms += static_cast<int>(in_order.newChanges().size());
  }
  EXPECT_GE(alarms, 10);
}

TEST(TrackletGuard, OfTwoSourcesItIsOnlySaid) {
  Watched watched;
  watched.sensors = 2;
  watched.noise = 5.0;
  const std::vector<Tracklet> tracklets = trackletsOf(watched);
  TrackletTrack with = trackOf(tracklets), without = trackOf(tracklets, noGuard());
  const WatchedSensor found = verdictOn(with, "camera b");
  EXPECT_TRUE(found.undecided);
  EXPECT_NE(found.verdict, SensorVerdict::healthy);
  EXPECT_EQ(found.noise_scale, 1.0);
  const Time end = tracklets.back().time;
  EXPECT_EQ(with.stateAt(end)->mean, without.stateAt(end)->mean);
}

/// Root mean square of the error over t > 1 s of a fusion at every tracklet [rad].
double errorOf(const std::vector<Tracklet>& tracklets, const GuardParams& guard) {
  TrackletTrack track(kalmanOf(1.0), 1.0, guard);
  double squares = 0.0;
  int count = 0;
  for (const Tracklet& tracklet : tracklets) {
    track.add(sourceOf(tracklet), 1, tracklet);
    const AngularState state = *track.stateAt(tracklet.time);
    const double t = seconds(tracklet.time - platformTime(0.0));
    if (t < 1.0) continue;
    squares += (state.angles() - straight(t)).squaredNorm();
    ++count;
  }
  return std::sqrt(squares / count);
}

TEST(TrackletGuard, IsNearlyAsGoodAsAFusionThatKnows) {
  // Six sensors, one of which harms; against a fusion that knows its noise, or leaves it out, from the start.
  for (const bool is_bias : {false, true}) {
    double guarded = 0.0, knowing = 0.0, trusting = 0.0;
    for (unsigned seed = 1; seed <= 40; ++seed) {
      Watched watched;
      watched.sensors = 6;
      watched.duration = 10.0;
      watched.seed = seed;
      (is_bias ? watched.bias : watched.noise) = is_bias ? 2.0 : 4.0;
      const std::vector<Tracklet> tracklets = trackletsOf(watched);
      std::vector<Tracklet> honest;
      for (const Tracklet& tracklet : tracklets) {
        const bool harms = tracklet.sensor == "camera f" && tracklet.time >= platformTime(watched.from);
        if (harms && is_bias) continue;
        honest.push_back(tracklet);
        if (harms) honest.back().sighting.covariance *= 16.0;
      }
      guarded += std::pow(errorOf(tracklets, {}), 2);
      knowing += std::pow(errorOf(honest, noGuard()), 2);
      trusting += std::pow(errorOf(tracklets, noGuard()), 2);
    }
    const double loss = std::sqrt(guarded / knowing), harm = std::sqrt(trusting / knowing);
    std::cout << (is_bias ? "bias 2 sigma" : "noise x4") << ": RMSE over that of a fusion that knows " << loss
              << ", without the guard " << harm << "\n";
    EXPECT_LT(loss, 1.0 + 0.25 * (harm - 1.0));
  }
}

}  // namespace
}  // namespace sightline::core
