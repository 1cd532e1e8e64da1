#include "sightline/core/fusion/reports/reported_states.h"

#include <gtest/gtest.h>

#include "support/local_tracks.h"

namespace sightline::core {
namespace {

using test::at;

ReportedState reportedAt(double t) {
  return {at(t), test::localTrack(1, {0.01 * t, 0.0}).state};
}

TEST(ReportedStates, GivesTheNearestInTime) {
  ReportedStates states;
  EXPECT_EQ(states.nearest(at(1.0)), nullptr);
  for (const double t : {10.0, 10.1, 10.2}) states.add(reportedAt(t));
  EXPECT_EQ(states.nearest(at(0.0))->time, at(10.0));
  EXPECT_EQ(states.nearest(at(10.12))->time, at(10.1));
  EXPECT_EQ(states.nearest(at(10.16))->time, at(10.2));
  EXPECT_EQ(states.nearest(at(99.0))->time, at(10.2));
  EXPECT_DOUBLE_EQ(states.nearest(at(10.12))->state.mean(0), 0.101);
}

TEST(ReportedStates, KeepsASecondOfAFastTrackerAndTheNewestOfASlowOne) {
  ReportedStates fast, slow;
  for (int k = 0; k < 1000; ++k) fast.add(reportedAt(10.0 + k / 200.0));
  EXPECT_NEAR(seconds(fast.nearest(at(0.0))->time - at(10.0)), 4.995 - 31 * 0.035, 0.04);
  EXPECT_LT(seconds(at(14.995) - fast.nearest(at(99.0))->time), 0.035);
  for (int k = 0; k < 100; ++k) slow.add(reportedAt(10.0 * k));
  EXPECT_EQ(slow.nearest(at(0.0))->time, at(680.0));
  EXPECT_EQ(slow.nearest(at(1e6))->time, at(990.0));
}

}  // namespace
}  // namespace sightline::core
