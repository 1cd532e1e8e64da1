#include "sightline/core/fusion/local_reports.h"

#include <cmath>

#include <gtest/gtest.h>

namespace sightline::core {
namespace {

Time at(double t) {
  return Time(durationOf(t));
}

Track track(std::uint32_t id) {
  Track track;
  track.id = id;
  track.status = TrackStatus::confirmed;
  track.state.covariance = 1e-6 * Eigen::Matrix4d::Identity();
  return track;
}

LocalReport report(const std::string& tracker, double t, const std::vector<Track>& tracks = {track(1)}) {
  return {tracker, at(t), tracks};
}

TEST(LocalReports, NewestStampIsTheCommonTime) {
  LocalReports reports({});
  EXPECT_EQ(reports.take(report("a", 10.0)), "");
  EXPECT_EQ(reports.take(report("b", 9.5)), "");
  EXPECT_EQ(reports.newest(), at(10.0));
  EXPECT_DOUBLE_EQ(reports.age(at(9.5)), 0.5);
  ASSERT_NE(reports.find({"b", 1}), nullptr);
  EXPECT_EQ(reports.find({"b", 1})->time, at(9.5));
  EXPECT_EQ(reports.find({"b", 2}), nullptr);
  EXPECT_EQ(reports.find({"c", 1}), nullptr);
}

TEST(LocalReports, OnlyTheLastReportOfATrackerCounts) {
  LocalReports reports({});
  reports.take(report("a", 10.0, {track(1), track(2)}));
  reports.take(report("a", 10.1, {track(2)}));
  EXPECT_EQ(reports.find({"a", 1}), nullptr);
  EXPECT_NE(reports.find({"a", 2}), nullptr);
}

TEST(LocalReports, LateReportIsRefusedAndChangesNothing) {
  LocalReports reports({});
  reports.take(report("a", 10.0));
  const std::string why = reports.take(report("a", 9.9, {track(7)}));
  EXPECT_EQ(why.substr(0, 5), "late:") << why;
  EXPECT_EQ(reports.find({"a", 7}), nullptr);
  EXPECT_NE(reports.find({"a", 1}), nullptr);
  EXPECT_EQ(reports.take(report("a", 10.0, {track(7)})), "") << "the same stamp again is an update";
  EXPECT_NE(reports.find({"a", 7}), nullptr);
}

TEST(LocalReports, LargeStepBackIsARestart) {
  LocalReports reports({});
  reports.take(report("a", 100.0));
  reports.take(report("b", 100.0));
  EXPECT_EQ(reports.take(report("a", 5.0)), "");
  EXPECT_EQ(reports.newest(), at(100.0)) << "the other tracker goes on";
  EXPECT_EQ(reports.take(report("b", 5.0)), "");
  EXPECT_EQ(reports.newest(), at(5.0)) << "all have started again";
}

TEST(LocalReports, TrackerThatDiedAheadDoesNotHoldUpARestart) {
  LocalReports reports({});
  reports.take(report("dead", 100.0));
  reports.take(report("a", 100.0));
  double t = 0.0;
  for (; reports.newest() == at(100.0) && t < 60.0; t += 0.1) reports.take(report("a", t));
  EXPECT_NEAR(t, 3.0, 0.5);
  EXPECT_EQ(reports.trackers().count("dead"), 0u);
  EXPECT_EQ(reports.newest(), at(t - 0.1));
}

TEST(LocalReports, TrackerThatLagsDoesNotThrowOutTheOthers) {
  LocalReports reports({});
  for (double t = 100.0; t < 120.0; t += 0.1) {
    reports.take(report("fast", t));
    reports.take(report("slow", t - 5.0));
    ASSERT_EQ(reports.trackers().size(), 2u) << t;
  }
  EXPECT_NEAR(reports.age(reports.find({"slow", 1})->time), 5.0, 1e-6);
}

TEST(LocalReports, SilentTrackersAreForgotten) {
  LocalReports reports({});
  reports.take(report("a", 100.0));
  reports.take(report("b", 109.0));
  EXPECT_EQ(reports.trackers().size(), 2u);
  reports.take(report("b", 110.5));
  EXPECT_EQ(reports.trackers().size(), 1u);
}

TEST(LocalReports, MemoryIsBounded) {
  LocalReportsParams params;
  params.max_trackers = 2;
  params.max_tracks = 3;
  LocalReports reports(params);
  reports.take(report("a", 1.0));
  reports.take(report("b", 1.0));
  EXPECT_EQ(reports.take(report("c", 1.0)).substr(0, 6), "limit:");
  EXPECT_EQ(reports.trackers().size(), 2u);

  std::vector<Track> many;
  for (std::uint32_t id = 1; id <= 100; ++id) many.push_back(track(id));
  reports.take(report("a", 1.1, many));
  const LocalReports::Tracker& tracker = reports.trackers().at("a");
  EXPECT_EQ(tracker.tracks.size(), 3u);
  EXPECT_EQ(tracker.surplus.size(), 3u);
  EXPECT_EQ(tracker.surplus.begin()->second.substr(0, 6), "limit:");
}

TEST(LocalReports, BadTracksKeepTheirReasonAndTheGoodOnesStay) {
  Track garbage = track(2), odd = track(3);
  garbage.state.covariance(0, 0) = std::nan("");
  odd.status = static_cast<TrackStatus>(7);
  LocalReports reports({});
  EXPECT_EQ(reports.take(report("a", 1.0, {track(1), garbage, odd, track(0), track(1)})), "");
  EXPECT_EQ(reports.find({"a", 1})->invalid, "");
  EXPECT_EQ(reports.find({"a", 2})->invalid.substr(0, 8), "invalid:");
  EXPECT_EQ(reports.find({"a", 3})->invalid.substr(0, 8), "invalid:");
  EXPECT_EQ(reports.find({"a", 0})->invalid.substr(0, 8), "invalid:");
  EXPECT_EQ(reports.trackers().at("a").surplus.at(1).substr(0, 8), "invalid:") << "id twice";
}

TEST(LocalReports, NamelessTrackerIsRefused) {
  LocalReports reports({});
  EXPECT_NE(reports.take(report("", 1.0)), "");
  EXPECT_TRUE(reports.trackers().empty());
}

}  // namespace
}  // namespace sightline::core
