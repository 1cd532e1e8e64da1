#include "sightline/core/simulation/sighting_sequence.h"

#include <cmath>
#include <map>

#include <gtest/gtest.h>

#include "support/golden.h"

namespace sightline::core {
namespace {

using std::chrono::milliseconds;

SightingTiming fixedAt(double rate) {
  SightingTiming timing;
  timing.kind = SightingTiming::Kind::fixed;
  timing.rate = rate;
  return timing;
}

TEST(SightingSequence, IntervalsMatchTheGoldenVectors) {
  SIGHTLINE_REQUIRE_SHARED();
  const YAML::Node golden = test::golden("delta_t");
  const Duration shortest = durationOf(golden["dmin"].as<double>()),
                 spread = durationOf(golden["dmax"].as<double>());
  ASSERT_EQ(golden["rho"].size(), golden["dt"].size());
  ASSERT_GT(golden["rho"].size(), 0U);
  for (std::size_t i = 0; i < golden["rho"].size(); ++i) {
    const auto ticks = ticksOf(golden["rho"][i].as<double>(), shortest, spread);
    EXPECT_EQ(ticks * shortest, durationOf(golden["dt"][i].as<double>())) << "rho " << golden["rho"][i];
  }
  EXPECT_NEAR(expectedRate(SightingTiming{}), 1.0 / golden["mean"].as<double>(), 1e-9);
}

TEST(SightingSequence, OfThePaperHasFiveEqualIntervalsAndRate33Hz) {
  SightingSequence sequence(SightingTiming{}, 1);
  const int n = 20000;
  std::map<std::int64_t, int> histogram;
  Duration last = sequence.next();
  EXPECT_EQ(last.count(), 0);
  for (int i = 0; i < n; ++i) {
    const Duration now = sequence.next();
    ASSERT_EQ((now - last) % milliseconds(10), Duration(0));
    ++histogram[(now - last) / milliseconds(10)];
    last = now;
  }
  ASSERT_EQ(histogram.size(), 5U);
  const double band = 5.0 * std::sqrt(n * 0.2 * 0.8);
  for (std::int64_t ticks = 1; ticks <= 5; ++ticks)
    EXPECT_NEAR(histogram[ticks], 0.2 * n, band) << ticks << " ticks";
  const double sigma_interval = 0.010 * std::sqrt(2.0);  // of a uniform choice among five
  EXPECT_NEAR(seconds(last) / n, 0.030, 5.0 * sigma_interval / std::sqrt(n));
}

TEST(SightingSequence, ExpectedRateHoldsWhereTheSpreadIsNoMultipleOfTheTick) {
  SightingTiming timing;
  timing.shortest = 0.004;
  timing.spread = 0.0137;
  SightingSequence sequence(timing, 2);
  const int n = 20000;
  Duration last{};
  for (int i = 0; i <= n; ++i) last = sequence.next();
  EXPECT_NEAR(seconds(last) / n * expectedRate(timing), 1.0,
              5.0 * 0.5 / std::sqrt(n));  // sigma/mean is below 0.5
}

TEST(SightingSequence, FixedRateDoesNotDrift) {
  SightingSequence sequence(fixedAt(30.0), 1);
  Duration last{};
  for (int i = 0; i <= 300000; ++i) last = sequence.next();
  EXPECT_EQ(last, std::chrono::seconds(10000));
}

TEST(SightingSequence, SameSeedGivesTheSameTimes) {
  SightingSequence a(SightingTiming{}, 9), b(SightingTiming{}, 9), c(SightingTiming{}, 10);
  bool all_equal = true;
  for (int i = 0; i < 100; ++i) {
    const Duration time = a.next();
    EXPECT_EQ(time, b.next());
    all_equal = all_equal && time == c.next();
  }
  EXPECT_FALSE(all_equal);
}

TEST(SightingSequence, FirstExposureCanBeDelayed) {
  SightingTiming timing = fixedAt(10.0);
  timing.first = 0.025;
  SightingSequence sequence(timing, 1);
  EXPECT_EQ(sequence.next(), milliseconds(25));
  EXPECT_EQ(sequence.next(), milliseconds(125));
}

TEST(SightingSequence, FaultyTimingsAreNamed) {
  EXPECT_FALSE(refusalOf(SightingTiming{}));
  SightingTiming narrow;
  narrow.spread = 0.005;
  EXPECT_NE(textOf(refusalOf(narrow).value()).find("shortest <= spread"), std::string::npos);
  EXPECT_NE(textOf(refusalOf(fixedAt(0.0)).value()).find("rate"), std::string::npos);
  SightingTiming early;
  early.first = -1.0;
  EXPECT_NE(textOf(refusalOf(early).value()).find("first"), std::string::npos);
}

}  // namespace
}  // namespace sightline::core
