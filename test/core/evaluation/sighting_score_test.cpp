#include "sightline/core/evaluation/sighting_score.h"

#include <cmath>

#include <gtest/gtest.h>

#include "sightline/core/model/sphere.h"

using namespace sightline::core;

namespace {

constexpr double kSigma = 0.01;  // [rad]
const SightingGate kGate{3.0, 0.0};

TrueTarget target(std::uint32_t id, double azimuth) {
  TrueTarget result;
  result.id = id;
  result.state.mean << azimuth, 0.0, 0.0, 0.0;
  return result;
}

Scan scan(const std::vector<double>& azimuths, double sigma = kSigma) {
  Scan result;
  result.sensor = "camera";
  for (const double azimuth : azimuths)
    result.sightings.push_back(sightingOf({azimuth, 0.0}, Eigen::Matrix2d::Identity() * sigma * sigma));
  return result;
}

SightingScore score() {
  return {"sightings", "camera", Channels::azimuth_and_elevation};
}

TEST(SightingScore, AsManySightingsAsPossibleAreAssignedAndTheNearestTogether) {
  // The sighting at 0.025 is nearer to target 1 but the only one that target 2 can have.
  SightingScore result = score();
  std::vector<ScoredPair> pairs;
  result.add(scan({0.025, -0.028}), {target(1, 0.0), target(2, 0.052)}, kGate,
             {[&](const ScoredPair& pair) { pairs.push_back(pair); }, {}});
  ASSERT_EQ(pairs.size(), 2u);
  EXPECT_EQ(pairs[0].target, 1u);
  EXPECT_NEAR(pairs[0].angles.x(), -0.028, 1e-12);
  EXPECT_EQ(pairs[1].target, 2u);
  EXPECT_NEAR(pairs[1].angles.x(), 0.025, 1e-12);
  EXPECT_EQ(pairs[0].name, "camera");
  EXPECT_EQ(result.unmatched(), 0u);
  EXPECT_NEAR(result.lastError(), std::sqrt((0.028 * 0.028 + 0.027 * 0.027) / 4.0), 1e-6);
}

TEST(SightingScore, ASightingBeyondTheGateIsUnmatched) {
  SightingScore result = score();
  result.add(scan({0.031}), {target(1, 0.0)}, kGate, {});
  EXPECT_EQ(result.unmatched(), 1u);
  EXPECT_EQ(result.errors().samples(), 0u);
  EXPECT_TRUE(std::isnan(result.lastError()));
  result.add(scan({0.029}), {target(1, 0.0)}, kGate, {});
  EXPECT_EQ(result.unmatched(), 1u);
  EXPECT_EQ(result.errors().samples(), 1u);
}

TEST(SightingScore, WithinTheFloorTheStatedSigmaDoesNotMatter) {
  SightingScore result = score();
  result.add(scan({0.02}, 1e-4), {target(1, 0.0)}, {3.0, 0.03}, {});
  EXPECT_EQ(result.errors().samples(), 1u);
}

TEST(SightingScore, ATargetThatIsNotScoredKeepsItsSightingAndAddsNoError) {
  SightingScore result = score();
  TrueTarget young = target(1, 0.0);
  young.is_scored = false;
  int pairs = 0;
  result.add(scan({0.01}), {young}, kGate, {[&](const ScoredPair&) { ++pairs; }, {}});
  EXPECT_EQ(result.unmatched(), 0u);
  EXPECT_EQ(result.errors().samples(), 0u);
  EXPECT_EQ(pairs, 0);
}

TEST(SightingScore, StatedSigmaIsTheRootMeanStatedVarianceOfAChannel) {
  SightingScore result = score();
  EXPECT_TRUE(std::isnan(result.statedSigma()));
  result.note(scan({0.0}, 0.01));
  result.note(scan({0.0}, 0.03));
  EXPECT_NEAR(result.statedSigma(), std::sqrt((1e-4 + 9e-4) / 2.0), 1e-9);
}

}  // namespace
