#include "sightline/core/tracking/track_ids.h"

#include <gtest/gtest.h>

namespace sightline::core {
namespace {

struct Started {
  TrackOrigin from;
  std::uint32_t number;

  const TrackOrigin& origin() const { return from; }
  std::uint32_t id() const { return number; }
};

TrackOrigin origin(double t, std::uint32_t sighting, std::uint32_t parent = 0) {
  return {Time{} + durationOf(t), "left", sighting, parent};
}

TEST(TrackIds, CountFromOne) {
  TrackIds ids;
  EXPECT_EQ(ids.idOf(origin(1.0, 0)), 1u);
  EXPECT_EQ(ids.idOf(origin(1.0, 1)), 2u);
}

TEST(TrackIds, TrackThatStartsAgainFromItsSightingHasItsIdAndNoOtherHas) {
  TrackIds ids;
  const std::uint32_t first = ids.idOf(origin(1.0, 0)), second = ids.idOf(origin(1.0, 1));
  const std::uint32_t branch = ids.idOf(origin(2.0, 0, first));
  ids.remember(std::vector<Started>{{origin(1.0, 1), second}, {origin(2.0, 0, first), branch}});
  EXPECT_EQ(ids.idOf(origin(0.5, 0)), 4u);
  EXPECT_EQ(ids.idOf(origin(1.0, 1)), second);
  EXPECT_EQ(ids.idOf(origin(2.0, 0)), 5u) << "the sighting alone, not as a second hypothesis";
  EXPECT_EQ(ids.idOf(origin(2.0, 0, first)), branch);
  ids.forget();
  EXPECT_EQ(ids.idOf(origin(1.0, 1)), 6u);
}

TEST(TrackIds, TracksFromScansOfOneStampKeepDifferentIds) {
  TrackIds ids;
  const std::uint32_t first = ids.idOf(origin(1.0, 0)), second = ids.idOf(origin(1.0, 0));
  ASSERT_NE(first, second);
  ids.remember(std::vector<Started>{{origin(1.0, 0), first}, {origin(1.0, 0), second}});
  EXPECT_EQ(ids.idOf(origin(1.0, 0)), first);
  EXPECT_EQ(ids.idOf(origin(1.0, 0)), second);
  EXPECT_EQ(ids.idOf(origin(1.0, 0)), 3u);
}

TEST(TrackIds, GoOnBehindOneThatIsSkipped) {
  TrackIds ids;
  ids.skip(7);
  EXPECT_EQ(ids.idOf(origin(1.0, 0)), 8u);
  ids.skip(3);
  EXPECT_EQ(ids.idOf(origin(2.0, 0)), 9u);
}

}  // namespace
}  // namespace sightline::core
