#include "sightline/core/positions/position_start.h"

#include <cmath>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "simulated_stations.h"

namespace sightline::core {
namespace {

using test::SimulatedStation;
using Vector = Eigen::Vector3d;

constexpr double kStep = 0.05;  // [s]
const Vector kFirst(30, 40, 20), kVelocity(4, -3, 1);

Vector at(double t) {
  return kFirst + t * kVelocity;
}

PositionStart started(double window = 0.5) {
  return PositionStart(window, 0.3);
}

TEST(PositionStart, TwoStationsTellPositionWithAnHonestCovarianceAndVelocityWithACautiousOne) {
  double position = 0.0, velocity = 0.0;
  int count = 0;
  for (std::uint64_t run = 1; run <= 100; ++run) {
    SimulatedStation a(0, {0, 0, 0}, 5e-4, {1e-7, 3.0}, run), b(1, {100, 0, 2}, 5e-4, {1e-7, 3.0}, run + 500);
    PositionStart waiting = started();
    double t = 0.0;
    for (int i = 0; i <= 10; ++i, t += kStep) {
      waiting.wait(a.see(t, at(t)));
      waiting.wait(b.see(t, at(t)));
    }
    t -= kStep;
    const auto belief = waiting.startAt(Time(durationOf(t)));
    ASSERT_TRUE(belief);
    EXPECT_EQ(belief->slots(), 0);
    const Vector error = belief->mean.head<3>() - at(t), off = belief->mean.segment<3>(3) - kVelocity;
    position += error.dot(belief->covariance.topLeftCorner<3, 3>().llt().solve(error)) / 3.0;
    velocity += off.dot(belief->covariance.block<3, 3>(3, 3).llt().solve(off)) / 3.0;
    ++count;
  }
  EXPECT_GT(position / count, 0.5);
  EXPECT_LT(position / count, 1.3);
  EXPECT_LT(velocity / count, 1.0);  // half of the rate itself is in it, for what it may have changed by
}

TEST(PositionStart, OneStationAloneStartsNothing) {
  SimulatedStation a(0, {0, 0, 0}, 5e-4, {}, 1);
  PositionStart waiting = started();
  EXPECT_FALSE(waiting.newest());
  for (int i = 0; i < 20; ++i) {
    waiting.wait(a.see(i * kStep, at(i * kStep)));
    EXPECT_FALSE(waiting.startAt(Time(durationOf(i * kStep))));
  }
  EXPECT_EQ(waiting.newest(), Time(durationOf(19 * kStep)));
}

TEST(PositionStart, RaysThatContradictEachOtherStartNothing) {
  SimulatedStation a(0, {0, 0, 0}, 5e-4, {}, 1), b(1, {100, 0, 2}, 5e-4, {}, 2);
  PositionStart waiting = started();
  for (int i = 0; i <= 10; ++i) {
    waiting.wait(a.see(i * kStep, at(i * kStep)));
    waiting.wait(b.see(i * kStep, at(i * kStep) + Vector(0, 0, 8)));  // of another target
  }
  EXPECT_FALSE(waiting.startAt(Time(durationOf(0.5))));
}

TEST(PositionStart, WhatIsOlderThanTheWindowOrClearedIsForgotten) {
  SimulatedStation a(0, {0, 0, 0}, 5e-4, {}, 1), b(1, {100, 0, 2}, 5e-4, {}, 2);
  PositionStart waiting = started(0.3);
  for (int i = 0; i <= 4; ++i) waiting.wait(b.see(i * kStep, at(i * kStep)));
  for (int i = 8; i <= 14; ++i) waiting.wait(a.see(i * kStep, at(i * kStep)));
  EXPECT_FALSE(waiting.startAt(Time(durationOf(14 * kStep)))) << "the second station's are too old";
  for (int i = 15; i <= 17; ++i) {
    waiting.wait(a.see(i * kStep, at(i * kStep)));
    waiting.wait(b.see(i * kStep, at(i * kStep)));
  }
  EXPECT_TRUE(waiting.startAt(Time(durationOf(17 * kStep))));
  waiting.clear();
  EXPECT_FALSE(waiting.newest());
  EXPECT_FALSE(waiting.startAt(Time(durationOf(17 * kStep))));
}

TEST(PositionStart, MoreThanItHasRoomForAreKeptAsTheNewest) {
  SimulatedStation a(0, {0, 0, 0}, 5e-4, {}, 1), b(1, {100, 0, 2}, 5e-4, {}, 2);
  PositionStart waiting = started();
  for (int i = 0; i <= 5 * PositionStart::kMostWaiting; ++i) {
    const double t = 0.002 * i;
    waiting.wait(a.see(t, at(t)));
    waiting.wait(b.see(t, at(t)));
  }
  const double end = 0.01 * PositionStart::kMostWaiting;
  const auto belief = waiting.startAt(Time(durationOf(end)));
  ASSERT_TRUE(belief);
  EXPECT_LT((belief->mean.head<3>() - at(end)).norm(), 1.0);
}

}  // namespace
}  // namespace sightline::core
