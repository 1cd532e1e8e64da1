#include "sightline/core/fusion/association/supporter_assignment.h"

#include <gtest/gtest.h>

#include "support/local_tracks.h"

namespace sightline::core {
namespace {

using test::at;
using test::localTrack;

LocalTrack reported(const Track& track) {
  return {track, at(1.0), {}};
}

/// A global track that "a" and "b" see at these azimuths [rad].
GlobalTrack seenAt(std::uint32_t id, double by_a, double by_b) {
  GlobalTrack track(id, at(1.0), {"a", id}, reported(localTrack(id, {by_a, 0.2})), 0.0);
  track.join({"b", id}, reported(localTrack(id, {by_b, 0.2})));
  track.compareSupporters(TrackerMisalignment(0.0));
  return track;
}

TEST(SupporterAssignment, NothingIsSaidWhereNobodyIsInDoubt) {
  const GlobalTrack one = seenAt(1, 0.1, 0.1), two = seenAt(2, 0.3, 0.3);
  EXPECT_TRUE(supporterMoves("a", {}, {&one, &two}, {}).empty());
}

TEST(SupporterAssignment, OneThatFitsNowhereShouldHaveAGlobalTrackOfItsOwn) {
  const GlobalTrack one = seenAt(1, 0.15, 0.1);
  const std::vector<SupporterMove> moves = supporterMoves("a", {}, {&one}, {});
  ASSERT_EQ(moves.size(), 1u);
  EXPECT_EQ(moves[0].present, 0u);
  EXPECT_FALSE(moves[0].best);
}

}  // namespace
}  // namespace sightline::core
