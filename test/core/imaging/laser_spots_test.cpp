#include "sightline/core/imaging/laser_spots.h"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

namespace sightline::core {
namespace {

constexpr float kNone = std::numeric_limits<float>::infinity();

LaserSweep sweepOf(double step, bool is_closed = false) {
  LaserSweep sweep;
  sweep.first_angle = -1.0;
  sweep.step = step;
  sweep.min_range = 0.1;
  sweep.max_range = 50.0;
  sweep.is_closed = is_closed;
  return sweep;
}

TEST(LaserSpots, NeighbouringBeamsOnOneThingAreOneSpotInTheirMiddle) {
  const std::vector<float> ranges = {kNone, kNone, 10.0F, 10.1F, 10.0F, kNone, 20.0F, kNone};
  const auto spots = laserSpots(sweepOf(0.01), ranges, {});
  ASSERT_EQ(spots.size(), 2u);
  EXPECT_NEAR(spots[0].angle, -1.0 + 0.03, 1e-12);
  EXPECT_NEAR(spots[0].width, 0.03, 1e-12);
  EXPECT_NEAR(spots[0].range, 10.0333, 1e-3);
  EXPECT_NEAR(spots[1].angle, -1.0 + 0.06, 1e-12);
  EXPECT_NEAR(spots[1].width, 0.01, 1e-12);
}

TEST(LaserSpots, AWallIsNoTargetButAThingInFrontOfItIs) {
  std::vector<float> ranges(200, 20.0F);  // 0.01 rad * 200 * 20 m: 40 m wide
  ranges[100] = ranges[101] = 8.0F;
  const auto spots = laserSpots(sweepOf(0.01), ranges, {});
  ASSERT_EQ(spots.size(), 1u);
  EXPECT_NEAR(spots[0].range, 8.0, 1e-6);
}

TEST(LaserSpots, ReturnsOutOfRangeOrNotFiniteDoNotCount) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(laserSpots(sweepOf(0.01), {0.05F, nan, -kNone, kNone, 60.0F}, {}).empty());
  EXPECT_TRUE(laserSpots(sweepOf(0.01), {}, {}).empty());
  EXPECT_TRUE(laserSpots(sweepOf(0.01, true), {}, {}).empty());
}

TEST(LaserSpots, OnAFullCircleTheLastBeamIsTheNeighbourOfTheFirst) {
  std::vector<float> ranges(628, kNone);
  ranges.front() = ranges.back() = 5.0F;
  const auto open = laserSpots(sweepOf(0.01), ranges, {});
  const auto closed = laserSpots(sweepOf(0.01, true), ranges, {});
  EXPECT_EQ(open.size(), 2u);
  ASSERT_EQ(closed.size(), 1u);
  EXPECT_NEAR(closed[0].width, 0.02, 1e-12);
  EXPECT_NEAR(closed[0].angle, -1.0 + 0.01 * 627.5, 1e-12);
  const std::vector<float> all_round(628, 5.0F);  // a wall all round: no beginning, no end, no target
  EXPECT_TRUE(laserSpots(sweepOf(0.01, true), all_round, {}).empty());
}

TEST(LaserSpots, FewerBeamsThanAskedForAreLeftOut) {
  LaserSpotParams params;
  params.min_beams = 2;
  EXPECT_EQ(laserSpots(sweepOf(0.01), {kNone, 5.0F, kNone, 5.0F, 5.0F, kNone}, params).size(), 1u);
}

}  // namespace
}  // namespace sightline::core
