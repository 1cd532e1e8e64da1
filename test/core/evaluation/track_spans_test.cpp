#include "sightline/core/evaluation/track_spans.h"

#include <cmath>

#include <gtest/gtest.h>

using namespace sightline::core;

namespace {

TrackReport report(double time, const std::vector<std::uint32_t>& ids,
                   TrackStatus status = TrackStatus::confirmed) {
  TrackReport result;
  result.time = timeOf(1'000'000'000'000) + durationOf(time);
  for (const std::uint32_t id : ids) {
    result.tracks.emplace_back();
    result.tracks.back().id = id;
    result.tracks.back().status = status;
  }
  return result;
}

TEST(TrackSpans, LengthsAreFromFirstToLastBelief) {
  TrackSpans spans;
  for (int i = 0; i <= 10; ++i) {
    std::vector<std::uint32_t> ids = {1};
    if (i >= 4 && i <= 7) ids.push_back(2);
    if (i == 5) ids.push_back(3);
    spans.add(report(0.1 * i, ids));
  }
  EXPECT_EQ(spans.tracks(), 3u);
  EXPECT_NEAR(spans.longestLength(), 1.0, 1e-9);
  EXPECT_NEAR(spans.medianLength(), 0.3, 1e-9);
  EXPECT_NEAR(spans.coverage(), 1.0, 1e-9);
  EXPECT_EQ(spans.breaks(), 0u);
}

TEST(TrackSpans, ABreakIsATimeWithoutTrackWhileReportsGoOn) {
  TrackSpans spans;
  for (int i = 0; i <= 20; ++i)
    spans.add(report(0.1 * i, i < 5    ? std::vector<std::uint32_t>{1}
                              : i < 10 ? std::vector<std::uint32_t>{}
                                       : std::vector<std::uint32_t>{2}));
  EXPECT_EQ(spans.breaks(), 1u);
  EXPECT_NEAR(spans.longestBreak(), 0.6, 1e-9);
  EXPECT_NEAR(spans.coverage(), (0.4 + 1.0) / 2.0, 1e-9);
}

TEST(TrackSpans, SilenceOfTheSensorsBreaksNothing) {
  TrackSpans spans(1.0);
  spans.add(report(0.0, {1}));
  spans.add(report(0.5, {}));
  spans.add(report(20.0, {}));
  spans.add(report(20.5, {2}));
  EXPECT_EQ(spans.breaks(), 0u);
  EXPECT_EQ(spans.tracks(), 2u);
}

TEST(TrackSpans, NothingBeforeTheFirstOrAfterTheLastTrackIsABreak) {
  TrackSpans spans;
  spans.add(report(0.0, {}));
  spans.add(report(0.5, {1}));
  spans.add(report(1.0, {}));
  EXPECT_EQ(spans.breaks(), 0u);
  EXPECT_NEAR(spans.coverage(), 0.0, 1e-12);
}

TEST(TrackSpans, TentativeTracksDoNotCount) {
  TrackSpans spans;
  EXPECT_TRUE(std::isnan(spans.longestLength()));
  EXPECT_TRUE(std::isnan(spans.medianLength()));
  EXPECT_TRUE(std::isnan(spans.coverage()));
  spans.add(report(0.0, {1}, TrackStatus::tentative));
  spans.add(report(0.1, {1}, TrackStatus::coasting));
  EXPECT_EQ(spans.tracks(), 1u);
  EXPECT_NEAR(spans.longestLength(), 0.0, 1e-12);
}

}  // namespace
