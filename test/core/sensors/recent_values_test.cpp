#include "sightline/core/sensors/recent_values.h"

#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>

namespace {

using sightline::core::RecentValues;

TEST(RecentValues, NothingIsKnownBeforeTheFirst) {
  EXPECT_FALSE(RecentValues{}.quantile(0.5));
  EXPECT_THROW(RecentValues{0}, std::invalid_argument);
}

TEST(RecentValues, QuantilesAreThoseOfTheWindow) {
  RecentValues values(100);
  for (int k = 100; k >= 1; --k) values.add(0.001 * k);
  EXPECT_DOUBLE_EQ(*values.quantile(0.5), 0.050);
  EXPECT_DOUBLE_EQ(*values.quantile(0.95), 0.095);
  EXPECT_DOUBLE_EQ(*values.quantile(0.0), 0.001);
  EXPECT_DOUBLE_EQ(*values.quantile(1.0), 0.100);
}

TEST(RecentValues, OldOnesAreForgottenOneByOne) {
  RecentValues values(3);
  for (const double value : {9.0, 9.0, 1.0, 2.0}) values.add(value);
  EXPECT_EQ(values.size(), 3u);
  EXPECT_EQ(*values.quantile(0.5), 2.0);
  values.add(3.0);
  EXPECT_EQ(*values.quantile(1.0), 3.0);
}

TEST(RecentValues, WhatIsNotFiniteIsLeftOut) {
  RecentValues values;
  values.add(std::numeric_limits<double>::quiet_NaN());
  values.add(std::numeric_limits<double>::infinity());
  EXPECT_EQ(values.size(), 0u);
}

}  // namespace
