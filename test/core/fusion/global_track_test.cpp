#include "sightline/core/fusion/global_track.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "support/local_tracks.h"

namespace sightline::core {
namespace {

using test::at;
using test::localTrack;

LocalTrack reported(const Track& track, double t) {
  return {track, at(t), {}};
}

GlobalTrack threeSupporters(double azimuth_of_c) {
  GlobalTrack track(7, at(1.0), {"a", 1}, reported(localTrack(1, {0.1, 0.2}), 1.0), 0.0);
  track.join({"b", 1}, reported(localTrack(1, {0.1, 0.2}), 1.0));
  track.join({"c", 1}, reported(localTrack(1, {azimuth_of_c, 0.2}), 1.0));
  return track;
}

TEST(GlobalTrack, DistanceIsSymmetricNormalisedAndInfiniteWhereItIsNotDetermined) {
  Estimate<4> a, b;
  b.mean(0) = 2.0;
  EXPECT_NEAR(distanceSquared(a, b, 0.0), 2.0, 1e-12);
  EXPECT_NEAR(distanceSquared(b, a, 0.0), 2.0, 1e-12);
  EXPECT_NEAR(distanceSquared(a, b, std::sqrt(2.0)), 1.0, 1e-12);
  b.covariance = -2.0 * Eigen::Matrix4d::Identity();
  EXPECT_EQ(distanceSquared(a, b, 0.0), std::numeric_limits<double>::infinity());
}

TEST(GlobalTrack, AdvanceMovesSupportersAlongTheirRatesAndMakesThemLessCertain) {
  GlobalTrack track(1, at(1.0), {"a", 1}, reported(localTrack(1, {0.1, 0.2}, 1e-3, {0.3, -0.1}), 1.0), 0.0);
  const double before = track.state().covariance(0, 0);
  track.advance(at(1.5));
  EXPECT_EQ(track.time(), at(1.5));
  const AngularState moved = track.chart().toTracking(track.supporters()[0].state);
  EXPECT_NEAR(moved.mean(0), 0.25, 2e-3);
  EXPECT_NEAR(moved.mean(1), 0.15, 2e-3);
  EXPECT_GT(track.state().covariance(0, 0), before);
}

TEST(GlobalTrack, SupportersAreFoundByTheirTracker) {
  GlobalTrack track = threeSupporters(0.1);
  EXPECT_EQ(track.numberOf("b"), 1u);
  EXPECT_FALSE(track.hasTracker("d"));
  track.leave(1);
  EXPECT_FALSE(track.hasTracker("b"));
  EXPECT_EQ(track.numberOf("c"), 1u);
}

TEST(GlobalTrack, OneThatContradictsTheMajorityDoesNotCount) {
  GlobalTrack track = threeSupporters(0.2);
  EXPECT_EQ(track.leaveOutContradictions(TrackerMisalignment(0.0), 37.0, {{"c", 1}}),
            (std::vector<std::size_t>{2}));
  EXPECT_EQ(track.usable(), (std::vector<std::size_t>{0, 1}));
  EXPECT_EQ(track.supporters()[2].contradicts_since, at(1.0));
  EXPECT_FALSE(track.supporters()[0].contradicts_since);
}

TEST(GlobalTrack, SupportersThatAgreeAllCount) {
  GlobalTrack track = threeSupporters(0.1);
  EXPECT_TRUE(track.leaveOutContradictions(TrackerMisalignment(0.0), 37.0, {{"c", 1}}).empty());
  EXPECT_EQ(track.usable().size(), 3u);
  for (const Supporter& supporter : track.supporters()) EXPECT_NEAR(supporter.distance_squared, 0.0, 1e-9);
}

TEST(GlobalTrack, MisplacedIsRememberedFromTheFirstTimeOn) {
  GlobalTrack track = threeSupporters(0.1);
  EXPECT_EQ(track.setMisplaced(1, true), at(1.0));
  track.advance(at(1.2));
  EXPECT_EQ(track.setMisplaced(1, true), at(1.0));
  EXPECT_FALSE(track.setMisplaced(1, false));
}

TEST(GlobalTrack, AbsorbsTheSupportersOfAnotherInItsOwnChart) {
  GlobalTrack one(1, at(1.0), {"a", 1}, reported(localTrack(1, {0.1, 0.2}), 1.0), 0.0);
  const GlobalTrack other(2, at(1.0), {"b", 1}, reported(localTrack(1, {0.11, 0.21}), 1.0), 0.0);
  EXPECT_FALSE(one.hasAnyTrackerOf(other));
  one.absorb(other);
  EXPECT_TRUE(one.hasAnyTrackerOf(other));
  const AngularState taken = one.chart().toTracking(one.supporters()[1].state);
  EXPECT_TRUE(taken.angles().isApprox(Eigen::Vector2d(0.11, 0.21), 1e-9));
}

TEST(GlobalTrack, FusionMarksItsContributorsAndSetsTheState) {
  GlobalTrack track = threeSupporters(0.1);
  const AngularState state = track.supporters()[1].state;
  track.setFused({1}, state);
  EXPECT_FALSE(track.supporters()[0].contributed);
  EXPECT_TRUE(track.supporters()[1].contributed);
  EXPECT_EQ(track.state().mean, state.mean);
  EXPECT_EQ(track.lastFusion(), at(1.0));
}

}  // namespace
}  // namespace sightline::core
