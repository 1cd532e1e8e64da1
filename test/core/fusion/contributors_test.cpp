#include "sightline/core/fusion/contributors.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "support/local_tracks.h"

namespace sightline::core {
namespace {

using test::at;
using test::localTrack;

LocalTrack reported(Track track, const std::vector<std::string>& sensors) {
  track.sources = sensors;
  return {track, at(1.0), {}};
}

/// "b" is the surer one, and joins first.
GlobalTrack trackOf(const LocalTrack& b, const LocalTrack& a) {
  GlobalTrack track(1, at(1.0), {"b", 1}, b, 0.0);
  track.join({"a", 1}, a);
  return track;
}

TEST(Contributors, SupportersWithSensorsOfTheirOwnAllCountInOrderOfTheirKeys) {
  const GlobalTrack track = trackOf(reported(localTrack(1, {0.1, 0.2}, 1e-3), {"s"}),
                                    reported(localTrack(1, {0.1, 0.2}, 2e-3), {"t"}));
  const Contributors choice = chooseContributors(track, 0.5, false);
  EXPECT_EQ(choice.used, (std::vector<std::size_t>{1, 0}));
  EXPECT_TRUE(choice.left_out.empty());
}

TEST(Contributors, OfTwoThatShareASensorTheSurerCountsUnlessSharingIsAllowed) {
  const GlobalTrack track = trackOf(reported(localTrack(1, {0.1, 0.2}, 1e-3), {"s"}),
                                    reported(localTrack(1, {0.1, 0.2}, 2e-3), {"s"}));
  const Contributors choice = chooseContributors(track, 0.5, false);
  EXPECT_EQ(choice.used, (std::vector<std::size_t>{0}));
  ASSERT_EQ(choice.left_out.size(), 1u);
  EXPECT_EQ(choice.left_out[0].first, 1u);
  EXPECT_EQ(chooseContributors(track, 0.5, true).used.size(), 2u);
}

TEST(Contributors, OneThatContributedStaysUntilAnotherIsClearlySurer) {
  for (const bool is_clearly_surer : {false, true}) {
    const double sigma = is_clearly_surer ? 0.5e-3 : 0.9e-3;
    GlobalTrack track = trackOf(reported(localTrack(1, {0.1, 0.2}, 1e-3), {"s"}),
                                reported(localTrack(1, {0.1, 0.2}, sigma), {"s"}));
    track.setFused({0}, track.supporters()[0].state);
    EXPECT_EQ(chooseContributors(track, 0.5, false).used.front(), is_clearly_surer ? 1u : 0u);
  }
}

TEST(Contributors, CoastingSupporterCountsOnlyWhileItIsYoungOrAlone) {
  Track coasting = localTrack(1, {0.1, 0.2});
  coasting.status = TrackStatus::coasting;
  coasting.last_sighting = at(0.0);
  const GlobalTrack track = trackOf(reported(coasting, {"s"}), reported(localTrack(1, {0.1, 0.2}), {"t"}));
  EXPECT_EQ(chooseContributors(track, 0.5, false).used, (std::vector<std::size_t>{1}));
  EXPECT_EQ(chooseContributors(track, 1.5, false).used.size(), 2u) << "young";
  const GlobalTrack alone(1, at(1.0), {"b", 1}, reported(coasting, {"s"}), 0.0);
  EXPECT_EQ(chooseContributors(alone, 0.5, false).used.size(), 1u);
}

TEST(Contributors, UncertaintyIsTheLogOfTheDeterminantAndInfiniteWithoutOne) {
  AngularState state;
  state.covariance.diagonal() << 1.0, 2.0, 3.0, 4.0;
  EXPECT_NEAR(uncertainty(state), std::log(24.0), 1e-12);
  state.covariance(0, 0) = -1.0;
  EXPECT_EQ(uncertainty(state), std::numeric_limits<double>::infinity());
}

TEST(Contributors, ATrackWithoutNamedSensorsIsNoticed) {
  const GlobalTrack track =
      trackOf(reported(localTrack(1, {0.1, 0.2}), {"s"}), reported(localTrack(1, {0.1, 0.2}), {}));
  EXPECT_TRUE(nameTheirSensors(track, {0}));
  EXPECT_FALSE(nameTheirSensors(track, {0, 1}));
}

}  // namespace
}  // namespace sightline::core
