#include "sightline/core/fusion/reports/local_reports.h"

#include <cmath>

#include <gtest/gtest.h>

#include "support/times.h"

namespace sightline::core {
namespace {

using test::at;

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

std::string kindOf(const std::optional<Refusal>& refusal) {
  return refusal ? refusal->kind : "";
}

TEST(LocalReports, NewestStampIsTheCommonTime) {
  LocalReports reports({});
  EXPECT_FALSE(reports.take(report("a", 10.0)));
  EXPECT_FALSE(reports.take(report("b", 9.5)));
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
  EXPECT_EQ(kindOf(reports.take(report("a", 9.9, {track(7)}))), "late");
  EXPECT_EQ(reports.find({"a", 7}), nullptr);
  EXPECT_NE(reports.find({"a", 1}), nullptr);
  EXPECT_FALSE(reports.take(report("a", 10.0, {track(7)}))) << "the same stamp again is an update";
  EXPECT_NE(reports.find({"a", 7}), nullptr);
}

TEST(LocalReports, LargeStepBackIsARestart) {
  LocalReports reports({});
  reports.take(report("a", 100.0));
  reports.take(report("b", 100.0));
  EXPECT_FALSE(reports.take(report("a", 5.0)));
  EXPECT_EQ(reports.newest(), at(100.0)) << "the other tracker goes on";
  EXPECT_FALSE(reports.take(report("b", 5.0)));
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

/// "ahead" reports every 0.1 s from 100 s on, and at `silence` after 120 s the backlog of "held up" comes.
struct Backlog {
  double until = 120.0;    // of the reports of "ahead"
  double held_for = 6.0;   // [s]
  bool is_known = true;    // the tracker that was held up, from before
  bool has_clock = true;   // the time of arrival is known
  bool is_at_once = true;  // the backlog comes within a millisecond
};

LocalReports afterBacklog(const Backlog& backlog) {
  LocalReports reports({});
  const auto take = [&](const std::string& tracker, double t, double arrival) {
    return reports.take(report(tracker, t),
                        backlog.has_clock ? std::make_optional(at(arrival)) : std::nullopt);
  };
  const double begin = backlog.until - backlog.held_for;
  for (double t = begin - 10.0; t < backlog.until; t += 0.1) {
    take("ahead", t, t);
    if (t <= begin && backlog.is_known) take("held up", t, t);
  }
  for (double t = begin; t < backlog.until; t += 0.1) {
    const double arrival = backlog.until + (backlog.is_at_once ? 1e-4 : 1.0) * (t - begin);
    EXPECT_FALSE(take("held up", t, arrival)) << t;
    EXPECT_LE(reports.newest(), at(backlog.until));
  }
  return reports;
}

TEST(LocalReports, ABacklogThatComesAtOnceThrowsNobodyOut) {
  for (const double held_for : {4.5, 6.0, 9.0, 15.0, 30.0}) {
    for (const bool has_clock : {true, false}) {
      Backlog backlog;
      backlog.held_for = held_for;
      backlog.has_clock = has_clock;
      const LocalReports reports = afterBacklog(backlog);
      EXPECT_EQ(reports.trackers().count("ahead"), 1u) << held_for << " " << has_clock;
      EXPECT_NEAR(seconds(reports.newest() - at(120.0)), 0.0, 0.1001) << held_for << " " << has_clock;
    }
  }
  Backlog of_new;
  of_new.is_known = false;
  EXPECT_EQ(afterBacklog(of_new).trackers().count("ahead"), 1u) << "it has never been heard of before";
}

TEST(LocalReports, OneThatReportsBehindOthersThatAreSilentForLongGoesOnAlone) {
  Backlog backlog;
  backlog.is_at_once = false;
  EXPECT_EQ(afterBacklog(backlog).trackers().count("ahead"), 0u) << "3 s without them";
}

TEST(LocalReports, OneTrackerThatStartsAgainTakesTheCommonTimeNotBack) {
  LocalReports reports({});
  reports.take(report("a", 100.03));
  reports.take(report("b", 100.0));
  EXPECT_FALSE(reports.take(report("a", 5.0)));
  EXPECT_EQ(reports.newest(), at(100.03));
  for (const double back : {2.9, 0.4, 1.7, 2.2}) {  // stamps that go to and fro
    reports.take(report("b", 101.0));
    reports.take(report("a", 101.02));
    reports.take(report("a", 101.02 - back));
    EXPECT_GE(reports.newest(), at(101.0));
  }
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
  EXPECT_EQ(kindOf(reports.take(report("c", 1.0))), "limit");
  EXPECT_EQ(reports.trackers().size(), 2u);

  std::vector<Track> many;
  for (std::uint32_t id = 1; id <= 100; ++id) many.push_back(track(id));
  reports.take(report("a", 1.1, many));
  const LocalReports::Tracker& tracker = reports.trackers().at("a");
  EXPECT_EQ(tracker.tracks.size(), 3u);
  EXPECT_EQ(tracker.surplus.size(), 3u);
  EXPECT_EQ(tracker.surplus.begin()->second.kind, "limit");
}

TEST(LocalReports, BadTracksKeepTheirReasonAndTheGoodOnesStay) {
  Track garbage = track(2), odd = track(3);
  garbage.state.covariance(0, 0) = std::nan("");
  odd.status = static_cast<TrackStatus>(7);
  LocalReports reports({});
  EXPECT_FALSE(reports.take(report("a", 1.0, {track(1), garbage, odd, track(0), track(1)})));
  EXPECT_FALSE(reports.find({"a", 1})->invalid);
  EXPECT_EQ(kindOf(reports.find({"a", 2})->invalid), "invalid");
  EXPECT_EQ(kindOf(reports.find({"a", 3})->invalid), "invalid");
  EXPECT_EQ(kindOf(reports.find({"a", 0})->invalid), "invalid");
  EXPECT_EQ(reports.trackers().at("a").surplus.at(1).kind, "invalid") << "id twice";
}

TEST(LocalReports, NamelessTrackerIsRefused) {
  LocalReports reports({});
  EXPECT_TRUE(reports.take(report("", 1.0)));
  EXPECT_TRUE(reports.trackers().empty());
}

TEST(LocalReports, NamesWithoutEndAreRefusedAndNotKept) {
  LocalReports reports({});
  EXPECT_EQ(kindOf(reports.take(report(std::string(1000000, 'x'), 1.0))), "invalid");
  EXPECT_TRUE(reports.trackers().empty());
  Track from_afar = track(1);
  from_afar.sources = {std::string(1000000, 'y')};
  EXPECT_FALSE(reports.take(report("a", 1.0, {from_afar})));
  EXPECT_EQ(kindOf(reports.find({"a", 1})->invalid), "invalid");
  EXPECT_TRUE(reports.find({"a", 1})->track.sources.empty());
}

}  // namespace
}  // namespace sightline::core
