#include "sightline/core/tracking/duplicate_tracks.h"

#include <gtest/gtest.h>

namespace sightline::core {
namespace {

constexpr double kSigma = 1e-3;

TrackPrediction prediction(std::uint32_t id, double azimuth, double rate = 0.0) {
  TrackPrediction prediction;
  prediction.id = id;
  prediction.believed = true;
  prediction.state.mean << azimuth, 0.0, rate, 0.0;
  prediction.state.covariance = Eigen::Matrix4d::Identity() * kSigma * kSigma;
  prediction.direction = directionOf({azimuth, 0.0});
  return prediction;
}

AssociationResult pairing(int first, int second) {
  AssociationResult pairing;
  pairing.sighting_of = {first, second};
  return pairing;
}

TEST(DuplicateTracks, OfTwoThatShareTheSightingsOfOneTargetTheYoungerGoes) {
  DuplicateTracks duplicates;
  const std::vector<TrackPrediction> both{prediction(3, 0.0), prediction(8, 0.001)};
  for (int k = 0; k < 9; ++k)
    EXPECT_TRUE(duplicates.watch(both, k % 2 ? pairing(0, -1) : pairing(-1, 0), 10).empty());
  EXPECT_EQ(duplicates.watch(both, pairing(0, -1), 10), std::vector<std::uint32_t>{8});
}

TEST(DuplicateTracks, AScanThatShowsBothEndsTheSuspicion) {
  DuplicateTracks duplicates;
  const std::vector<TrackPrediction> both{prediction(3, 0.0), prediction(8, 0.001)};
  for (int k = 0; k < 100; ++k)
    EXPECT_TRUE(duplicates.watch(both, k % 5 ? pairing(0, -1) : pairing(0, 1), 10).empty());
}

TEST(DuplicateTracks, TracksWithOtherMotionsAreNone) {
  DuplicateTracks duplicates;
  const std::vector<TrackPrediction> crossing{prediction(3, 0.0, 0.02), prediction(8, 0.001, -0.02)};
  const std::vector<TrackPrediction> apart{prediction(3, 0.0), prediction(8, 0.02)};
  for (int k = 0; k < 100; ++k) {
    EXPECT_TRUE(duplicates.watch(crossing, pairing(0, -1), 10).empty());
    EXPECT_TRUE(duplicates.watch(apart, pairing(0, -1), 10).empty());
  }
}

TEST(DuplicateTracks, ScansThatShowNeitherTellNothing) {
  DuplicateTracks duplicates;
  const std::vector<TrackPrediction> both{prediction(3, 0.0), prediction(8, 0.001)};
  for (int k = 0; k < 100; ++k) EXPECT_TRUE(duplicates.watch(both, pairing(-1, -1), 10).empty());
}

TEST(DuplicateTracks, TracksThatAreNotBelievedAreLeftAlone) {
  DuplicateTracks duplicates;
  std::vector<TrackPrediction> both{prediction(3, 0.0), prediction(8, 0.001)};
  both[1].believed = false;
  for (int k = 0; k < 100; ++k) EXPECT_TRUE(duplicates.watch(both, pairing(0, -1), 10).empty());
}

}  // namespace
}  // namespace sightline::core
