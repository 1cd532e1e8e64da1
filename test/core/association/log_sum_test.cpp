#include "sightline/core/association/log_sum.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace sightline::core {
namespace {

TEST(LogSum, AddsTermsThatAreGivenByTheirLogarithms) {
  LogSum sum;
  for (const double term : {0.5, 3.0, 1.25}) sum.add(std::log(term));
  EXPECT_NEAR(sum.value(), std::log(4.75), 1e-15);
}

TEST(LogSum, NeitherOverflowsNorVanishes) {
  LogSum large, small;
  for (int k = 0; k < 2; ++k) {
    large.add(5000.0);
    small.add(-5000.0);
  }
  EXPECT_NEAR(large.value(), 5000.0 + std::log(2.0), 1e-12);
  EXPECT_NEAR(small.value(), -5000.0 + std::log(2.0), 1e-12);
}

TEST(LogSum, ImpossibleTermsAddNothing) {
  LogSum sum;
  sum.add(-std::numeric_limits<double>::infinity());
  EXPECT_EQ(sum.value(), -std::numeric_limits<double>::infinity());
  sum.add(1.0);
  sum.add(-std::numeric_limits<double>::infinity());
  EXPECT_DOUBLE_EQ(sum.value(), 1.0);
}

}  // namespace
}  // namespace sightline::core
