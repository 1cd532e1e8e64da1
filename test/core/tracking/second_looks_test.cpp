#include "sightline/core/tracking/second_looks.h"

#include <cmath>

#include <gtest/gtest.h>

#include "sightline/core/estimators/estimators.h"
#include "sightline/core/model/sphere.h"

namespace sightline::core {
namespace {

Scan lookAt(double time, double azimuth, int sightings = 1) {
  Scan scan;
  scan.time = Time(durationOf(time));
  scan.sensor = "eye";
  for (int j = 0; j < sightings; ++j)
    scan.sightings.push_back(sightingOf({azimuth + 0.5 * j, 0.0}, 1e-6 * Eigen::Matrix2d::Identity()));
  return scan;
}

LiveTrack seenOnce(std::uint32_t id, double azimuth) {
  const Scan scan = lookAt(0.0, azimuth);
  return LiveTrack(id, {}, scan, scan.sightings[0], makeEstimator({}), 1.0, {});
}

TrackPrediction at(double azimuth, bool believed, double change_sigma) {
  TrackPrediction prediction;
  prediction.direction = directionOf({azimuth, 0.0});
  prediction.believed = believed;
  prediction.change_sigma = change_sigma;
  return prediction;
}

TEST(SecondLooks, RatesOfATentativeTrackNearABelievedOneDoNotChange) {
  std::vector<TrackPrediction> predictions = {at(0.0, true, 0.0), at(0.05, false, 0.01),
                                              at(0.2, false, 0.01)};
  keepApart(predictions);
  EXPECT_EQ(predictions[1].change_sigma, 0.0);
  EXPECT_EQ(predictions[2].change_sigma, 0.01);
}

TEST(SecondLooks, AScanIsClearWithFewSightingsOfNoTrackAndFewFalseOnesExpected) {
  EXPECT_TRUE(isClear(lookAt(0.0, 0.0, 3), {}, 1.0));
  EXPECT_FALSE(isClear(lookAt(0.0, 0.0, 4), {}, 1.0));
  EXPECT_FALSE(isClear(lookAt(0.0, 0.0, 1), {}, 2.0));
}

TEST(SecondLooks, AnUnlikelySecondLookMakesASecondTrackAndLeavesTheFirstAsItIs) {
  std::vector<LiveTrack> tracks = {seenOnce(1, 0.0)};
  const Scan scan = lookAt(0.0333, 0.666);
  RevisitTime interval;
  interval.note(0.0333);
  const std::vector<TrackPrediction> predictions = {tracks[0].predict(scan, {0.9, interval, true}, {}, true)};
  ASSERT_GT(predictions[0].since_only_sighting, 0.0);
  const AssociationResult result = associate(scan, predictions, {}, 1.2, AssociationMethod::nearest, true);
  ASSERT_EQ(result.sighting_of[0], -1) << "20 rad/s is less likely than a miss and a false sighting";
  ASSERT_EQ(result.second_looks.size(), 1u);

  TrackIds ids;
  ids.skip(6);
  const std::vector<LiveTrack> branches = branchesOf(tracks, scan, predictions, result, {}, ids);
  ASSERT_EQ(branches.size(), 1u);
  EXPECT_EQ(ids.idOf({}), 8u);
  EXPECT_EQ(branches[0].id(), 7u);
  EXPECT_EQ(branches[0].lifecycle().hits(), 2u);
  EXPECT_EQ(tracks[0].lifecycle().hits(), 1u);
  const Track report = branches[0].report(scan.time, {}, true, {});
  EXPECT_NEAR(report.state.rates().x(), 20.0, 1.0);
  EXPECT_LT(report.existence, 0.9);
  EXPECT_TRUE(associate(scan, predictions, {}, 1.2).second_looks.empty());
}

}  // namespace
}  // namespace sightline::core
