// A local tracker that is told nothing, at any pace: kinds of input that users have.

#include <cmath>
#include <functional>
#include <random>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "sightline/core/model/sphere.h"
#include "sightline/core/tracking/local_tracker.h"

namespace sightline::core {
namespace {

struct Input {
  int sightings = 60;
  double interval = 0.1;                         ///< [s]
  std::function<Eigen::Vector2d(double)> truth;  ///< (azimuth, elevation) [rad] after so many seconds
  Eigen::Vector2d sigma{3e-4, 3e-4};             ///< stated and true [rad]
  int sensors = 1;                               ///< that look in turn
  double noise_over_stated = 1.0;
};

struct Outcome {
  int first = 0;          ///< scan that confirmed a track, from 1; 0 = none
  int scans_without = 0;  ///< after that, without a confirmed track
  std::set<std::uint32_t> ids;
  double last_error = 0.0;  ///< of the track [rad]
};

Outcome track(const Input& input, const std::string& estimator, unsigned seed) {
  LocalTrackerParams params;
  for (const EstimatorEntry& entry : estimatorTable())
    if (estimator == entry.name) params.estimator.kind = entry.kind;
  LocalTracker tracker(params);
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  Outcome outcome;
  for (int k = 0; k < input.sightings; ++k) {
    const double time = input.interval * k;
    const Eigen::Vector2d truth = input.truth(time);
    const Eigen::Vector2d noise =
        input.noise_over_stated * input.sigma.cwiseProduct(Eigen::Vector2d(normal(random), normal(random)));
    Scan scan;
    scan.time = Time(durationOf(1000.0 + time));
    scan.sensor = "eye " + std::to_string(k % input.sensors);
    scan.sightings.push_back(sightingOf(truth + noise, input.sigma.cwiseAbs2().asDiagonal()));
    const ScanReport report = tracker.onScan(scan);
    bool is_held = false;
    for (const Track& track : report.tracks) {
      if (track.status == TrackStatus::tentative) continue;
      is_held = true;
      outcome.ids.insert(track.id);
      outcome.last_error = angleBetween(directionOf(track.state.angles()), directionOf(truth));
    }
    if (is_held && outcome.first == 0) outcome.first = k + 1;
    if (!is_held && outcome.first > 0) ++outcome.scans_without;
  }
  return outcome;
}

class AnyPace : public testing::TestWithParam<std::string> {
 protected:
  void expectOneTrack(const Input& input, int confirmed_by, const std::string& what,
                      unsigned seed = 1) const {
    const Outcome outcome = track(input, GetParam(), seed);
    EXPECT_EQ(outcome.ids.size(), 1u) << what;
    EXPECT_GE(outcome.first, 3) << what;
    EXPECT_LE(outcome.first, confirmed_by) << what;
    EXPECT_EQ(outcome.scans_without, 0) << what;
    EXPECT_LT(outcome.last_error, 5.0 * input.noise_over_stated * input.sigma.maxCoeff()) << what;
  }
};

Input steady(double interval, double rate, double sigma = 3e-4) {
  Input input;
  input.interval = interval;
  input.sigma.setConstant(sigma);
  input.truth = [rate](double t) { return Eigen::Vector2d(0.1 + rate * t, 0.3 - 0.02 * rate * t); };
  return input;
}

TEST_P(AnyPace, FromTenMillisecondsToTenMinutesATargetHasOneTrack) {
  for (const double interval : {0.01, 0.033, 0.5, 2.0, 2.1, 4.0, 10.0, 60.0, 180.0, 600.0}) {
    for (unsigned seed = 1; seed <= 5; ++seed) {
      expectOneTrack(steady(interval, 0.6 * 3e-4 / interval), 4, std::to_string(interval) + " s, slow", seed);
      expectOneTrack(steady(interval, std::min(0.02, 0.1 / interval)), 4,
                     std::to_string(interval) + " s, moving", seed);
    }
  }
}

TEST_P(AnyPace, AStarAndWhatFliesByHaveOneTrackEach) {
  for (const double rate : {0.5, 1.0, 3.0, 10.0})
    expectOneTrack(steady(1.0 / 30.0, rate, 1e-3), 5, std::to_string(rate) + " rad/s");
  expectOneTrack(steady(600.0, 7.3e-5), 4, "the sky turns");
}

TEST_P(AnyPace, ATargetThatGoesRoundItsSensorKeepsItsId) {
  for (const auto& [rate_hz, rate] : {std::pair{100.0, 0.8}, {30.0, 0.6}, {10.0, 0.4}}) {
    Input round;
    round.interval = 1.0 / rate_hz;
    round.sightings = static_cast<int>(20.0 / rate * rate_hz);
    round.sigma.setConstant(1e-3);
    const double turning = rate;
    round.truth = [turning](double t) { return Eigen::Vector2d(wrapAngle(0.1 + turning * t), 0.3); };
    expectOneTrack(round, 5, std::to_string(rate_hz) + " Hz");
  }
}

TEST_P(AnyPace, DirectionFindersOfTenDegreesHaveOneTrack) {
  for (const int sensors : {1, 5}) {
    Input coarse;
    coarse.interval = 1.0 / sensors;
    coarse.sensors = sensors;
    coarse.sightings = 200;
    coarse.sigma = {0.0524, 0.1745};
    coarse.truth = [](double t) { return Eigen::Vector2d(0.1 + 0.005 * t, 0.0); };
    const Outcome outcome = track(coarse, GetParam(), 3);
    EXPECT_EQ(outcome.ids.size(), 1u) << sensors;
    EXPECT_GT(outcome.first, 0) << sensors;
    EXPECT_LE(outcome.first, 20) << sensors;
  }
}

/// A pass of a satellite as it is looked at every ten seconds, from 0.35 rad of elevation to `highest` above
/// that; `phase`: of a step, by which all looks come later.
Input satellitePass(double highest, double phase) {
  Input pass;
  pass.sightings = 9;
  pass.interval = 10.3;
  pass.sigma.setConstant(5e-4);
  pass.noise_over_stated = 0.0;
  pass.truth = [highest, phase](double t) {
    const double i = t / 10.3 + phase;
    return Eigen::Vector2d(wrapAngle(0.5 + 2.2 / (1.0 + std::exp(-(i - 4.0) / 2.0))),
                           0.35 + highest * std::exp(-(i - 4.0) * (i - 4.0) / 9.0));
  };
  return pass;
}

TEST_P(AnyPace, APassOfASatelliteInTenSecondStepsHasOneTrack) {
  for (const double highest : {0.0, 0.5}) {
    for (const double phase : {0.0, 1.0 / 3.0}) {
      const Outcome outcome = track(satellitePass(highest, phase), GetParam(), 1);
      EXPECT_EQ(outcome.ids.size(), 1u) << highest << ", " << phase;
      EXPECT_GT(outcome.first, 0) << highest << ", " << phase;
      EXPECT_LE(outcome.first, 7) << highest << ", " << phase;
      EXPECT_EQ(outcome.scans_without, 0) << highest << ", " << phase;
    }
  }
}

// By sigmas a thousand times too small any three sightings contradict each other: until that is found out
// the track may be lost for some sightings. In one run of ten it may be found again as another.
TEST_P(AnyPace, AVarianceGivenForTheSigmaIsFoundOutAndTheTargetHasOneTrack) {
  int with_one_id = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    Input wrong = steady(0.1, 0.002, 1e-6);
    wrong.noise_over_stated = 1e3;
    const Outcome outcome = track(wrong, GetParam(), seed);
    if (outcome.ids.size() == 1) ++with_one_id;
    EXPECT_LE(outcome.ids.size(), 2u) << seed;
    EXPECT_LE(outcome.first, 14) << seed;
    EXPECT_LE(outcome.scans_without, 6) << seed;
    EXPECT_LT(outcome.last_error, 5e-3) << seed;
  }
  EXPECT_GE(with_one_id, 18);
}

INSTANTIATE_TEST_SUITE_P(LocalTracker, AnyPace, testing::ValuesIn(estimatorNames()),
                         [](const auto& info) { return info.param; });

}  // namespace
}  // namespace sightline::core
