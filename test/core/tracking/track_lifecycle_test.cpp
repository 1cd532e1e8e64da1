#include "sightline/core/tracking/track_lifecycle.h"

#include <limits>

#include <gtest/gtest.h>

#include "support/times.h"

namespace sightline::core {
namespace {

using test::at;

constexpr double kInterval = 0.1;  // between sightings [s]
constexpr double kSeen = 1e4;      // likelihood ratio of a scan with a sighting
constexpr double kNotSeen = 0.1;   // and of one without

/// A track that has been sighted `hits` times, the last time at kInterval * (hits - 1).
TrackLifecycle sighted(int hits, const LifecycleParams& params = {}) {
  TrackLifecycle track(at(0.0), 1e-3);
  for (int k = 1; k < hits; ++k) track.noteSighting(at(kInterval * k), kSeen, true, params);
  return track;
}

LifecycleParams byCounts() {
  LifecycleParams params;
  params.by_existence = false;
  return params;
}

TEST(TrackLifecycle, StartsTentativeAndIsConfirmedByMSightings) {
  for (const LifecycleParams& params : {LifecycleParams(), byCounts()}) {
    EXPECT_TRUE(sighted(1, params).isTentative());
    EXPECT_TRUE(sighted(2, params).isTentative());
    EXPECT_EQ(sighted(3, params).status(), TrackStatus::confirmed);
    EXPECT_TRUE(sighted(3, params).isEstablished());
  }
}

TEST(TrackLifecycle, SightingsThatClutterWouldGiveAsOftenDoNotConfirm) {
  TrackLifecycle track(at(0.0), 1e-3);
  for (int k = 1; k < 20; ++k) track.noteSighting(at(kInterval * k), 1.0, true, {});
  EXPECT_TRUE(track.isTentative());
}

TEST(TrackLifecycle, WithoutExistenceATentativeTrackEndsWhenMOfNCannotBeReachedAnyMore) {
  const LifecycleParams params = byCounts();  // 3 of 6
  TrackLifecycle track(at(0.0), 1.0);
  for (int k = 1; k <= 3; ++k) {
    track.noteMiss(at(kInterval * k), kNotSeen, true, params);
    EXPECT_FALSE(track.isOver(at(kInterval * k), params)) << k;
  }
  track.noteMiss(at(0.4), kNotSeen, true, params);
  EXPECT_TRUE(track.isOver(at(0.4), params));
}

TEST(TrackLifecycle, ATentativeTrackEndsWhenItsOddsHaveFallenToAHundredth) {
  TrackLifecycle track(at(0.0), 1e-3);
  track.noteMiss(at(0.001), kNotSeen, true, {});
  EXPECT_FALSE(track.isOver(at(0.001), {}));
  track.noteMiss(at(0.002), kNotSeen, true, {});
  track.noteMiss(at(0.003), kNotSeen, true, {});
  EXPECT_TRUE(track.isOver(at(0.003), {}));
}

TEST(TrackLifecycle, CoastsAfterMissesOrSilenceAndIsConfirmedByTheNextSighting) {
  TrackLifecycle track = sighted(10, byCounts());
  for (int k = 0; k < 3; ++k) track.noteMiss(at(0.9 + 0.01 * k), kNotSeen, true, byCounts());
  track.updateStatus(at(0.93), byCounts());
  EXPECT_EQ(track.status(), TrackStatus::coasting);
  EXPECT_EQ(track.misses(), 3u);
  track.noteSighting(at(1.0), kSeen, true, byCounts());
  EXPECT_EQ(track.status(), TrackStatus::confirmed);
  EXPECT_EQ(track.misses(), 0u);
  track.updateStatus(at(1.35), byCounts());
  EXPECT_EQ(track.status(), TrackStatus::confirmed) << "silence of less than four intervals";
  track.updateStatus(at(1.45), byCounts());
  EXPECT_EQ(track.status(), TrackStatus::coasting);
}

TEST(TrackLifecycle, AnEstablishedTrackIsLostAfterSilenceAndOverWhenItIsForgotten) {
  LifecycleParams params;
  params.delete_silence = 2.0;
  params.remember = 5.0;
  TrackLifecycle track = sighted(10, params);  // last sighted at 0.9 s
  track.updateStatus(at(2.8), params);
  EXPECT_FALSE(track.isLost());
  track.updateStatus(at(3.0), params);
  EXPECT_TRUE(track.isLost());
  EXPECT_TRUE(track.isMissing());
  EXPECT_FALSE(track.isEstablished());
  EXPECT_FALSE(track.isOver(at(5.8), params));
  EXPECT_TRUE(track.isOver(at(6.0), params));
}

TEST(TrackLifecycle, ALostTrackIsEstablishedAgainBySightings) {
  TrackLifecycle track = sighted(10, byCounts());
  track.updateStatus(at(3.0), byCounts());
  ASSERT_TRUE(track.isLost());
  track.noteSighting(at(3.1), kSeen, false, byCounts());
  EXPECT_FALSE(track.isLost());
}

TEST(TrackLifecycle, AskingWhetherItIsOverChangesNothing) {
  const TrackLifecycle track = sighted(10);
  EXPECT_TRUE(track.isEstablished());
  EXPECT_FALSE(track.isOver(at(100.0), {})) << "its status is not up to date";
  EXPECT_TRUE(track.isEstablished());
  EXPECT_EQ(track.status(), TrackStatus::confirmed);
}

TEST(TrackLifecycle, LimitsOnSilenceAreInUnitsOfTimeAndAtLeastFourUsualIntervals) {
  const LifecycleParams params;  // coasts after 0.3 units, lost after 2
  for (const double unit : {1.0, 30.0}) {
    TrackLifecycle track(at(0.0), 1e-3);
    track.setUnit(unit);
    for (int k = 1; k < 10; ++k) track.noteSighting(at(0.2 * unit * k), kSeen, true, params);
    EXPECT_DOUBLE_EQ(track.leastSilence(), 0.8 * unit);
    const auto statusAfter = [&](double silence) {
      TrackLifecycle later = track;
      later.updateStatus(at(1.8 * unit + silence), params);
      return later.isLost() ? TrackStatus::tentative : later.status();  // tentative stands for lost here
    };
    EXPECT_EQ(statusAfter(0.79 * unit), TrackStatus::confirmed);
    EXPECT_EQ(statusAfter(0.81 * unit), TrackStatus::coasting);
    EXPECT_EQ(statusAfter(1.99 * unit), TrackStatus::coasting);
    EXPECT_EQ(statusAfter(2.01 * unit), TrackStatus::tentative);
  }
}

TEST(TrackLifecycle, WhileNoIntervalIsKnownSilenceMeansNothing) {
  TrackLifecycle track(at(0.0), 1.0);
  track.setUnit(std::numeric_limits<double>::infinity());
  EXPECT_FALSE(track.isOver(at(1e6), {}));
  track.noteMiss(at(600.0), 0.1, true, {});
  EXPECT_GT(track.existence(), 0.05) << "a miss is a miss, the time until it is nothing";
}

TEST(TrackLifecycle, AMissThatWasNotExpectedToShowTheTargetIsNotCounted) {
  TrackLifecycle track = sighted(5);
  track.noteMiss(at(0.5), 0.9, false, {});
  EXPECT_EQ(track.misses(), 0u);
  EXPECT_DOUBLE_EQ(track.detectionProbability(0.5), sighted(5).detectionProbability(0.5));
}

TEST(TrackLifecycle, DetectionProbabilityMovesFromTheSensorsToTheTracksOwn) {
  TrackLifecycle track(at(0.0), 1e-3);
  EXPECT_DOUBLE_EQ(track.detectionProbability(0.9), 0.9);
  for (int k = 1; k < 300; ++k) {
    if (k % 2 == 0)
      track.noteSighting(at(kInterval * k), kSeen, true, {});
    else
      track.noteMiss(at(kInterval * k), kNotSeen, true, {});
  }
  EXPECT_NEAR(track.detectionProbability(0.9), 0.5, 0.1);
}

TEST(TrackLifecycle, IsMatureFromThirtySightingsWhileConfirmed) {
  EXPECT_FALSE(sighted(29).isMature());
  TrackLifecycle track = sighted(30);
  EXPECT_TRUE(track.isMature());
  track.updateStatus(at(2.9 + 1.0), {});
  EXPECT_FALSE(track.isMature()) << "it coasts";
}

TEST(TrackLifecycle, AReacquiredTrackHasTheSightingsOfBoth) {
  TrackLifecycle track = sighted(3);
  track.resume(sighted(40));
  EXPECT_EQ(track.hits(), 43u);
  EXPECT_EQ(track.hitsSinceFound(), 3u);
}

}  // namespace
}  // namespace sightline::core
