#include "sightline/core/model/time.h"

#include <limits>

#include <gtest/gtest.h>

namespace sightline::core {
namespace {

TEST(Time, DurationsAreRoundedToTheNanosecond) {
  EXPECT_EQ(durationOf(1.25).count(), 1'250'000'000);
  EXPECT_EQ(durationOf(-0.4e-9).count(), 0);
  EXPECT_EQ(durationOf(0.6e-9).count(), 1);
  EXPECT_DOUBLE_EQ(seconds(durationOf(-3e8)), -3e8);
}

TEST(Time, WhatIsLongerThanAHundredYearsIsAsLong) {
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double length : {3.2e9, 1e12, 1e300, infinity}) {
    EXPECT_EQ(durationOf(length), kLongestDuration) << length;
    EXPECT_EQ(durationOf(-length), -kLongestDuration) << length;
  }
  const Time today = timeOf(1'800'000'000'000'000'000);
  EXPECT_GT(today + durationOf(infinity), today);
  EXPECT_LT(today - durationOf(infinity), today);
  EXPECT_EQ(durationOf(std::numeric_limits<double>::quiet_NaN()), Duration::zero());
}

}  // namespace
}  // namespace sightline::core
