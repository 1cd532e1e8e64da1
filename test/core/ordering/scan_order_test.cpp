#include "sightline/core/ordering/scan_order.h"

#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace sightline::core {
namespace {

Scan scanOf(double time, const std::string& sensor, const std::vector<double>& azimuths) {
  Scan scan;
  scan.time = Time(durationOf(time));
  scan.sensor = sensor;
  for (const double azimuth : azimuths)
    scan.sightings.push_back(sightingOf({azimuth, 0.0}, 1e-6 * Eigen::Matrix2d::Identity()));
  return scan;
}

Tracklet trackletOf(double time, const std::string& sensor, double azimuth) {
  const Scan scan = scanOf(time, sensor, {azimuth});
  Tracklet tracklet;
  tracklet.time = scan.time;
  tracklet.sensor = sensor;
  tracklet.sighting = scan.sightings.front();
  return tracklet;
}

/// Each item precedes all that follow it, and none before it or itself.
template <typename Item>
void expectInOrder(const std::vector<Item>& items) {
  for (std::size_t i = 0; i < items.size(); ++i) {
    for (std::size_t j = 0; j < items.size(); ++j)
      EXPECT_EQ(precedes(items[i], items[j]), i < j) << i << " and " << j;
  }
}

TEST(ScanOrder, ScansAreOrderedByTimeThenSensorThenContent) {
  expectInOrder<Scan>({scanOf(1.0, "b", {0.3}), scanOf(2.0, "a", {}), scanOf(2.0, "a", {2.0}),
                       scanOf(2.0, "a", {2.0, 0.5}), scanOf(2.0, "a", {1.0}), scanOf(2.0, "b", {2.0}),
                       scanOf(2.1, "a", {})});
}

TEST(ScanOrder, TrackletsAreOrderedLikeScansWithOneSighting) {
  const std::vector<Tracklet> tracklets = {trackletOf(1.0, "b", 0.3), trackletOf(2.0, "a", 2.0),
                                           trackletOf(2.0, "a", 1.0), trackletOf(2.0, "b", 2.0),
                                           trackletOf(2.1, "a", 1.0)};
  expectInOrder(tracklets);
  std::vector<Scan> scans;
  for (const Tracklet& tracklet : tracklets) {
    Scan scan = scanOf(seconds(tracklet.time - Time{}), tracklet.sensor, {});
    scan.sightings = {tracklet.sighting};
    scans.push_back(scan);
  }
  expectInOrder(scans);
}

TEST(ScanOrder, OrdersOfBytesAreByTimeThenSensorThenBytes) {
  const std::vector<ScanOrder> orders = {{Time(durationOf(1.0)), "b", "x"},
                                         {Time(durationOf(2.0)), "a", "x"},
                                         {Time(durationOf(2.0)), "a", "y"},
                                         {Time(durationOf(2.0)), "b", ""}};
  for (std::size_t i = 0; i < orders.size(); ++i) {
    for (std::size_t j = 0; j < orders.size(); ++j) EXPECT_EQ(orders[i] < orders[j], i < j);
  }
}

TEST(ScanOrder, CovariancesDoNotMatter) {
  Scan rough = scanOf(1.0, "a", {0.2});
  rough.sightings.front().covariance *= 4.0;
  EXPECT_FALSE(precedes(rough, scanOf(1.0, "a", {0.2})));
  EXPECT_FALSE(precedes(scanOf(1.0, "a", {0.2}), rough));
}

}  // namespace
}  // namespace sightline::core
