#include "sightline/ros/recordings/recorded_scans.h"

#include <boost/make_shared.hpp>

#include <gtest/gtest.h>

#include "support/scans.h"
#include "support/scratch_folder.h"

using namespace sightline_ros;
using sightline::SightingArray;

namespace {

constexpr double kMaxLag = 0.2, kMaxFuture = 0.1;  // [s]

SightingArray::ConstPtr scan(const std::string& sensor, double stamp) {
  return boost::make_shared<SightingArray>(scanOf(sensor, stamp, {{0.1, 0.2}}));
}

/// "sensor stamp" of each scan.
std::vector<std::string> namesOf(const std::vector<SightingArray::ConstPtr>& scans) {
  std::vector<std::string> names;
  for (const auto& each : scans)
    names.push_back(each->sensor + " " +
                    std::to_string(static_cast<int>(std::lround(1e3 * each->header.stamp.toSec()))));
  return names;
}

using Names = std::vector<std::string>;

TEST(RecordedScans, AreInTheOrderOfTheirStampsWhateverTheOrderOfArrival) {
  ReplaySummary summary;
  RecordedScans scans(kMaxLag, kMaxFuture, summary);
  Names order;
  const auto keep = [&order](const DueScans& due) {
    EXPECT_FALSE(due.restart);
    for (const std::string& name : namesOf(due.scans)) order.push_back(name);
  };
  for (const auto& each : {scan("b", 10.0), scan("a", 10.1), scan("a", 10.0), scan("b", 10.05)})
    keep(scans.take(each, ros::Time(10.2)));
  keep(scans.finish());
  EXPECT_EQ(order, (Names{"a 10000", "b 10000", "b 10050", "a 10100"}));
  EXPECT_EQ(summary.scans, 4u);
  EXPECT_EQ(summary.sightings, 4u);
  EXPECT_NEAR(summary.recorded, 0.1, 1e-9);
  EXPECT_TRUE(summary.drops.empty());
}

TEST(RecordedScans, AreDueWhenNoneCanPrecedeThemAnyMore) {
  ReplaySummary summary;
  RecordedScans scans(kMaxLag, kMaxFuture, summary);
  EXPECT_TRUE(scans.take(scan("a", 10.0), ros::Time(10.0)).scans.empty());
  EXPECT_TRUE(scans.take(scan("a", 10.15), ros::Time(10.15)).scans.empty());
  EXPECT_EQ(namesOf(scans.take(scan("a", 10.3), ros::Time(10.3)).scans), (Names{"a 10000"}));
}

TEST(RecordedScans, WhatNoTrackerCouldUseIsDroppedAndCounted) {
  ReplaySummary summary;
  RecordedScans scans(kMaxLag, kMaxFuture, summary);
  scans.take(scan("a", 10.0), ros::Time(10.0));
  scans.take(scan("a", 10.5), ros::Time(10.0));  // more than max_future ahead
  scans.take(scan("a", 10.4), ros::Time(10.4));
  scans.take(scan("a", 10.1), ros::Time(10.4));  // later than max_lag
  scans.take(scan("", 10.4), ros::Time(10.4));
  EXPECT_EQ(namesOf(scans.finish().scans), (Names{"a 10400"}));
  std::size_t dropped = 0;
  for (const auto& [reason, count] : summary.drops) dropped += count;
  EXPECT_EQ(dropped, 3u);
  EXPECT_EQ(summary.drops["recording: scan dropped, later than max_lag"], 1u);
  EXPECT_EQ(summary.drops["recording: scan dropped, stamped more than max_future after it was received"], 1u);
}

TEST(RecordedScans, OfALoopStartAnewAfterWhatCameBefore) {
  ReplaySummary summary;
  RecordedScans scans(kMaxLag, kMaxFuture, summary);
  DueScans restart;
  double received = 0.0;
  for (int loop = 0; loop < 2; ++loop) {
    for (int i = 0; i < 60; ++i) {
      received += 0.05;
      for (const char* sensor : {"a", "b"}) {
        const DueScans due = scans.take(scan(sensor, 100.0 + 0.05 * i), ros::Time(100.0 + received));
        if (due.restart) restart = due;
      }
    }
  }
  ASSERT_TRUE(restart.restart);
  EXPECT_EQ(namesOf(restart.before_restart).back(), "b 102950");
  EXPECT_FALSE(summary.notices.empty());
}

TEST(SensorsOf, AreThoseOfUsableScans) {
  const ScratchFolder folder;
  {
    rosbag::Bag bag(folder.file("in.bag"), rosbag::bagmode::Write);
    for (const char* sensor : {"b", "a", "", "a"})
      bag.write("/scans", ros::Time(10.0), scanOf(sensor, 10.0, {{0.1, 0.2}}));
  }
  const rosbag::Bag bag(folder.file("in.bag"), rosbag::bagmode::Read);
  EXPECT_EQ(sensorsOf(bag), (std::set<std::string>{"a", "b"}));
}

}  // namespace
