#include "sightline/ros/recordings/recorded_scans.h"

#include <algorithm>
#include <boost/make_shared.hpp>
#include <random>
#include <utility>

#include <gtest/gtest.h>

#include <rosbag/view.h>

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
  RecordedScans scans(liveOrder(kMaxLag, kMaxFuture), summary);
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
  RecordedScans scans(liveOrder(kMaxLag, kMaxFuture), summary);
  EXPECT_TRUE(scans.take(scan("a", 10.0), ros::Time(10.0)).scans.empty());
  EXPECT_TRUE(scans.take(scan("a", 10.15), ros::Time(10.15)).scans.empty());
  EXPECT_EQ(namesOf(scans.take(scan("a", 10.3), ros::Time(10.3)).scans), (Names{"a 10000"}));
}

TEST(RecordedScans, WhatNoTrackerCouldUseIsDroppedAndCounted) {
  ReplaySummary summary;
  RecordedScans scans(liveOrder(kMaxLag, kMaxFuture), summary);
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
  RecordedScans scans(liveOrder(kMaxLag, kMaxFuture), summary);
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

/// What a recording with these scans and times of arrival is put into, in hindsight.
struct InHindsight {
  explicit InHindsight(const std::vector<std::pair<SightingArray::ConstPtr, double>>& recorded) {
    const ScratchFolder folder;
    {
      rosbag::Bag bag(folder.file("in.bag"), rosbag::bagmode::Write);
      for (const auto& [scan, received] : recorded) bag.write("/scans", ros::Time(received), *scan);
    }
    const rosbag::Bag bag(folder.file("in.bag"), rosbag::bagmode::Read);
    RecordedScans scans(orderInHindsight(kMaxLag, kMaxFuture, surveyOf(bag).arrivals), summary);
    const auto keep = [this](const DueScans& due) {
      restarts += due.restart ? 1 : 0;
      for (const auto& each : {due.before_restart, due.scans}) {
        for (const auto& scan : each) stamps.push_back(scan->header.stamp.toSec());
      }
    };
    rosbag::View view(bag);
    for (const rosbag::MessageInstance& message : view)
      keep(scans.take(message.instantiate<SightingArray>(), message.getTime()));
    for (int rest = 0; rest < 3; ++rest) keep(scans.finish());
  }

  ReplaySummary summary;
  std::vector<double> stamps;
  int restarts = 0;
};

TEST(RecordedScans, InHindsightNoSensorIsLateOrEarly) {
  for (const double delay : {0.7, -0.7, 5.0, 40.0}) {
    for (const int late : {1, 2}) {  // of three sensors
      std::vector<std::pair<SightingArray::ConstPtr, double>> recorded;
      for (int k = 0; k < 200; ++k) {
        for (int sensor = 0; sensor < 3; ++sensor) {
          const double stamp = 1000.0 + 0.05 * k + 0.01 * sensor;
          recorded.emplace_back(scan(std::string(1, static_cast<char>('a' + sensor)), stamp),
                                stamp + (sensor < late ? delay : 0.0));
        }
      }
      const InHindsight followed(recorded);
      EXPECT_TRUE(followed.summary.drops.empty()) << delay << " s, " << late << " sensors";
      EXPECT_TRUE(followed.summary.notices.empty()) << followed.summary.notices.at(0);
      EXPECT_EQ(followed.restarts, 0);
      EXPECT_EQ(followed.stamps.size(), 600u);
      EXPECT_TRUE(std::is_sorted(followed.stamps.begin(), followed.stamps.end()));
    }
  }
}

TEST(RecordedScans, InHindsightASensorOfErraticLatencyIsNotLate) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> latency(0.0, 3.0);
  for (const int sensors : {1, 2, 3}) {
    std::vector<std::pair<SightingArray::ConstPtr, double>> recorded;
    for (int k = 0; k < 300; ++k) {
      for (int sensor = 0; sensor < sensors; ++sensor) {
        const double stamp = 1000.0 + 0.05 * k + 0.01 * sensor;
        recorded.emplace_back(scan(std::string(1, static_cast<char>('a' + sensor)), stamp),
                              stamp + (sensor == 0 ? latency(random) : 0.01));
      }
    }
    const InHindsight followed(recorded);
    EXPECT_TRUE(followed.summary.drops.empty()) << sensors << " sensors";
    EXPECT_EQ(followed.restarts, 0) << sensors << " sensors";
    EXPECT_EQ(followed.stamps.size(), 300u * static_cast<std::size_t>(sensors));
    EXPECT_TRUE(std::is_sorted(followed.stamps.begin(), followed.stamps.end()));
  }
}

TEST(RecordedScans, InHindsightALoopStillStartsAnew) {
  std::vector<std::pair<SightingArray::ConstPtr, double>> recorded;
  for (const double later : {1.0, 11.0}) {
    for (int k = 0; k < 100; ++k) {
      for (const char* sensor : {"a", "b"})
        recorded.emplace_back(scan(sensor, 1000.0 + 0.05 * k), 1000.0 + 0.05 * k + later);
    }
  }
  const InHindsight followed(recorded);
  EXPECT_EQ(followed.restarts, 1);
  EXPECT_GT(followed.stamps.size(), 380u);
  EXPECT_EQ(followed.summary.notices.size(), 1u);
}

TEST(RecordedScans, InHindsightOneStampFarAheadIsLeftOut) {
  std::vector<std::pair<SightingArray::ConstPtr, double>> recorded;
  for (int k = 0; k < 100; ++k)
    recorded.emplace_back(scan("a", 1000.0 + 0.1 * k + (k == 50 ? 30.0 : 0.0)), 1000.0 + 0.1 * k);
  const InHindsight followed(recorded);
  EXPECT_EQ(followed.stamps.size(), 99u);
  EXPECT_EQ(followed.restarts, 0);
  ASSERT_EQ(followed.summary.examples.size(), 1u);
  EXPECT_NE(followed.summary.examples.begin()->second.find(
                "of a at 1035.000 s in frame \"platform_enu\": 30 s ahead"),
            std::string::npos)
      << followed.summary.examples.begin()->second;
}

TEST(SurveyOf, NamesTheSensorsOfUsableScansAndTheirDelays) {
  const ScratchFolder folder;
  {
    rosbag::Bag bag(folder.file("in.bag"), rosbag::bagmode::Write);
    for (const char* sensor : {"b", "a", "", "a"})
      bag.write("/scans", ros::Time(sensor[0] == 'b' ? 10.5 : 10.0), scanOf(sensor, 10.0, {{0.1, 0.2}}));
  }
  const rosbag::Bag bag(folder.file("in.bag"), rosbag::bagmode::Read);
  const RecordingSurvey survey = surveyOf(bag);
  EXPECT_EQ(survey.sensors, (std::set<std::string>{"a", "b"}));
  EXPECT_NEAR(survey.arrivals.delayOf("b"), 0.5, 1e-6);
}

}  // namespace
