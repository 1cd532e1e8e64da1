#include "sightline/core/model/usable_sighting.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace {

using namespace sightline::core;

Sighting good() {
  const Eigen::Matrix2d R = 1e-6 * Eigen::Matrix2d::Identity();
  return sightingOf({0.3, 0.2}, R);
}

TEST(UsableSighting, WhatSensorsMayStateIsUsable) {
  EXPECT_TRUE(isUsable(good()));
  for (const double sigma : {1e-9, 1e-3, 1.5}) {
    for (const double other : {1e-9, 1e-3, 1.5}) {
      for (const double elevation : {0.0, 1.0, 1.5707}) {
        Eigen::Matrix2d R = Eigen::Vector2d(sigma * sigma, other * other).asDiagonal();
        R(0, 1) = R(1, 0) = 0.999 * sigma * other;
        if (rejectionOf({3.0, elevation}, R)) continue;
        EXPECT_TRUE(isUsable(sightingOf({3.0, elevation}, R))) << sigma << ", " << other << ", " << elevation;
      }
    }
  }
}

TEST(UsableSighting, DirectionsThatAreNoUnitVectorsAreNot) {
  for (const double wrong : {std::numeric_limits<double>::quiet_NaN(), 1e300, 0.0, 2.0}) {
    Sighting sighting = good();
    sighting.direction.x() = wrong;
    EXPECT_FALSE(isUsable(sighting)) << wrong;
  }
}

TEST(UsableSighting, CovariancesThatAreNoneAreNot) {
  for (const double factor : {std::numeric_limits<double>::quiet_NaN(), 0.0, -1.0, 1e9, 1e300, 1e-300}) {
    Sighting sighting = good();
    sighting.covariance *= factor;
    EXPECT_FALSE(isUsable(sighting)) << factor;
  }
  Sighting lopsided = good();
  lopsided.covariance(0, 2) = 1.0;
  EXPECT_FALSE(isUsable(lopsided));
  Eigen::Matrix2d R;
  R << 1e-6, 2e-6, 2e-6, 1e-6;  // indefinite
  EXPECT_FALSE(isUsable(sightingOf({0.3, 0.2}, R)));
}

}  // namespace
