#include "sightline/core/estimators/revisit_time.h"

#include <gtest/gtest.h>

namespace sightline::core {
namespace {

RevisitTime every(double interval, int times = 20) {
  RevisitTime revisit;
  for (int k = 0; k < times; ++k) revisit.note(interval);
  return revisit;
}

TEST(RevisitTime, BeforeTheSecondSightingThePredictionItselfIsTheInterval) {
  const RevisitTime revisit;
  EXPECT_FALSE(revisit.isKnown());
  EXPECT_DOUBLE_EQ(revisit.unit(0.1), 1.0);
  EXPECT_DOUBLE_EQ(revisit.unit(600.0), 1800.0);
  EXPECT_DOUBLE_EQ(revisit.unit(-600.0), 1800.0);
}

TEST(RevisitTime, TheUnitIsOneSecondUpToThreeIntervalsASecondAndThreeIntervalsBeyond) {
  EXPECT_DOUBLE_EQ(every(0.001).unit(5.0), 1.0);
  EXPECT_DOUBLE_EQ(every(0.33).unit(5.0), 1.0);
  EXPECT_NEAR(every(0.5).unit(5.0), 1.5, 1e-12);
  EXPECT_NEAR(every(600.0).unit(5.0), 1800.0, 1e-9);
}

TEST(RevisitTime, AGapHardlyChangesItAndANewPaceDoes) {
  RevisitTime revisit = every(0.03);
  revisit.note(100.0);
  EXPECT_NEAR(revisit.usual(), 0.03 * 1.6, 1e-12);
  for (int k = 0; k < 30; ++k) revisit.note(10.0);
  EXPECT_NEAR(revisit.usual(), 10.0, 0.1);
}

TEST(RevisitTime, SightingsOfOneInstantDoNotCount) {
  RevisitTime revisit = every(2.0);
  for (int k = 0; k < 100; ++k) revisit.note(0.0);
  EXPECT_NEAR(revisit.usual(), 2.0, 1e-12);
}

}  // namespace
}  // namespace sightline::core
