#include "sightline/core/fusion/tracklets/tracklet_memory.h"

#include <gtest/gtest.h>

namespace sightline::core {
namespace {

Time at(double t) {
  return Time(durationOf(100.0 + t));
}

/// A report of one tracklet of track 1, at its stamp.
TrackletReport reportOf(const std::string& tracker, double t, std::optional<double> since) {
  TrackletReport report;
  report.tracker = tracker;
  report.time = at(t);
  if (since) report.since = at(*since);
  Tracklet tracklet;
  tracklet.time = at(t);
  tracklet.sensor = "camera";
  report.tracklets = {{1, tracklet}};
  return report;
}

TEST(TrackletMemory, RemembersInTheOrderOfArrivalForAsLongAsItShould) {
  TrackletMemory memory({1.0, 32});
  EXPECT_EQ(memory.find({"a", 1}), nullptr);
  EXPECT_FALSE(memory.newest("a"));
  for (int k = 0; k < 30; ++k) EXPECT_FALSE(memory.take(reportOf("a", 0.1 * k, 0.1 * (k - 1))));
  const auto* tracklets = memory.find({"a", 1});
  ASSERT_NE(tracklets, nullptr);
  ASSERT_EQ(tracklets->size(), 11u);
  for (std::size_t i = 1; i < tracklets->size(); ++i)
    EXPECT_LT((*tracklets)[i - 1].number, (*tracklets)[i].number);
  EXPECT_EQ(tracklets->back().tracklet.time, at(2.9));
  EXPECT_EQ(memory.newest("a"), at(2.9));
  EXPECT_EQ(memory.find({"a", 2}), nullptr);
  EXPECT_EQ(memory.find({"b", 1}), nullptr);
}

TEST(TrackletMemory, LostReportLeavesAGapThatCountsWhileItIsRecent) {
  TrackletMemory memory({1.0, 32});
  memory.take(reportOf("a", 0.0, {}));
  memory.take(reportOf("a", 0.1, 0.0));
  EXPECT_EQ(memory.missing("a", at(-0.9)), 0.0);
  memory.take(reportOf("a", 0.4, 0.3));
  EXPECT_NEAR(memory.missing("a", at(-0.6)), 0.2, 1e-9);
  EXPECT_NEAR(memory.missing("a", at(0.2)), 0.1, 1e-9) << "only what is after";
  for (int k = 5; k < 20; ++k) memory.take(reportOf("a", 0.1 * k, 0.1 * (k - 1)));
  EXPECT_EQ(memory.missing("a", at(0.9)), 0.0);
}

TEST(TrackletMemory, ReportThatWasOvertakenFillsTheGap) {
  TrackletMemory memory({1.0, 32});
  memory.take(reportOf("a", 0.2, 0.1));
  EXPECT_NEAR(memory.missing("a", at(-0.8)), 0.9, 1e-9) << "what was before is not known";
  memory.take(reportOf("a", 0.4, 0.3));
  EXPECT_NEAR(memory.missing("a", at(-0.6)), 0.8, 1e-9);
  memory.take(reportOf("a", 0.3, 0.2));
  EXPECT_NEAR(memory.missing("a", at(-0.6)), 0.7, 1e-9);
  memory.take(reportOf("a", 0.1, {}));
  EXPECT_EQ(memory.missing("a", at(-0.6)), 0.0) << "the first of all had been overtaken";
  EXPECT_EQ(memory.find({"a", 1})->size(), 4u);
  EXPECT_EQ(memory.newest("a"), at(0.4));
}

TEST(TrackletMemory, TrackerThatStartsAgainIsAnother) {
  TrackletMemory memory({1.0, 32});
  memory.take(reportOf("a", 0.0, {}));
  memory.take(reportOf("a", 5.0, {}));
  EXPECT_EQ(memory.find({"a", 1})->size(), 1u);
  EXPECT_EQ(memory.missing("a", at(4.0)), 0.0);
  memory.take(reportOf("a", -20.0, {}));
  EXPECT_EQ(memory.newest("a"), at(-20.0)) << "its clock, too";
  EXPECT_EQ(memory.find({"a", 1})->size(), 1u);
}

TEST(TrackletMemory, IsBounded) {
  TrackletMemory memory({1.0, 2});
  EXPECT_FALSE(memory.take(reportOf("a", 0.0, {})));
  EXPECT_FALSE(memory.take(reportOf("b", 0.0, {})));
  EXPECT_EQ(memory.take(reportOf("c", 0.0, {}))->kind, "limit");
  EXPECT_EQ(memory.take(reportOf("", 0.0, {}))->kind, "no name");
  for (int k = 0; k < 10000; ++k) memory.take(reportOf("a", 1e-6 * k, 1e-6 * (k - 1)));
  EXPECT_LE(memory.find({"a", 1})->size(), 4096u);
}

}  // namespace
}  // namespace sightline::core
