#include "sightline/core/model/angle_range.h"

#include <limits>

#include <gtest/gtest.h>

namespace sightline::core {
namespace {

TEST(AngleRange, RoundedEndsAreWithinTheirRangeAndDegreesAreNot) {
  for (const double azimuth : {double(float(2.0 * kPi)), -6.2832, double(float(kPi)), 0.0}) {
    EXPECT_TRUE(isAzimuth(azimuth)) << azimuth;
  }
  for (const double azimuth : {6.3, -7.0, 180.0, std::numeric_limits<double>::infinity(),
                               std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_FALSE(isAzimuth(azimuth)) << azimuth;
  }
  for (const double elevation : {double(float(0.5 * kPi)), 1.570796327, -1.571}) {
    EXPECT_TRUE(isElevation(elevation)) << elevation;
  }
  for (const double elevation : {1.58, -1.6, 90.0, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_FALSE(isElevation(elevation)) << elevation;
  }
}

TEST(AngleRange, AnElevationBeyondThePoleIsThePole) {
  EXPECT_EQ(withinPoles(1.570796327), 0.5 * kPi);
  EXPECT_EQ(withinPoles(-1.571), -0.5 * kPi);
  EXPECT_EQ(withinPoles(0.3), 0.3);
}

}  // namespace
}  // namespace sightline::core
