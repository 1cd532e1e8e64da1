#include "sightline/core/fusion/association/track_association.h"

#include <gtest/gtest.h>

#include "support/local_tracks.h"

namespace sightline::core {
namespace {

using test::at;
using test::localTrack;
using test::reportOf;
using Ids = std::vector<std::uint32_t>;

/// The steps of a fusion that decide who supports whom.
struct Associated {
  void report(const std::string& tracker, double t, const std::vector<Track>& tracks) {
    reports.take(reportOf(tracker, t, tracks));
    global.follow(reports, {{tracker, 1}});
    association.learnMisalignment(global, tracker);
    association.splitContradicting(global, memory, {{tracker, 1}});
    association.reassign(global, reports, memory, tracker);
    association.associate(global, reports, memory, tracker, true);
    for (GlobalTrackEntry& entry : global.entries()) {
      const Estimate<4> opinion = entry.track.opinion();
      const auto usable = entry.track.usable();
      if (!usable.empty()) entry.track.setFused(usable, {opinion.mean, opinion.covariance});
    }
  }

  /// Keys of the supporters of the n-th global track.
  std::vector<std::string> supportersOf(std::size_t n) const {
    std::vector<std::string> names;
    for (const Supporter& supporter : global.entries().at(n).track.supporters())
      names.push_back(supporter.key.tracker + " " + std::to_string(supporter.key.id));
    std::sort(names.begin(), names.end());
    return names;
  }

  TrackFusionParams params;
  LocalReports reports{params.reports};
  TrackletMemory memory{memoryParamsOf(params)};
  GlobalTracks global{params};
  TrackAssociation association{params};
};

using Names = std::vector<std::string>;

TEST(TrackAssociation, AFreeTrackJoinsTheOneInWhoseGateItIsOrStartsItsOwn) {
  Associated fusion;
  fusion.report("a", 1.0, {localTrack(1, {0.1, 0.2}), localTrack(2, {0.2, 0.2})});
  fusion.report("b", 1.0, {localTrack(5, {0.2, 0.2}), localTrack(6, {0.5, 0.2})});
  ASSERT_EQ(fusion.global.entries().size(), 3u);
  EXPECT_EQ(fusion.supportersOf(0), (Names{"a 1"}));
  EXPECT_EQ(fusion.supportersOf(1), (Names{"a 2", "b 5"}));
  EXPECT_EQ(fusion.supportersOf(2), (Names{"b 6"}));
}

TEST(TrackAssociation, GlobalTracksThatComeTogetherBecomeTheOlderUnlessTheyShareATracker) {
  Associated fusion;
  fusion.report("a", 1.0, {localTrack(1, {0.1, 0.2})});
  fusion.report("b", 1.0, {localTrack(1, {0.2, 0.2})});
  fusion.report("a", 1.1, {localTrack(1, {0.1, 0.2}), localTrack(2, {0.3, 0.2})});
  ASSERT_EQ(fusion.global.entries().size(), 3u);
  for (const double t : {1.2, 1.3}) fusion.report("b", t, {localTrack(1, {0.1, 0.2})});
  ASSERT_EQ(fusion.global.entries().size(), 2u) << "once the fused state is there, too";
  EXPECT_EQ(fusion.supportersOf(0), (Names{"a 1", "b 1"}));
  fusion.report("a", 1.4, {localTrack(1, {0.1, 0.2}), localTrack(2, {0.1, 0.2})});
  EXPECT_EQ(fusion.global.entries().size(), 2u) << "a has two targets there";
}

TEST(TrackAssociation, ASupporterThatContradictsForLongIsRemovedAndStartsItsOwn) {
  Associated fusion;
  for (double t = 1.0; t < 2.0; t += 0.1) {
    const double off = t > 1.05 ? 0.05 : 0.0;
    fusion.report("a", t, {localTrack(1, {0.1, 0.2})});
    fusion.report("b", t, {localTrack(1, {0.1, 0.2})});
    fusion.report("c", t, {localTrack(1, {0.1 + off, 0.2})});
  }
  ASSERT_EQ(fusion.global.entries().size(), 2u);
  EXPECT_EQ(fusion.supportersOf(0), (Names{"a 1", "b 1"}));
  EXPECT_EQ(fusion.supportersOf(1), (Names{"c 1"}));
}

TEST(TrackAssociation, ATrackThatFitsBetterWaitsForThePlaceAndThenTakesIt) {
  Associated fusion;
  bool has_waited = false;
  for (double t = 1.0; t < 2.0; t += 0.1) {
    fusion.report("a", t, {localTrack(1, {0.0, 0.2})});
    fusion.report("b", t, {localTrack(1, {0.0, 0.2})});
    std::vector<Track> tracks{localTrack(1, {t < 1.05 ? 0.0 : 4e-3, 0.2})};
    if (t > 1.15) tracks.push_back(localTrack(2, {0.0, 0.2}));
    fusion.report("c", t, tracks);
    has_waited = has_waited || fusion.association.waiting().count({"c", 2}) > 0;
  }
  EXPECT_TRUE(has_waited);
  EXPECT_EQ(fusion.supportersOf(0), (Names{"a 1", "b 1", "c 2"}));
}

TEST(TrackAssociation, TracksWithoutAFiniteDistanceAreNotAssignedAndNothingThrows) {
  Associated fusion;
  fusion.report("a", 1.0, {localTrack(1, {0.1, 0.2})});
  Track odd = localTrack(1, {0.1, 0.2});
  odd.state.mean.tail<2>().setConstant(1e300);
  EXPECT_NO_THROW(fusion.report("b", 1.0, {odd}));
  EXPECT_EQ(fusion.global.entries().size(), 1u);
  EXPECT_TRUE(fusion.global.supportersOf("b").empty());
}

}  // namespace
}  // namespace sightline::core
