#include "sightline/core/positions/stations/seen_stations.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "support/times.h"

namespace sightline::core {
namespace {

using test::at;
using Vector = Eigen::Vector3d;

const Vector kTarget(50, 50, 10);

StationMeasurement from(int station, double time, const Vector& origin, double sigma = 1e-3,
                        double slow_sigma = 0.0) {
  StationMeasurement m;
  m.time = at(time);
  m.station = station;
  m.ray.origin = origin;
  m.ray.direction = (kTarget - origin).normalized();
  m.ray.covariance =
      sigma * sigma * (Eigen::Matrix3d::Identity() - m.ray.direction * m.ray.direction.transpose());
  m.slow.variance = slow_sigma * slow_sigma;
  return m;
}

TEST(SeenStations, AStationSupportsForAWhileOrForAFewOfItsIntervals) {
  SeenStations seen(0.3, 5.0);
  for (int i = 0; i <= 10; ++i) {
    seen.note(from(0, 0.01 * i, {0, 0, 0}));
    seen.note(from(1, 1.0 * i, {100, 0, 0}));
  }
  EXPECT_EQ(seen.find(2), nullptr);
  ASSERT_NE(seen.find(0), nullptr);
  EXPECT_DOUBLE_EQ(seen.find(0)->since, 0.01);
  EXPECT_TRUE(seen.supports(*seen.find(0), at(0.39)));
  EXPECT_FALSE(seen.supports(*seen.find(0), at(0.41)));
  EXPECT_NEAR(seen.find(1)->interval, 1.0, 1e-9);
  EXPECT_TRUE(seen.supports(*seen.find(1), at(14.9)));
  EXPECT_FALSE(seen.supports(*seen.find(1), at(15.1)));
}

TEST(SeenStations, StationsAtOnePlaceAreAloneTogether) {
  SeenStations seen(0.3, 5.0);
  seen.note(from(0, 1.0, {0, 0, 0}));
  EXPECT_TRUE(seen.isAlone(*seen.find(0), kTarget, at(1.0)));
  seen.note(from(1, 1.0, {0.05, 0, 0}));  // 0.7 mrad at this range, of a sigma of 1 mrad
  EXPECT_TRUE(seen.isAlone(*seen.find(0), kTarget, at(1.0)));
  seen.note(from(2, 1.0, {100, 0, 0}));
  EXPECT_FALSE(seen.isAlone(*seen.find(0), kTarget, at(1.0)));
  EXPECT_TRUE(seen.isAlone(*seen.find(0), kTarget, at(1.5))) << "the others are silent";
}

TEST(SeenStations, AStationIsAtRestUntilItsMoveIsSeenFromTheTarget) {
  SeenStations seen(0.3, 5.0);
  const SeenStation& station = seen.note(from(0, 1.0, {0, 0, 0}));
  const double seen_from_target = 3.0 * 1e-3 * kTarget.norm();
  EXPECT_TRUE(SeenStations::isAtRest(station, {0, 0, 0.9 * seen_from_target}, kTarget));
  EXPECT_FALSE(SeenStations::isAtRest(station, {0, 0, 1.1 * seen_from_target}, kTarget));
}

TEST(SeenStations, TheSharpestOfThoseThatSupportDecideWhatIsResolved) {
  SeenStations seen(0.3, 5.0);
  seen.note(from(0, 1.0, {0, 50, 10}, 1e-3));         // 50 m away: 0.05 m
  seen.note(from(1, 1.0, {50, 150, 10}, 0.0, 1e-2));  // 100 m: 1 m, all of it slow
  EXPECT_NEAR(seen.unitSquared(kTarget, at(1.0)), 2.0 / (1.0 / 0.0025 + 1.0), 1e-9);
  seen.note(from(1, 2.0, {50, 150, 10}, 0.0, 1e-2));
  EXPECT_NEAR(seen.unitSquared(kTarget, at(2.0)), 1.0, 1e-9) << "the first is gone";
  EXPECT_NEAR(seen.unitSquared(kTarget, at(9.0)), 2.0 / (1.0 / 0.0025 + 1.0), 1e-9) << "both are gone";
}

TEST(SeenStations, SupportIsCountedWithItsParallax) {
  SeenStations seen(0.3, 5.0);
  EXPECT_EQ(seen.supportOf(kTarget, at(0.0)).stations, 0);
  seen.note(from(0, 1.0, {0, 50, 10}));
  seen.note(from(1, 1.0, {50, -50, 10}));
  const auto both = seen.supportOf(kTarget, at(1.0));
  EXPECT_EQ(both.stations, 2);
  EXPECT_NEAR(both.nearest, 50.0, 1e-9);
  EXPECT_NEAR(both.parallax, std::acos(0.0), 1e-9);
  const auto none = seen.supportOf(kTarget, at(9.0));
  EXPECT_EQ(none.stations, 0);
  EXPECT_NEAR(none.nearest, 50.0, 1e-9);
  EXPECT_EQ(none.parallax, 0.0);
}

TEST(SeenStations, TheStationSilentLongestIsForgottenForANewOne) {
  SeenStations seen(0.3, 5.0);
  for (int i = 0; i < SeenStations::kMostSeen; ++i) seen.note(from(i, i == 3 ? 0.5 : 1.0, {1.0 * i, 0, 0}));
  seen.note(from(100, 1.1, {0, 0, 0}));
  EXPECT_EQ(seen.find(3), nullptr);
  EXPECT_NE(seen.find(100), nullptr);
  EXPECT_EQ(seen.supportOf(kTarget, at(1.1)).stations, SeenStations::kMostSeen);
}

}  // namespace
}  // namespace sightline::core
