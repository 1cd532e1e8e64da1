#include "sightline/core/fusion/association/association_costs.h"

#include <gtest/gtest.h>

#include "sightline/core/association/assignment.h"

#include "support/local_tracks.h"

namespace sightline::core {
namespace {

using test::at;
using test::localTrack;
using test::reportOf;

TEST(AssociationCosts, WhatFitsCostsLessThanToStayAloneAndTheRestIsForbidden) {
  const TrackFusionParams params;
  GlobalTracks tracks(params);
  LocalReports reports(params.reports);
  reports.take(reportOf("a", 1.0, {localTrack(1, {0.1, 0.2}), localTrack(2, {0.5, 0.2})}));
  tracks.follow(reports, {{"a", 1}});
  for (const std::uint32_t id : {1U, 2U}) tracks.start({"a", id}, *reports.find({"a", id}));
  ASSERT_EQ(tracks.entries().size(), 2u);

  const TrackerMisalignment misalignment(0.0);
  const CostContext context{tracks, misalignment, 18.5};
  AssignedRow row;
  row.key = LocalKey{"b", 7};
  row.entry = tracks.entries().size();
  row.local.track = localTrack(7, {0.1005, 0.2});
  row.local.time = at(1.0);
  const Costs costs = costsOf({row}, {0, 1}, context);
  ASSERT_EQ(costs.pairs.rows(), 1);
  ASSERT_EQ(costs.pairs.cols(), 2);
  EXPECT_LT(costs.pairs(0, 0), costs.alone);
  EXPECT_EQ(costs.pairs(0, 1), kForbidden);
  EXPECT_FALSE(areNear(tracks.entries()[0].track, tracks.entries()[1].track, context));
}

}  // namespace
}  // namespace sightline::core
