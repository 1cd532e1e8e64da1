#include "sightline/core/tracking/new_beginning.h"

#include <gtest/gtest.h>

#include "sightline/core/estimators/estimators.h"
#include "sightline/core/model/sphere.h"

namespace sightline::core {
namespace {

constexpr double kNoise = 1e-3;

Scan lookAt(double time, double azimuth, double sigma, const std::string& sensor = "eye") {
  Scan scan;
  scan.time = Time(durationOf(time));
  scan.sensor = sensor;
  scan.sightings.push_back(sightingOf({azimuth, 0.0}, sigma * sigma * Eigen::Matrix2d::Identity()));
  return scan;
}

/// A track that began with `sensor`, by sigmas a thousand times too small, and was confirmed if asked for.
LiveTrack trackOf(std::uint32_t id, const std::string& sensor, bool is_confirmed) {
  const Scan scan = lookAt(0.0, 0.1, 1e-6, sensor);
  LiveTrack track(id, {scan.time, sensor, 0}, scan, scan.sightings[0], makeEstimator({}), 1.0, {});
  RevisitTime interval;
  interval.note(0.1);
  for (int k = 1; is_confirmed && k < 20; ++k) {
    const Scan next = lookAt(0.1 * k, 0.1, 1e-6, sensor);
    track.update(next, next.sightings[0], track.predict(next, {0.9, interval, true}, {}, true), {}, 1e3, {});
  }
  return track;
}

std::uint32_t begin(std::vector<LiveTrack>& tracks, TrackIds& ids) {
  return begunAnew(tracks, lookAt(3.0, 0.2, kNoise), makeEstimator({}), 1.0, {}, ids);
}

TEST(NewBeginning, TheOldestEstablishedTrackGoesOnFromTheSightingAndOthersOfTheSensorEnd) {
  std::vector<LiveTrack> tracks = {trackOf(1, "eye", false), trackOf(2, "eye", true), trackOf(3, "ear", true),
                                   trackOf(4, "eye", true)};
  ASSERT_FALSE(tracks[1].lifecycle().isTentative());
  TrackIds ids;
  EXPECT_EQ(begin(tracks, ids), 2u);
  ASSERT_EQ(tracks.size(), 2u);
  EXPECT_EQ(tracks[0].id(), 2u);
  EXPECT_EQ(tracks[1].id(), 3u) << "of another sensor";
  const Track reported = tracks[0].report(Time(durationOf(3.0)), {}, true, {});
  EXPECT_NEAR(reported.state.mean(0), 0.2, 1e-9);
  EXPECT_NEAR(std::sqrt(reported.state.covariance(0, 0)), kNoise, 0.1 * kNoise);
  EXPECT_EQ(reported.hits, 21u) << "sightings of the target, the earlier ones too";
  EXPECT_EQ(tracks[0].lifecycle().hitsSinceFound(), 1u);
  EXPECT_EQ(tracks[0].origin().time, Time{}) << "the sighting that started the track";
}

TEST(NewBeginning, WhereNoTrackIsEstablishedANewOneBegins) {
  std::vector<LiveTrack> tracks = {trackOf(1, "eye", false), trackOf(2, "ear", true)};
  TrackIds ids;
  ids.skip(2);
  EXPECT_EQ(begin(tracks, ids), 3u);
  ASSERT_EQ(tracks.size(), 2u);
  EXPECT_EQ(tracks[0].id(), 2u);
  EXPECT_EQ(tracks[1].id(), 3u);
}

}  // namespace
}  // namespace sightline::core
