#include "sightline/core/tracking/published_tracks.h"

#include <limits>

#include <gtest/gtest.h>

namespace sightline::core {
namespace {

Track good(std::uint32_t id) {
  Track track;
  track.id = id;
  track.state.mean << 1.0, 0.5, 0.1, 0.0;
  track.state.covariance = Eigen::Vector4d(1e-6, 1e-6, 1e-4, 1e-4).asDiagonal();
  return track;
}

TEST(PublishedTracks, WhatIsNoneByItsStateIsNoTrack) {
  Track not_finite = good(2), too_wide = good(3), indefinite = good(4), no_gate = good(5), huge = good(6);
  not_finite.state.covariance(2, 2) = std::numeric_limits<double>::quiet_NaN();
  too_wide.state.covariance(1, 1) = 10.0;
  indefinite.state.covariance(0, 2) = indefinite.state.covariance(2, 0) = 2e-5;
  no_gate.gate.half_width.x() = std::numeric_limits<double>::quiet_NaN();
  huge.state.covariance *= 1e300;
  EXPECT_TRUE(isTrack(good(1)));
  for (const Track& track : {not_finite, too_wide, indefinite, no_gate, huge})
    EXPECT_FALSE(isTrack(track)) << track.id;
}

TEST(PublishedTracks, AWideAzimuthNearThePoleIsATrack) {
  Track track = good(1);
  track.state.mean(1) = 1.57;
  track.state.covariance(0, 0) = 100.0;  // a sigma of 8 mrad on the sphere
  EXPECT_TRUE(isTrack(track));
}

TEST(PublishedTracks, CovariancesWithARangeOfManyDecadesAreTracks) {
  Track track = good(1);
  track.state.covariance = Eigen::Vector4d(1e-16, 1e-2, 1e-12, 1e4).asDiagonal();
  track.state.covariance(0, 2) = track.state.covariance(2, 0) = 1e-14;  // correlated to rounding
  EXPECT_TRUE(isTrack(track));
}

}  // namespace
}  // namespace sightline::core
