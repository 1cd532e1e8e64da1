#include "sightline/core/tracking/live_track.h"

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "sightline/core/estimators/estimators.h"

namespace sightline::core {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

constexpr double kSigma = 1e-3;     // of every sighting [rad]
constexpr double kInterval = 0.05;  // between scans [s]

/// A sensor that looks every kInterval.
RevisitTime usual() {
  RevisitTime interval;
  interval.note(kInterval);
  return interval;
}

const ScanSensor kSensor{0.9, usual(), true};

Scan scanAt(double t, const Vector2d& angles, const std::string& sensor = "eye") {
  Scan scan;
  scan.time = Time(durationOf(t));
  scan.sensor = sensor;
  scan.sightings = {sightingOf(angles, kSigma * kSigma * Matrix2d::Identity())};
  return scan;
}

EstimatorParams kalman() {
  EstimatorParams params;
  params.kind = EstimatorKind::kalman;
  return params;
}

/// A track of a target that drifts to the left.
class Drifting {
 public:
  explicit Drifting(std::uint32_t id, double azimuth = 0.3)
      : azimuth_(azimuth), track(makeTrack(id, azimuth)) {}

  Vector2d truth(double t) const { return {azimuth_ + 0.02 * t, 0.1}; }

  /// Updates it with noise-free sightings of its scans from number `from` to `to`, the first one included.
  void follow(int from, int to, const std::string& sensor = "eye") {
    for (int k = from; k < to; ++k) {
      const Scan scan = scanAt(kInterval * k, truth(kInterval * k), sensor);
      const TrackPrediction prediction = track.predict(scan, kSensor, {}, true);
      track.update(scan, scan.sightings[0], prediction, {}, 1000.0, {});
    }
  }

 private:
  static LiveTrack makeTrack(std::uint32_t id, double azimuth) {
    const Scan first = scanAt(0.0, {azimuth, 0.1});
    return LiveTrack(id, {first.time, first.sensor}, first, first.sightings[0], makeEstimator(kalman()), 1e-3,
                     usual());
  }

  double azimuth_;

 public:
  LiveTrack track;
};

Track reportOf(const LiveTrack& track, double t) {
  return track.report(Time(durationOf(t)), {}, true, {});
}

TEST(LiveTrack, FollowsItsTargetAndExpectsItWhereItWillBe) {
  Drifting target(7);
  target.follow(1, 60);
  const Track report = reportOf(target.track, 3.0);
  EXPECT_EQ(report.id, 7u);
  EXPECT_EQ(report.status, TrackStatus::confirmed);
  EXPECT_EQ(report.hits, 60u);
  EXPECT_LT((report.state.angles() - target.truth(3.0)).norm(), kSigma);
  EXPECT_NEAR(report.state.rates().x(), 0.02, 5e-3);
  EXPECT_LT((report.gate.centre - target.truth(3.0 + kInterval)).norm(), kSigma);
  EXPECT_EQ(report.sources, std::vector<std::string>{"eye"});
}

TEST(LiveTrack, CopiesAreDeep) {
  Drifting target(1);
  target.follow(1, 20);
  const LiveTrack copy = target.track;
  const Track before = reportOf(copy, 1.0);
  target.follow(20, 40, "other eye");
  const Track after = reportOf(copy, 1.0);
  EXPECT_EQ(before.state.mean, after.state.mean);
  EXPECT_EQ(before.state.covariance, after.state.covariance);
  EXPECT_EQ(before.gate.covariance, after.gate.covariance);
  EXPECT_EQ(before.hits, after.hits);
  EXPECT_EQ(before.sources, after.sources);
}

TEST(LiveTrack, ACopyGoesOnToTheSameBits) {
  Drifting target(1);
  target.follow(1, 20);
  Drifting copy = target;
  target.follow(20, 40);
  copy.follow(20, 40);
  EXPECT_EQ(reportOf(target.track, 2.0).state.mean, reportOf(copy.track, 2.0).state.mean);
  EXPECT_EQ(reportOf(target.track, 2.0).state.covariance, reportOf(copy.track, 2.0).state.covariance);
}

TEST(LiveTrack, ReportingAndAskingChangesNothing) {
  Drifting asked(1), silent(1);
  for (int k = 1; k < 40; ++k) {
    asked.follow(k, k + 1);
    silent.follow(k, k + 1);
    reportOf(asked.track, kInterval * k + 0.3);
    asked.track.isOver(Time(durationOf(kInterval * k + 10.0)), {}, true, NoiseCalibration{{}});
  }
  EXPECT_EQ(reportOf(asked.track, 2.0).state.mean, reportOf(silent.track, 2.0).state.mean);
  EXPECT_EQ(reportOf(asked.track, 2.0).state.covariance, reportOf(silent.track, 2.0).state.covariance);
}

TEST(LiveTrack, ASensorThatHasSeenTheTargetIsExpectedToSeeItUnlessItLooksElsewhere) {
  Drifting target(1);
  target.follow(1, 20);
  Scan scan = scanAt(1.0, target.truth(1.0));
  EXPECT_TRUE(target.track.predict(scan, kSensor, {}, true).is_in_view);
  EXPECT_EQ(target.track.predict(scan, kSensor, {}, true).visibility, 1.0);
  const TrackPrediction of_other = target.track.predict(scanAt(1.0, {0.0, 0.0}, "new"), kSensor, {}, true);
  EXPECT_FALSE(of_other.is_in_view);
  EXPECT_EQ(of_other.visibility, 0.5);
}

TEST(LiveTrack, AMissOfASensorThatSeesTheTargetCountsAndOneOfAnotherDoesNot) {
  Drifting target(1);
  target.follow(1, 20);
  const Scan other = scanAt(1.0, {0.0, 0.0}, "new"), own = scanAt(1.0, {0.0, 0.0});
  target.track.miss(other, target.track.predict(other, kSensor, {}, true), 0.6, {});
  EXPECT_EQ(target.track.lifecycle().misses(), 0u);
  EXPECT_LT(target.track.predict(other, kSensor, {}, true).visibility, 0.5);
  target.track.miss(own, target.track.predict(own, kSensor, {}, true), 0.1, {});
  EXPECT_EQ(target.track.lifecycle().misses(), 1u);
}

TEST(LiveTrack, IsOverWhenItsGateHasGrownFarBeyondTheSightings) {
  Drifting target(1);
  target.follow(1, 60);
  LifecycleParams patient;
  patient.delete_silence = patient.remember = 1e6;
  patient.by_existence = false;
  EXPECT_FALSE(target.track.isOver(Time(durationOf(3.0)), patient, true, NoiseCalibration{{}}));
  EXPECT_TRUE(target.track.isOver(Time(durationOf(3000.0)), patient, true, NoiseCalibration{{}}));
}

TEST(LiveTrack, AFreshTrackWithTheSameMotionIsLikelierAReturnThanOneElsewhere) {
  Drifting lost(1), same(2), elsewhere(3, 0.6);
  lost.follow(1, 40);
  same.follow(1, 60);
  elsewhere.follow(1, 60);
  const Time now(durationOf(3.0));
  EXPECT_GT(lost.track.logDensityOfReturn(same.track, now, 1.0),
            lost.track.logDensityOfReturn(elsewhere.track, now, 1.0) + 10.0);
}

TEST(LiveTrack, ATrackLostBySigmasFarTooSmallReturnsAndIsRememberedByWhatIsSuspected) {
  // By the stated sigma the target is found 200 sigmas off.
  Drifting lost(1), found(2, 0.3 + 200.0 * kSigma);
  lost.follow(1, 40);
  found.follow(40, 43);
  const Time now(durationOf(kInterval * 43));
  EXPECT_GT(lost.track.logDensityOfReturn(found.track, now, 1e4),
            lost.track.logDensityOfReturn(found.track, now, 1.0) + 10.0);

  NoiseCalibration suspicious{NoiseCalibrationParams{}};
  for (int k = 0; k < 4; ++k) {
    Scan scan = scanAt(0.1 * k, {k % 2 == 0 ? 0.3 : 0.301, 0.1});
    scan.sightings[0].covariance *= 1e-10;
    suspicious.takeUntracked(scan);
  }
  ASSERT_GT(suspicious.suspectedScale("eye"), 1e3);
  double time = kInterval * 40;
  while (!lost.track.isOver(Time(durationOf(time)), {}, true, NoiseCalibration{{}})) time += kInterval;
  EXPECT_FALSE(lost.track.isOver(Time(durationOf(time)), {}, true, suspicious));
}

TEST(LiveTrack, AReacquiredTrackHasTheIdAndTheSightingsOfTheLostOne) {
  Drifting lost(1), fresh(9);
  lost.follow(1, 40);
  fresh.follow(1, 5);
  fresh.track.resume(lost.track);
  EXPECT_EQ(fresh.track.id(), 1u);
  EXPECT_EQ(fresh.track.lifecycle().hits(), 45u);
}

TEST(LiveTrack, FollowsATargetAcrossChartsAndTakesItsSensorsAlong) {
  const auto truth = [](double t) { return anglesOf({0.1 * (t - 2.0), 0.02, 1.0}); };  // past the zenith
  const auto scanOf = [&](double t) {
    Scan scan = scanAt(t, {0.0, 0.0});
    const Eigen::Vector3d direction = directionOf(truth(t));
    scan.sightings[0].direction = direction;
    scan.sightings[0].covariance =
        kSigma * kSigma * (Eigen::Matrix3d::Identity() - direction * direction.transpose());
    return scan;
  };
  const Scan first = scanOf(0.0);
  LiveTrack track(1, {}, first, first.sightings[0], makeEstimator(kalman()), 1e-3, usual());
  for (int k = 1; k <= 80; ++k) {
    const Scan scan = scanOf(kInterval * k);
    track.update(scan, scan.sightings[0], track.predict(scan, kSensor, {}, true), {}, 1000.0, {});
    EXPECT_FALSE(track.isOver(scan.time, {}, true, NoiseCalibration{{}}));
  }
  const Track report = reportOf(track, 4.0);
  EXPECT_LT(angleBetween(directionOf(report.state.angles()), directionOf(truth(4.0))), 5.0 * kSigma);
  EXPECT_EQ(report.sources, std::vector<std::string>{"eye"});
}

}  // namespace
}  // namespace sightline::core
