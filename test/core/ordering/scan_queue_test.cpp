#include "sightline/core/ordering/scan_queue.h"

#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "support/times.h"

namespace {

using sightline::core::durationOf;
using sightline::core::ScanOrder;
using sightline::core::ScanQueue;
using sightline::core::Time;
using sightline::test::at;

struct Arrival {
  ScanOrder order;
  double received;  // [s]
};

std::vector<std::string> orderOfRelease(const std::vector<Arrival>& arrivals, double max_lag) {
  ScanQueue<std::string> queue(max_lag);
  std::vector<std::string> names;
  for (const Arrival& arrival : arrivals) {
    EXPECT_TRUE(queue.add(arrival.order, arrival.order.sensor + "/" + arrival.order.content));
    for (auto& name : queue.release()) names.push_back(name);
  }
  for (auto& name : queue.releaseAll()) names.push_back(name);
  return names;
}

TEST(ScanQueue, OrderOfArrivalWithinTheLagDoesNotMatter) {
  constexpr double kLag = 0.5;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> latency(0.0, kLag);
  std::vector<Arrival> arrivals;
  for (int i = 0; i < 300; ++i) {
    // Some stamps coincide: sensor and content break the tie.
    arrivals.push_back(
        {{at(10.0 + 0.02 * (i / 3)), "sensor" + std::to_string(i % 2), std::to_string(i)}, 0.0});
  }
  std::vector<std::string> first;
  for (int trial = 0; trial < 20; ++trial) {
    for (auto& arrival : arrivals) {
      arrival.received = sightline::core::seconds(arrival.order.time - at(0)) + latency(random);
    }
    std::sort(arrivals.begin(), arrivals.end(),
              [](const Arrival& a, const Arrival& b) { return a.received < b.received; });
    const auto names = orderOfRelease(arrivals, kLag);
    ASSERT_EQ(names.size(), arrivals.size());
    if (trial == 0) first = names;
    EXPECT_EQ(names, first);
  }
}

TEST(ScanQueue, ScanIsHeldUntilNothingCanPrecedeIt) {
  ScanQueue<int> queue(0.5);
  EXPECT_TRUE(queue.add({at(1.0), "a", ""}, 1));
  EXPECT_TRUE(queue.release().empty());
  EXPECT_TRUE(queue.add({at(1.5), "a", ""}, 2));
  EXPECT_TRUE(queue.release().empty()) << "a scan of the same instant could still come";
  EXPECT_TRUE(queue.add({at(1.0), "b", ""}, 3));
  EXPECT_TRUE(queue.add({at(1.51), "a", ""}, 4));
  EXPECT_EQ(queue.release(), (std::vector<int>{1, 3}));
  EXPECT_EQ(queue.size(), 2u);
}

TEST(ScanQueue, ScanLaterThanTheLagIsRefused) {
  ScanQueue<int> queue(0.5);
  EXPECT_TRUE(queue.add({at(2.0), "a", ""}, 1));
  EXPECT_TRUE(queue.add({at(1.5), "b", ""}, 2));
  EXPECT_FALSE(queue.add({at(1.499999999), "b", ""}, 3));
  EXPECT_EQ(queue.releaseAll(), (std::vector<int>{2, 1}));
}

TEST(ScanQueue, WithoutLagEveryScanGoesOnAsSoonAsANewerOneIsThere) {
  ScanQueue<int> queue(0.0);
  EXPECT_TRUE(queue.add({at(1.0), "a", ""}, 1));
  EXPECT_TRUE(queue.add({at(2.0), "a", ""}, 2));
  EXPECT_EQ(queue.release(), std::vector<int>{1});
}

TEST(ScanQueue, EmptyQueueReleasesNothing) {
  ScanQueue<int> queue(0.5);
  EXPECT_TRUE(queue.release().empty());
  EXPECT_TRUE(queue.releaseAll().empty());
}

}  // namespace
