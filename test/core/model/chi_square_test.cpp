#include "sightline/core/model/chi_square.h"

#include <cmath>

#include <gtest/gtest.h>

namespace sightline::core {
namespace {

// Reference values: tables of the chi-square distribution (Abramowitz and Stegun, table 26.8).
TEST(ChiSquare, QuantilesOfTwoDegreesOfFreedomAreThoseOfTheTable) {
  EXPECT_NEAR(chiSquareQuantile2(0.95), 5.991464547107979, 1e-12);
  EXPECT_NEAR(chiSquareQuantile2(0.999), 13.815510557964274, 1e-11);
  EXPECT_DOUBLE_EQ(chiSquareQuantile2(0.0), 0.0);
}

TEST(ChiSquare, QuantilesOfFourDegreesOfFreedomAreThoseOfTheTable) {
  EXPECT_NEAR(chiSquareQuantile4(0.5), 3.356693980033321, 1e-11);
  EXPECT_NEAR(chiSquareQuantile4(0.95), 9.487729036781154, 1e-11);
  EXPECT_NEAR(chiSquareQuantile4(0.999), 18.46682695290317, 1e-10);
}

TEST(ChiSquare, AQuantileOfFourIsTheInverseOfTheDistribution) {
  for (const double probability : {1e-6, 0.01, 0.3, 0.7, 0.99, 1.0 - 1e-9}) {
    const double x = chiSquareQuantile4(probability);
    EXPECT_NEAR(1.0 - std::exp(-0.5 * x) * (1.0 + 0.5 * x), probability, 1e-14) << probability;
  }
}

TEST(ChiSquare, TheMedianOfTwoIsItsQuantileAtOneHalf) {
  EXPECT_NEAR(kChiSquareMedian2, chiSquareQuantile2(0.5), 1e-15);
}

}  // namespace
}  // namespace sightline::core
