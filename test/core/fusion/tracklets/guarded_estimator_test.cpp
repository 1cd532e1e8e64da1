#include "sightline/core/fusion/tracklets/guarded_estimator.h"

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "support/tracklet_platform.h"
#include "support/watched_tracklets.h"

namespace sightline::core {
namespace {

using test::kalmanOf;
using test::noGuard;
using test::platformTime;
using test::trackletsOf;
using test::Watched;

/// A guarded estimator with the tracklets that it was given.
struct Given {
  explicit Given(const GuardParams& guard = {}, double keep = 1.0) : estimator(kalmanOf(1.0), guard, keep) {}

  void take(const Tracklet& tracklet) {
    estimator.take(tracklet,
                   [this](std::size_t back) -> const Tracklet& { return taken[taken.size() - back]; });
    taken.push_back(tracklet);
  }

  void take(const std::vector<Tracklet>& tracklets) {
    for (const Tracklet& tracklet : tracklets) take(tracklet);
  }

  GuardedEstimator estimator;
  std::vector<Tracklet> taken;
};

WatchedSensor verdictOn(const GuardedEstimator& estimator, const std::string& sensor) {
  for (const WatchedSensor& watched : estimator.sensors()) {
    if (watched.sensor == sensor) return watched;
  }
  ADD_FAILURE() << sensor << " is not watched";
  return {};
}

TEST(GuardedEstimator, KnowsNothingBeforeTheFirstTracklet) {
  EXPECT_FALSE(Given().estimator.stateAt(platformTime(1.0)));
  EXPECT_EQ(Given().estimator.reach(), 0u);
  EXPECT_FALSE(Given().estimator.decides());
}

TEST(GuardedEstimator, WithoutTheGuardItIsTheEstimator) {
  const std::vector<Tracklet> tracklets = trackletsOf(Watched());
  Given given(noGuard());
  given.take(tracklets);
  ChartedEstimator plain(makeEstimator(kalmanOf(1.0)), tracklets.front());
  for (std::size_t k = 1; k < tracklets.size(); ++k) plain.update(tracklets[k]);
  const Time end = tracklets.back().time;
  EXPECT_EQ(given.estimator.stateAt(end)->mean, plain.stateAt(end).mean);
  EXPECT_EQ(given.estimator.stateAt(end)->covariance, plain.stateAt(end).covariance);
  EXPECT_EQ(given.estimator.reach(), 0u) << "nothing has to be taken again";
}

TEST(GuardedEstimator, AnAlarmChangesTheUseOfTheSensorsTrackletsSinceTheChangeBegan) {
  Watched watched;
  watched.bias = 4.0;
  watched.duration = 2.6;
  const std::vector<Tracklet> tracklets = trackletsOf(watched);
  Given given;
  given.take(tracklets);
  const WatchedSensor found = verdictOn(given.estimator, "camera c");
  ASSERT_EQ(found.verdict, SensorVerdict::biased);
  ASSERT_GT(given.estimator.reach(), 60u);
  for (std::size_t back = 1; back <= given.estimator.reach(); ++back) {
    const Tracklet& tracklet = tracklets[tracklets.size() - back];
    const bool is_off = tracklet.sensor == "camera c" && tracklet.time >= found.last->began;
    EXPECT_EQ(given.estimator.useOf(back).is_excluded, is_off) << back;
    EXPECT_EQ(given.estimator.useOf(back).noise_scale, 1.0) << back;
  }
  EXPECT_TRUE(given.estimator.holdsAnything());
}

TEST(GuardedEstimator, BlamesTheSensorThatIsOffAndNotTheOthersThatItMakesLookWrong) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    Watched watched;
    watched.seed = seed;
    watched.bias = 3.0;
    Given given;
    given.take(trackletsOf(watched));
    for (const SensorChange& change : given.estimator.changes()) EXPECT_EQ(change.sensor, "camera c") << seed;
    EXPECT_FALSE(given.estimator.changes().empty()) << seed;
  }
}

TEST(GuardedEstimator, RemembersUsesForTheTimeItMayRollBackAndNoLonger) {
  Watched watched;
  watched.duration = 30.0;  // 100 tracklets a second
  GuardParams guard;
  guard.roll_back = 1.5;
  Given shorter(guard, 0.1), longer(guard, 5.0);
  for (const Tracklet& tracklet : trackletsOf(watched)) {
    shorter.take(tracklet);
    longer.take(tracklet);
    EXPECT_LE(shorter.estimator.reach(), 190u);
    EXPECT_LE(longer.estimator.reach(), 540u);
  }
  EXPECT_GE(shorter.estimator.reach(), 150u);
  EXPECT_GE(longer.estimator.reach(), 500u);
}

TEST(GuardedEstimator, CopiesAreIndependent) {
  Watched watched;
  watched.bias = 4.0;
  watched.from = 3.0;
  const std::vector<Tracklet> tracklets = trackletsOf(watched);
  const std::size_t half = tracklets.size() / 2;
  Given original;
  original.take({tracklets.begin(), tracklets.begin() + static_cast<std::ptrdiff_t>(half)});
  Given copy = original;
  const Time time = tracklets[half].time;
  const AngularState before = *original.estimator.stateAt(time);
  copy.take({tracklets.begin() + static_cast<std::ptrdiff_t>(half), tracklets.end()});  // with an alarm
  EXPECT_TRUE(copy.estimator.holdsAnything());
  EXPECT_FALSE(original.estimator.holdsAnything());
  EXPECT_EQ(original.estimator.stateAt(time)->mean, before.mean);
  original.take({tracklets.begin() + static_cast<std::ptrdiff_t>(half), tracklets.end()});
  const Time end = tracklets.back().time;
  EXPECT_EQ(original.estimator.stateAt(end)->mean, copy.estimator.stateAt(end)->mean);
  EXPECT_EQ(original.estimator.stateAt(end)->covariance, copy.estimator.stateAt(end)->covariance);
}

TEST(GuardedEstimator, DecidesWhenThreeSensorsAreInUse) {
  for (const int sensors : {2, 3}) {
    Watched watched;
    watched.sensors = sensors;
    watched.duration = 1.0;
    Given given;
    given.take(trackletsOf(watched));
    EXPECT_EQ(given.estimator.decides(), sensors == 3);
  }
}

}  // namespace
}  // namespace sightline::core
