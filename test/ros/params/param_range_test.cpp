#include "sightline/ros/params/param_range.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace {

using namespace sightline_ros;

TEST(ParamRange, EndsBelongToClosedRangesAndNotToOpenOnes) {
  EXPECT_TRUE(atLeast(1.0).holds(1.0));
  EXPECT_FALSE(above(1.0).holds(1.0));
  EXPECT_TRUE(between(0.0, 1.0).holds(1.0));
  EXPECT_FALSE(inside(0.0, 1.0).holds(0.0));
  EXPECT_FALSE(inside(0.0, 1.0).holds(1.0));
  EXPECT_TRUE((Range{0.0, 1.0, true, false}.holds(1.0)));
}

TEST(ParamRange, NoRangeHoldsInfinityOrNotANumber) {
  for (const double value : {HUGE_VAL, -HUGE_VAL, std::nan("")}) {
    EXPECT_FALSE(anyNumber().holds(value)) << value;
    EXPECT_FALSE(atLeast(0.0).holds(value)) << value;
  }
  EXPECT_TRUE(anyNumber().holds(-std::numeric_limits<double>::max()));
}

TEST(ParamRange, TextSaysRangeAndUnit) {
  EXPECT_EQ(expectedNumber(anyNumber(), ""), "a number");
  EXPECT_EQ(expectedNumber(atLeast(0.0), "s"), "a number >= 0 [s]");
  EXPECT_EQ(expectedNumber(above(0.5), ""), "a number > 0.5");
  EXPECT_EQ(expectedNumber(inside(0.0, 1.0), "rad"), "a number in (0, 1) [rad]");
  EXPECT_EQ(expectedNumber(Range{0.0, 1.0, true, false}, ""), "a number in (0, 1]");
}

}  // namespace
