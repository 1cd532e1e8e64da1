#include "sightline/core/evaluation/innovation_statistics.h"

#include <cmath>

#include <gtest/gtest.h>

using namespace sightline::core;

namespace {

Association association(Decision decision, double distance_squared) {
  Association result;
  result.decision = decision;
  result.distance_squared = distance_squared;
  return result;
}

TEST(InnovationStatistics, OnlyAcceptedSightingsCountTowardsTheMean) {
  InnovationStatistics statistics;
  EXPECT_TRUE(std::isnan(statistics.nis()));
  statistics.add(association(Decision::accepted, 1.0));
  statistics.add(association(Decision::accepted, 5.0));
  statistics.add(association(Decision::outside_gate, 100.0));
  statistics.add(association(Decision::started_track, std::nan("")));
  statistics.add(association(Decision::accepted, std::nan("")));
  EXPECT_NEAR(statistics.nis(), 1.5, 1e-12);
  EXPECT_EQ(statistics.count(Decision::accepted), 3u);
  EXPECT_EQ(statistics.count(Decision::outside_gate), 1u);
  EXPECT_EQ(statistics.count(Decision::started_track), 1u);
  EXPECT_EQ(statistics.count(Decision::claimed_by_other), 0u);
  EXPECT_EQ(statistics.count(Decision::rejected_input), 0u);
}

}  // namespace
