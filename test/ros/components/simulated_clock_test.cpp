#include "sightline/ros/components/simulated_clock.h"

#include <gtest/gtest.h>

#include "support/times.h"

namespace {

using sightline::test::at;
using sightline_ros::SimulatedClock;

TEST(SimulatedClock, SmallStepsBackAreNoneAndAddUp) {
  SimulatedClock clock;
  EXPECT_FALSE(clock.stepBack(at(100.0), 1.0));
  EXPECT_FALSE(clock.stepBack(at(99.5), 1.0));
  EXPECT_FALSE(clock.stepBack(at(99.0), 1.0)) << "the tolerance itself is none";
  EXPECT_NEAR(clock.stepBack(at(98.9), 1.0).value_or(0.0), 1.1, 1e-9);
}

TEST(SimulatedClock, CountsFromWhereTimeWentBackTo) {
  SimulatedClock clock;
  clock.stepBack(at(100.0), 1.0);
  EXPECT_NEAR(clock.stepBack(at(10.0), 1.0).value_or(0.0), 90.0, 1e-9);
  EXPECT_FALSE(clock.stepBack(at(9.5), 1.0));
  EXPECT_FALSE(clock.stepBack(at(50.0), 1.0));
  EXPECT_NEAR(clock.stepBack(at(48.0), 1.0).value_or(0.0), 2.0, 1e-9);
}

}  // namespace
