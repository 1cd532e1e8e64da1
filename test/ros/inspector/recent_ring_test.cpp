#include "sightline/ros/inspector/recent_ring.h"

#include <vector>

#include <gtest/gtest.h>

#include "support/times.h"

namespace {

using sightline::core::seconds;
using sightline::test::at;

struct RingEntry {
  sightline::core::Time arrival{};
};

std::vector<double> arrivalsOf(const sightline_ros::RecentRing<RingEntry>& ring) {
  std::vector<double> arrivals;
  for (const RingEntry& entry : ring) arrivals.push_back(seconds(entry.arrival.time_since_epoch()));
  return arrivals;
}

TEST(RecentRing, HoldsWhatArrivedWithinItsSpan) {
  sightline_ros::RecentRing<RingEntry> ring(100, 2.0);
  for (const double time : {1.0, 2.0, 3.0, 4.5}) ring.add({at(time)});
  EXPECT_EQ(arrivalsOf(ring), (std::vector<double>{3.0, 4.5}));
}

TEST(RecentRing, GivesUpTheOldestWhereThereIsNoMoreRoom) {
  sightline_ros::RecentRing<RingEntry> ring(3, 1e6);
  for (int i = 1; i <= 10000; ++i) ring.add({at(i)});
  EXPECT_EQ(arrivalsOf(ring), (std::vector<double>{9998.0, 9999.0, 10000.0}));
}

}  // namespace
