#include "sightline/core/fusion/tracklets/tracklet_track.h"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "support/tracklet_platform.h"
#include "support/watched_tracklets.h"

namespace sightline::core {
namespace {

using test::kalmanOf;
using test::noGuard;
using test::platformTime;
using test::straight;
using test::trackletsOf;
using test::Watched;

std::optional<AngularState> stateAt(TrackletTrack& track, Time time) {
  track.advanceTo(time);
  return track.stateAt(time);
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
  EXPECT_FALSE(stateAt(in_order, platformTime(0.0)));
  for (int k = 0; k < 100; ++k) in_order.add({"a", 1}, 1, trackletAt(0.02 * k));
  for (int k = 0; k < 100; ++k) {
    if (k % 10 != 0) shuffled.add({"a", 1}, 1, trackletAt(0.02 * k));
    // every tenth comes nine later
    if (k % 10 == 9) {
      stateAt(shuffled, platformTime(0.02 * k));
      EXPECT_TRUE(shuffled.add({"a", 1}, 1, trackletAt(0.02 * (k - 9))));
      EXPECT_TRUE(shuffled.add({"a", 1}, 1, trackletAt(0.02 * (k - 9)))) << "again: not counted twice";
    }
  }
  const AngularState a = *stateAt(in_order, platformTime(2.0)), b = *stateAt(shuffled, platformTime(2.0));
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
      ASSERT_EQ(stateAt(track, newest)->mean, stateAt(fresh, newest)->mean);
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
    if (k % 7 == 0) stateAt(with, tracklet.time);
  }
  EXPECT_EQ(with.remove({"b", 2}, platformTime(0.0)), std::uint64_t{30});
  EXPECT_FALSE(with.remove({"b", 2}, platformTime(0.0)));
  const AngularState a = *stateAt(with, platformTime(1.0)), b = *stateAt(without, platformTime(1.0));
  EXPECT_EQ(a.mean, b.mean);
  EXPECT_EQ(a.covariance, b.covariance);
  EXPECT_EQ(with.informationBySource().size(), 1u);
}

TEST(TrackletTrack, ATrackletThatTheEstimatorCannotTakeIsDroppedAndTheStateIsAsWithoutIt) {
  EstimatorParams paper;
  paper.kind = EstimatorKind::twbls;
  paper.twbls_form = EstimatorForm::paper;
  paper.twbls.sensor_weight = SensorWeight::ifov;  // throws without
  TrackletTrack with(paper, 0.5, noGuard()), without(paper, 0.5, noGuard());
  for (int k = 0; k < 200; ++k) {
    Tracklet tracklet;
    tracklet.time = platformTime(0.03 * k);
    tracklet.sensor = "camera";
    tracklet.ifov = 1e-3;
    tracklet.sighting = sightingOf({0.01 * std::sin(0.1 * k), 0.1}, 1e-6 * Eigen::Matrix2d::Identity());
    without.add({"a", 1}, static_cast<std::uint64_t>(k), tracklet);
    with.add({"a", 1}, static_cast<std::uint64_t>(k), tracklet);
    if (k % 3 == 0) {
      tracklet.sensor = "camera without ifov";
      tracklet.ifov = std::nan("");
      with.add({"b", 1}, static_cast<std::uint64_t>(k), tracklet);
    }
    ASSERT_NO_THROW(with.advanceTo(tracklet.time)) << k;
    without.advanceTo(tracklet.time);
    ASSERT_EQ(with.stateAt(tracklet.time)->mean, without.stateAt(tracklet.time)->mean) << k;
    ASSERT_EQ(with.stateAt(tracklet.time)->covariance, without.stateAt(tracklet.time)->covariance) << k;
  }
  EXPECT_EQ(with.failures().count, 67u);
  EXPECT_NE(with.failures().latest.find("\"camera without ifov\""), std::string::npos);
  EXPECT_EQ(without.failures().count, 0u);
}

TEST(TrackletTrack, AskingForAStateChangesNothing) {
  TrackletTrack asked({}, 1.0), silent({}, 1.0);
  for (int k = 0; k < 60; ++k) {
    Tracklet tracklet;
    tracklet.time = platformTime(0.03 * k);
    tracklet.sensor = "camera";
    tracklet.sighting = sightingOf({0.01 * k, 0.1}, 1e-6 * Eigen::Matrix2d::Identity());
    for (TrackletTrack* track : {&asked, &silent}) {
      track->add({"a", 1}, static_cast<std::uint64_t>(k), tracklet);
      track->advanceTo(tracklet.time);
    }
    static_cast<const TrackletTrack&>(asked).stateAt(platformTime(100.0));
  }
  const Time end = platformTime(2.0);
  EXPECT_EQ(asked.stateAt(end)->mean, silent.stateAt(end)->mean);
  EXPECT_EQ(asked.stateAt(end)->covariance, silent.stateAt(end)->covariance);
}

LocalKey sourceOf(const Tracklet& tracklet) {
  return {"tracker of " + tracklet.sensor, 1};
}

/// A track that has taken them in this order.
TrackletTrack trackOf(const std::vector<Tracklet>& tracklets, const GuardParams& guard = {}) {
  TrackletTrack track(kalmanOf(1.0), 1.0, guard);
  for (const Tracklet& tracklet : tracklets) {
    track.add(sourceOf(tracklet), 1, tracklet);
    stateAt(track, tracklet.time);
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
  EXPECT_EQ(stateAt(track, end)->mean, stateAt(without, end)->mean);
  EXPECT_EQ(stateAt(track, end)->covariance, stateAt(without, end)->covariance);
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
  EXPECT_EQ(stateAt(with, end)->mean, stateAt(without, end)->mean);
  EXPECT_EQ(stateAt(with, end)->covariance, stateAt(without, end)->covariance);
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
      stateAt(out_of_order, newest);
    }
    const Time end = tracklets.back().time;
    ASSERT_EQ(stateAt(in_order, end)->mean, stateAt(out_of_order, end)->mean) << seed;
    ASSERT_EQ(stateAt(in_order, end)->covariance, stateAt(out_of_order, end)->covariance) << seed;
    alarms += static_cast<int>(in_order.newChanges().size());
  }
  EXPECT_GE(alarms, 10);
}

TEST(TrackletGuard, NewThresholdsHoldFromTheirTimeOnInWhateverOrderTrackletsCome) {
  Watched watched;
  watched.sensors = 4;
  watched.bias = 4.0;
  const std::vector<Tracklet> tracklets = trackletsOf(watched);  // one sensor is off from 2 s on
  SensorHealthParams lenient;
  lenient.noise_threshold = lenient.bias_threshold = 1e9;
  const Time change = platformTime(1.5), back = platformTime(4.0);
  // Late ones come 0.3 s after their time: those of before a change come after it, too.
  const auto run = [&](bool some_are_late, bool changes) {
    TrackletTrack track(kalmanOf(1.0), 1.0);
    std::vector<Tracklet> waiting;
    Time newest{};
    const auto give = [&](const Tracklet& tracklet) {
      EXPECT_TRUE(track.add(sourceOf(tracklet), 1, tracklet));
      newest = std::max(newest, tracklet.time);
      stateAt(track, newest);
    };
    for (std::size_t k = 0; k < tracklets.size(); ++k) {
      const Tracklet& tracklet = tracklets[k];
      while (!waiting.empty() && seconds(tracklet.time - waiting.front().time) > 0.3) {
        give(waiting.front());
        waiting.erase(waiting.begin());
      }
      const bool passes_change = k > 0 && tracklets[k - 1].time <= change && tracklet.time > change;
      const bool passes_back = k > 0 && tracklets[k - 1].time <= back && tracklet.time > back;
      if (changes && passes_change) track.setThresholds(lenient, change);
      if (changes && passes_back) track.setThresholds(SensorHealthParams{}, back);
      if (some_are_late && k % 5 == 2) {
        waiting.push_back(tracklet);
      } else {
        give(tracklet);
      }
    }
    for (const Tracklet& tracklet : waiting) give(tracklet);
    return track;
  };
  TrackletTrack in_order = run(false, true), late = run(true, true), unchanged = run(false, false);
  const Time end = tracklets.back().time;
  EXPECT_EQ(stateAt(in_order, end)->mean, stateAt(late, end)->mean);
  EXPECT_EQ(stateAt(in_order, end)->covariance, stateAt(late, end)->covariance);
  ASSERT_TRUE(verdictOn(unchanged, "camera d").last);
  EXPECT_LT(seconds(verdictOn(unchanged, "camera d").last->time - platformTime(2.0)), 0.5);
  for (const TrackletTrack* track : {&in_order, &late}) {
    ASSERT_TRUE(verdictOn(*track, "camera d").last);
    EXPECT_GT(verdictOn(*track, "camera d").last->time, back) << "not judged before the thresholds are back";
  }
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
  EXPECT_EQ(stateAt(with, end)->mean, stateAt(without, end)->mean);
}

/// Root mean square of the error over t > 1 s of a fusion at every tracklet [rad].
double errorOf(const std::vector<Tracklet>& tracklets, const GuardParams& guard) {
  TrackletTrack track(kalmanOf(1.0), 1.0, guard);
  double squares = 0.0;
  int count = 0;
  for (const Tracklet& tracklet : tracklets) {
    track.add(sourceOf(tracklet), 1, tracklet);
    const AngularState state = *stateAt(track, tracklet.time);
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
