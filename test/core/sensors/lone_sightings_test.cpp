#include "sightline/core/sensors/lone_sightings.h"

#include <functional>
#include <random>

#include <gtest/gtest.h>

#include "sightline/core/model/sphere.h"

namespace sightline::core {
namespace {

struct Case {
  double stated = 1e-6;  ///< sigma [rad]
  double noise = 1e-3;   ///< what it is [rad]
  std::function<double(int)> interval = [](int) { return 0.1; };
  double rate = 0.02;  ///< [rad/s]
};

/// The first factor that is asked for over so many scans; 0 = none.
double firstFactor(const Case& given, int scans, unsigned seed = 1) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0.0, given.noise);
  LoneSightings lone;
  double time = 100.0;
  for (int k = 0; k < scans; ++k) {
    Scan scan;
    scan.time = Time(durationOf(time));
    const Eigen::Vector2d angles(0.1 + given.rate * (time - 100.0) + noise(random), 0.3 + noise(random));
    scan.sightings.push_back(sightingOf(angles, given.stated * given.stated * Eigen::Matrix2d::Identity()));
    if (const auto factor = lone.take(scan)) return *factor;
    time += given.interval(k);
  }
  return 0.0;
}

TEST(LoneSightings, FindAStatedSigmaThatIsAThousandTimesTooSmall) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const double factor = firstFactor({}, 20, seed);
    EXPECT_GT(factor, 1e5) << seed;
    EXPECT_LT(factor, 1e7) << seed;
  }
}

TEST(LoneSightings, SuspectFromTheFirstComparisonOn) {
  LoneSightings far_off, right;
  for (int k = 0; k < 6; ++k) {
    EXPECT_EQ(far_off.suspicion().has_value(), k >= 3) << k;
    EXPECT_FALSE(right.suspicion()) << k;
    Scan scan;
    scan.time = Time(durationOf(0.1 * k));
    const double azimuth = k % 2 == 0 ? 1e-3 : -1e-3;
    scan.sightings.push_back(sightingOf({azimuth, 0.0}, 1e-12 * Eigen::Matrix2d::Identity()));
    EXPECT_FALSE(far_off.take(scan));
    scan.sightings[0] = sightingOf({azimuth, 0.0}, 1e-6 * Eigen::Matrix2d::Identity());
    EXPECT_FALSE(right.take(scan));
  }
}

TEST(LoneSightings, BelieveASigmaThatIsAboutRight) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    Case right;
    right.stated = 1e-3;
    EXPECT_EQ(firstFactor(right, 100, seed), 0.0);
    right.stated = 5e-4;
    EXPECT_EQ(firstFactor(right, 20, seed), 0.0);
  }
}

TEST(LoneSightings, FalseSightingsAllOverTheFieldAreNoNoise) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    Case clutter;
    clutter.stated = 1e-3;
    clutter.noise = 0.2;
    EXPECT_EQ(firstFactor(clutter, 100, seed), 0.0);
  }
}

TEST(LoneSightings, UnevenIntervalsTellNothing) {
  Case sparse;
  sparse.interval = [](int k) { return k % 3 == 0 ? 0.1 : 0.5; };
  EXPECT_EQ(firstFactor(sparse, 200), 0.0);
}

TEST(LoneSightings, AScanOfSeveralSightingsStartsAnew) {
  LoneSightings lone;
  Scan scan;
  for (int k = 0; k < 100; ++k) {
    scan.time = Time(durationOf(0.1 * k));
    scan.sightings.assign(k % 5 == 0 ? 2 : 1,
                          sightingOf({k % 2 == 0 ? 1e-3 : -1e-3, 0.0}, 1e-12 * Eigen::Matrix2d::Identity()));
    EXPECT_FALSE(lone.take(scan));
  }
}

}  // namespace
}  // namespace sightline::core
