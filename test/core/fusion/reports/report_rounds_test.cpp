#include "sightline/core/fusion/reports/report_rounds.h"

#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "support/local_tracks.h"

namespace sightline::core {
namespace {

using test::at;
using test::localTrack;
using test::reportOf;

/// What came when, and after which of it a round ended.
class Stream {
 public:
  explicit Stream(double max_wait = 0.05) : rounds_(max_wait) {}

  /// Whether the round ends with this report, of 100 s + t.
  bool report(const std::string& tracker, double t) {
    EXPECT_FALSE(reports_.take(reportOf(tracker, 100.0 + t, {localTrack(1, {0.1, 0.2})})))
        << tracker << " " << t;
    rounds_.note(tracker, reports_);
    if (!rounds_.isDue(reports_)) return false;
    last_ = rounds_.end(reports_);
    EXPECT_TRUE(rounds_.isEmpty());
    ++ended_;
    return true;
  }

  const NewReports& last() const { return last_; }
  int ended() const { return ended_; }

 private:
  LocalReports reports_{{}};
  ReportRounds rounds_;
  NewReports last_;
  int ended_ = 0;
};

TEST(ReportRounds, SingleTrackerIsNeverKeptWaiting) {
  Stream stream;
  for (int k = 0; k < 20; ++k) EXPECT_TRUE(stream.report("a", 0.03 * k)) << k;
}

TEST(ReportRounds, ReportsOfOneInstantAreFusedTogetherWhateverTheirOrder) {
  Stream stream;
  std::vector<std::string> trackers{"a", "b", "c"};
  std::mt19937_64 random(1);
  for (int k = 0; k < 20; ++k) {
    for (std::size_t i = 0; i < trackers.size(); ++i) {
      const bool is_last = i + 1 == trackers.size();
      const bool ended = stream.report(trackers[i], 0.03 * k);
      if (k >= 2) {
        EXPECT_EQ(ended, is_last) << k << " " << i;
      }
    }
    if (k >= 2) {
      EXPECT_EQ(stream.last(), (NewReports{{"a", 1}, {"b", 1}, {"c", 1}})) << k;
    }
    std::shuffle(trackers.begin(), trackers.end(), random);
  }
}

TEST(ReportRounds, SixTrackersOneAfterAnotherMakeOneRoundAnInterval) {
  Stream stream;
  for (int k = 0; k < 600; ++k) stream.report("tracker " + std::to_string(k % 6), 0.005 * k);
  EXPECT_GE(stream.ended(), 95);
  EXPECT_LE(stream.ended(), 120) << "100 intervals, and what it took to learn them";
}

TEST(ReportRounds, ClusterOfReportsIsNotTornApart) {
  // b follows a by a third of the interval: from b to the next a it is two thirds.
  Stream stream;
  for (int k = 0; k < 20; ++k) {
    stream.report("a", 0.03 * k);
    const bool ended = stream.report("b", 0.03 * k + 0.01);
    if (k < 3) continue;
    EXPECT_TRUE(ended) << k;
    EXPECT_EQ(stream.last(), (NewReports{{"a", 1}, {"b", 1}})) << k;
  }
}

TEST(ReportRounds, SlowTrackerKeepsAFastOneWaitingOnlyWhenItIsAboutToReport) {
  Stream stream;
  int waited = 0;
  for (int k = 0; k < 2000; ++k) {
    if (!stream.report("fast", 0.005 * k)) ++waited;
    if (k % 200 == 0) stream.report("slow", 0.005 * k + 0.001);
  }
  EXPECT_LE(waited, 10) << "once a second";
}

TEST(ReportRounds, NobodyIsWaitedForLongerThanMaxWait) {
  Stream stream(0.05);
  for (int k = 0; k < 10; ++k) {
    stream.report("a", 10.0 * k);
    EXPECT_TRUE(stream.report("b", 10.0 * k + 0.2)) << k;
    if (k >= 2) {
      EXPECT_EQ(stream.last(), (NewReports{{"b", 1}})) << "0.2 s is too long to wait: a came alone";
    }
  }
}

TEST(ReportRounds, ZeroWaitFusesEveryReport) {
  Stream stream(0.0);
  for (int k = 0; k < 60; ++k) EXPECT_TRUE(stream.report(k % 2 == 0 ? "a" : "b", 0.03 * (k / 2))) << k;
}

TEST(ReportRounds, TrackerThatFallsSilentDelaysOneRound) {
  Stream stream;
  for (int k = 0; k < 10; ++k) {
    stream.report("a", 0.03 * k);
    stream.report("b", 0.03 * k + 0.002);
  }
  EXPECT_FALSE(stream.report("a", 0.30)) << "b is expected";
  for (int k = 11; k < 20; ++k) EXPECT_TRUE(stream.report("a", 0.03 * k)) << k;
  EXPECT_EQ(stream.last(), (NewReports{{"a", 1}}));
}

TEST(ReportRounds, TrackerWhoseStampsLagBehindIsExpectedWhenItsReportsCome) {
  Stream stream;
  for (int k = 10; k < 40; ++k) {
    const bool ended_before = stream.report("prompt", 0.03 * k);
    const bool ended = stream.report("late", 0.03 * k - 0.3);
    if (k < 13) continue;
    EXPECT_FALSE(ended_before) << k;
    EXPECT_TRUE(ended) << k;
  }
}

TEST(ReportRounds, StampsThatGoBackEndTheRound) {
  LocalReports reports{{}};
  ReportRounds rounds(0.05);
  const auto report = [&](const std::string& tracker, double t) {
    ASSERT_FALSE(reports.take(reportOf(tracker, t, {})));
    rounds.note(tracker, reports);
  };
  for (int k = 0; k < 10; ++k) {
    report("a", 100.0 + 0.03 * k);
    report("b", 100.0 + 0.03 * k + 0.002);
    rounds.end(reports);
  }
  report("a", 100.30);
  ASSERT_FALSE(rounds.isDue(reports));
  report("a", 5.0);
  report("b", 5.0);
  EXPECT_TRUE(rounds.isDue(reports));
}

TEST(ReportRounds, TrackerThatIsForgottenMeanwhileIsNotInTheRound) {
  LocalReports reports{{}};
  ReportRounds rounds(0.05);
  ASSERT_FALSE(reports.take(reportOf("gone", 1.0, {})));
  rounds.note("gone", reports);
  ASSERT_FALSE(reports.take(reportOf("a", 100.0, {})));
  rounds.note("a", reports);
  ASSERT_EQ(reports.trackers().count("gone"), 0u);
  EXPECT_EQ(rounds.end(reports), (NewReports{{"a", 1}}));
}

}  // namespace
}  // namespace sightline::core
