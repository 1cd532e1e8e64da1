#include "sightline/core/fusion/global_tracks.h"

#include <gtest/gtest.h>

#include "support/local_tracks.h"

namespace sightline::core {
namespace {

using test::at;
using test::localTrack;
using test::reportOf;
using Ids = std::vector<std::uint32_t>;

/// Reports, and the global tracks that follow them; every free confirmed track of a report starts one.
struct Followed {
  explicit Followed(const TrackFusionParams& parameters = {}) : params(parameters) {}

  void report(const std::string& tracker, double t, const std::vector<Track>& tracks) {
    reports.take(reportOf(tracker, t, tracks));
    global.follow(reports, {{tracker, 1}});
    for (const Track& track : tracks) {
      const Ids supporters = global.supportersOf(tracker);
      if (std::find(supporters.begin(), supporters.end(), track.id) == supporters.end())
        global.start({tracker, track.id}, *reports.find({tracker, track.id}));
    }
    for (GlobalTrackEntry& entry : global.entries()) {
      const auto usable = entry.track.usable();
      if (!usable.empty()) entry.track.setFused(usable, entry.track.supporters()[usable[0]].state);
    }
    global.deleteSilent();
  }

  Ids ids() const {
    Ids ids;
    for (const GlobalTrackEntry& entry : global.entries()) ids.push_back(entry.track.id());
    return ids;
  }

  TrackFusionParams params;
  LocalReports reports{params.reports};
  GlobalTracks global{params};
};

Track withHits(Track track, std::uint32_t hits) {
  track.hits = hits;
  return track;
}

TEST(GlobalTracks, OnlyAConfirmedTrackStartsOneAndNoMoreThanAllowed) {
  TrackFusionParams params;
  params.max_tracks = 2;
  Followed followed(params);
  Track tentative = localTrack(1, {0.1, 0.2});
  tentative.status = TrackStatus::tentative;
  followed.report("a", 1.0, {tentative});
  EXPECT_TRUE(followed.ids().empty());
  followed.report("a", 1.1,
                  {localTrack(2, {0.1, 0.2}), localTrack(3, {0.3, 0.2}), localTrack(4, {0.5, 0.2})});
  EXPECT_EQ(followed.ids(), (Ids{1, 2}));
  EXPECT_EQ(followed.global.supportersOf("a"), (Ids{2, 3}));
}

TEST(GlobalTracks, FollowPredictsToTheNewestReportAndRenewsTheReportingTracker) {
  Followed followed;
  followed.report("a", 1.0, {localTrack(1, {0.1, 0.2}, 1e-3, {0.1, 0.0})});
  followed.reports.take(reportOf("b", 1.4, {}));
  followed.global.follow(followed.reports, {{"b", 1}});
  EXPECT_EQ(followed.global.time(), at(1.4));
  const GlobalTrack& track = followed.global.entries()[0].track;
  EXPECT_NEAR(track.chart().toTracking(track.supporters()[0].state).mean(0), 0.14, 1e-3);
  EXPECT_EQ(track.supporters()[0].local.time, at(1.0));
  followed.report("a", 1.5, {localTrack(1, {0.16, 0.2})});
  EXPECT_EQ(followed.global.entries()[0].track.supporters()[0].local.time, at(1.5));
}

TEST(GlobalTracks, ASupporterThatItsTrackerNoLongerReportsLeavesAndMayReturn) {
  Followed followed;
  followed.report("a", 1.0, {withHits(localTrack(1, {0.1, 0.2}), 5)});
  followed.report("a", 1.1, {});
  ASSERT_EQ(followed.ids(), (Ids{1}));
  EXPECT_TRUE(followed.global.entries()[0].track.supporters().empty());
  followed.report("a", 2.0, {withHits(localTrack(1, {0.1, 0.2}), 6)});
  EXPECT_EQ(followed.ids(), (Ids{1}));
  followed.report("a", 2.1, {});
  followed.report("a", 2.2, {withHits(localTrack(1, {0.1, 0.2}), 2)});
  EXPECT_EQ(followed.ids(), (Ids{1, 2})) << "fewer hits than before: another track under the same id";
}

TEST(GlobalTracks, ASupporterThatIsAnotherTargetUnderItsIdLeaves) {
  Followed followed;
  followed.report("a", 1.0, {withHits(localTrack(1, {0.1, 0.2}), 50)});
  followed.report("a", 1.1, {withHits(localTrack(1, {0.9, 0.2}), 3)});
  EXPECT_EQ(followed.ids(), (Ids{1, 2}));
}

TEST(GlobalTracks, MergedTracksKeepTheOlderIdAndAllSupporters) {
  Followed followed;
  followed.report("a", 1.0, {localTrack(1, {0.1, 0.2})});
  followed.report("b", 1.0, {localTrack(7, {0.3, 0.2})});
  ASSERT_EQ(followed.ids(), (Ids{1, 2}));
  followed.global.merge({{1, 0}}, TrackerMisalignment(0.0));
  EXPECT_EQ(followed.ids(), (Ids{1}));
  EXPECT_EQ(followed.global.supportersOf("a"), (Ids{1}));
  EXPECT_EQ(followed.global.supportersOf("b"), (Ids{7}));
}

TEST(GlobalTracks, SilentOnesAreDeletedAndTheirIdsAreNotUsedAgain) {
  Followed followed;
  followed.report("a", 1.0, {localTrack(1, {0.1, 0.2})});
  followed.report("a", 1.1, {});
  followed.report("a", 6.0, {});
  EXPECT_EQ(followed.ids(), (Ids{1}));
  followed.report("a", 6.2, {});
  EXPECT_TRUE(followed.ids().empty()) << "remember is over";
  followed.report("a", 6.3, {localTrack(2, {0.1, 0.2})});
  EXPECT_EQ(followed.ids(), (Ids{2}));
  followed.global.reset();
  followed.report("a", 6.4, {localTrack(3, {0.1, 0.2})});
  EXPECT_EQ(followed.ids(), (Ids{3}));
}

}  // namespace
}  // namespace sightline::core
