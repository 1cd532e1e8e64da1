#include "sightline/core/sensors/view_overlap.h"

#include <vector>

#include <gtest/gtest.h>

#include "sightline/core/model/sphere.h"

namespace {

using sightline::core::directionOf;
using sightline::core::durationOf;
using sightline::core::Glimpse;
using sightline::core::separation;
using sightline::core::Time;

std::vector<Glimpse> glimpsesAt(double azimuth, double from, int count, double period = 0.05) {
  std::vector<Glimpse> glimpses;
  for (int k = 0; k < count; ++k)
    glimpses.push_back({Time(durationOf(from + period * k)), directionOf({azimuth, 0.0})});
  return glimpses;
}

TEST(ViewOverlap, SeparationIsTheAngleBetweenWhatIsSeen) {
  EXPECT_NEAR(*separation(glimpsesAt(0.5, 0.0, 50), glimpsesAt(-0.7, 0.0, 50)), 1.2, 1e-9);
  EXPECT_NEAR(*separation(glimpsesAt(3.1, 0.0, 50), glimpsesAt(-3.1, 0.0, 50)), 0.0832, 1e-3) << "wrapped";
}

TEST(ViewOverlap, OneGlimpseOfMostScansNearAnothersIsEnoughAmongFalseOnes) {
  auto mine = glimpsesAt(2.0, 0.0, 300);
  for (std::size_t k = 0; k < mine.size(); ++k) {
    mine[k].time = Time(durationOf(0.05 * static_cast<double>(k / 5)));
    if (k % 5 == 0 && k % 4 != 0) mine[k].direction = directionOf({0.3, 0.0});  // seen in three scans of four
  }
  EXPECT_NEAR(*separation(mine, glimpsesAt(0.3, 0.0, 60)), 0.0, 1e-9);
}

TEST(ViewOverlap, MeetingNowAndThenIsNotSeeingTheSame) {
  auto mine = glimpsesAt(2.0, 0.0, 60);
  for (std::size_t k = 0; k < mine.size(); k += 3) mine[k].direction = directionOf({0.3, 0.0});
  EXPECT_NEAR(*separation(mine, glimpsesAt(0.3, 0.0, 60)), 1.7, 1e-9);
}

TEST(ViewOverlap, IsNotDeterminedForOtherTimesOrFewGlimpses) {
  EXPECT_FALSE(separation(glimpsesAt(0.0, 0.0, 50), glimpsesAt(0.0, 3600.0, 50)));
  EXPECT_FALSE(separation(glimpsesAt(0.0, 0.0, 9), glimpsesAt(0.0, 0.0, 50)));
  EXPECT_FALSE(separation({}, {}));
}

}  // namespace
