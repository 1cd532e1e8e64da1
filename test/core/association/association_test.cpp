#include "sightline/core/association/association.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace sightline::core {
namespace {

constexpr double kSigma = 1e-3;

TrackPrediction prediction(std::uint32_t id, double azimuth, bool believed = true, double sigma = kSigma) {
  TrackPrediction prediction;
  prediction.id = id;
  prediction.believed = believed;
  prediction.guards = believed;
  prediction.state.mean << azimuth, 0.0, 0.0, 0.0;
  prediction.direction = directionOf({azimuth, 0.0});
  prediction.state.covariance = Eigen::Matrix4d::Identity() * sigma * sigma;
  return prediction;
}

Scan scanOf(const std::vector<double>& azimuths) {
  Scan scan;
  for (const double azimuth : azimuths)
    scan.sightings.push_back(sightingOf({azimuth, 0.0}, Eigen::Matrix2d::Identity() * kSigma * kSigma));
  return scan;
}

TEST(Association, TakesTheOptimumAndNotTheNearestPairFirst) {
  // The nearest pair is (track 1, sighting 0), but it would leave track 2 without its only sighting.
  const AssociationResult pairing =
      associate(scanOf({0.0008, -0.003}), {prediction(1, 0.0), prediction(2, 0.004)}, GateParams{}, 1.0);
  EXPECT_EQ(pairing.sighting_of, (std::vector<int>{1, 0}));
  EXPECT_EQ(pairing.prediction_of, (std::vector<int>{1, 0}));
}

TEST(Association, EverySightingHasItsDecisionAndItsNumbers) {
  const AssociationResult pairing =
      associate(scanOf({0.0, 0.001, 0.5, 0.012}), {prediction(7, 0.0)}, GateParams{}, 1.0);
  EXPECT_EQ(pairing.decisions[0].decision, Decision::accepted);
  EXPECT_EQ(pairing.decisions[0].track, 7u);
  EXPECT_EQ(pairing.decisions[1].decision, Decision::claimed_by_other);
  EXPECT_EQ(pairing.decisions[1].track, 7u);
  EXPECT_NEAR(pairing.decisions[1].distance_squared, 0.5, 1e-9);
  EXPECT_FALSE(pairing.may_start[1]);
  EXPECT_EQ(pairing.decisions[2].decision, Decision::outside_gate);
  EXPECT_TRUE(pairing.may_start[2]);
  EXPECT_EQ(pairing.decisions[3].decision, Decision::outside_gate);
  for (std::size_t j = 0; j < 4; ++j) EXPECT_EQ(pairing.decisions[j].sighting, j);
}

TEST(Association, BelievedTracksChooseBeforeTentativeOnes) {
  const AssociationResult pairing =
      associate(scanOf({0.001}), {prediction(1, 0.001, false), prediction(2, 0.0)}, GateParams{}, 1.0);
  EXPECT_EQ(pairing.sighting_of, (std::vector<int>{-1, 0}));
}

TEST(Association, NothingOutsideAGateIsEverPaired) {
  const AssociationResult pairing =
      associate(scanOf({0.1, -0.1}), {prediction(1, 0.0), prediction(2, 0.05)}, GateParams{}, 1.0);
  EXPECT_EQ(pairing.sighting_of, (std::vector<int>{-1, -1}));
}

TEST(Association, PairsAreTheSameWhateverTheOrderOfSightings) {
  std::vector<double> azimuths{0.0, 0.0011, 0.0025, 0.004, 0.3};
  const std::vector<TrackPrediction> predictions{prediction(1, 0.0005), prediction(2, 0.002),
                                                 prediction(3, 0.0041)};
  const AssociationResult straight = associate(scanOf(azimuths), predictions, GateParams{}, 1.0);
  std::reverse(azimuths.begin(), azimuths.end());
  const AssociationResult reversed = associate(scanOf(azimuths), predictions, GateParams{}, 1.0);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(straight.sighting_of[i], 4 - reversed.sighting_of[i]);
}

TEST(Association, LeavesASightingToTheClutterWhereThatIsMoreLikely) {
  // At d^2 = 9 the sighting has P_D N = 0.9 exp(-4.5) / (2 pi sigma_S^2) = 796 a steradian; a miss has 0.1.
  const Scan scan = scanOf({3.0 * kSigma * std::sqrt(2.0)});
  const double density = 0.9 * std::exp(-4.5) / (2.0 * 3.14159265358979 * 2.0 * kSigma * kSigma);
  EXPECT_EQ(associate(scan, {prediction(1, 0.0)}, GateParams{}, 9.9 * density).sighting_of[0], 0);
  EXPECT_EQ(associate(scan, {prediction(1, 0.0)}, GateParams{}, 10.1 * density).sighting_of[0], -1);
}

TEST(Association, EvidenceIsTheLikelihoodOfTheTargetOverThatOfClutter) {
  const AssociationResult pairing =
      associate(scanOf({0.0}), {prediction(1, 0.0), prediction(2, 0.5)}, GateParams{}, 50.0);
  const double N = 1.0 / (2.0 * 3.14159265358979 * 2.0 * kSigma * kSigma);
  EXPECT_NEAR(pairing.evidence[0], 0.1 + 0.9 * N / 50.0, 1e-6 * N);
  EXPECT_NEAR(pairing.evidence[1], 0.1, 1e-12);
}

TEST(Association, EvidenceIsTheSameAtEveryElevation) {
  // The same sighting on the sphere, at the equator and at 67 degrees, in the same clutter.
  double evidence[2];
  for (const double elevation : {0.0, 1.17}) {
    const Eigen::Vector2d sigma(kSigma / std::cos(elevation), kSigma);
    TrackPrediction there = prediction(1, 0.0);
    there.chart = Chart::around(directionOf({0.2, elevation}));
    there.state.mean << 0.0, elevation, 0.0, 0.0;
    there.direction = there.chart.directionAt({0.0, elevation});
    there.state.covariance.topLeftCorner<2, 2>() = sigma.cwiseAbs2().asDiagonal();
    Scan scan;
    scan.sightings.push_back(sightingOf({0.2, elevation}, sigma.cwiseAbs2().asDiagonal()));
    evidence[elevation > 0.0] = associate(scan, {there}, GateParams{}, 5.0).evidence[0];
  }
  EXPECT_NEAR(evidence[0], evidence[1], 1e-6 * evidence[0]);
}

TEST(Association, JointProbabilitiesShareASightingThatTwoMayHaveGiven) {
  // Symmetric: each of two tracks has half a claim on what lies between them.
  const Scan scan = scanOf({0.0, 0.0015, 0.003});
  const AssociationResult pairing = associate(scan, {prediction(1, 0.0005), prediction(2, 0.0025)},
                                              GateParams{}, 1000.0, AssociationMethod::jpda);
  ASSERT_EQ(pairing.sighting_of, (std::vector<int>{0, 2}));
  ASSERT_EQ(pairing.possible[0].size(), 3u);
  EXPECT_NEAR(pairing.possible[0][1].probability, pairing.possible[1][1].probability, 1e-9);
  EXPECT_GT(pairing.possible[0][0].probability, pairing.possible[0][1].probability);
  EXPECT_GT(pairing.possible[0][1].probability, pairing.possible[0][2].probability);
  double sum = 0.0;
  for (const PossibleSighting& possible : pairing.possible[0]) sum += possible.probability;
  EXPECT_LE(sum, 1.0 + 1e-12);
}

TEST(Association, JointEvidenceIsThatOfTheNearestWhereThereIsNoDoubt) {
  std::vector<TrackPrediction> predictions{prediction(1, 0.0), prediction(2, 0.5)};
  for (TrackPrediction& prediction : predictions) prediction.existence = 0.9;
  const AssociationResult nearest = associate(scanOf({0.0}), predictions, GateParams{}, 50.0);
  const AssociationResult joint =
      associate(scanOf({0.0}), predictions, GateParams{}, 50.0, AssociationMethod::jpda);
  for (int i : {0, 1}) EXPECT_NEAR(joint.evidence[i], nearest.evidence[i], 1e-6 * nearest.evidence[i]);
}

TEST(Association, ATargetThatTheSensorDoesNotLookAtIsNotMissed) {
  TrackPrediction out_of_view = prediction(1, 0.5);
  out_of_view.visibility = 0.0;
  EXPECT_EQ(associate(scanOf({0.0}), {out_of_view}, GateParams{}, 1.0).evidence[0], 1.0);
}

TEST(Association, ASensorThatMayNotSeeTheTargetIsLessLikelyToHaveShownIt) {
  // P_D is 0.9 and the visibility a half: 0.45 N over the clutter against a miss of 0.55.
  TrackPrediction unseen = prediction(1, 0.0);
  unseen.visibility = 0.5;
  const double N = 1.0 / (2.0 * 3.14159265358979 * 2.0 * kSigma * kSigma);
  EXPECT_NEAR(associate(scanOf({0.0}), {unseen}, GateParams{}, 50.0).evidence[0], 0.55 + 0.45 * N / 50.0,
              1e-6 * N);
  const double least = 0.45 / 0.55 * N;  // density of clutter that explains it as well
  EXPECT_EQ(associate(scanOf({0.0}), {unseen}, GateParams{}, 0.99 * least).sighting_of[0], 0);
  EXPECT_EQ(associate(scanOf({0.0}), {unseen}, GateParams{}, 1.01 * least).sighting_of[0], -1);
  unseen.visibility = 0.0;  // a field of view is not exact
  EXPECT_EQ(associate(scanOf({0.0}), {unseen}, GateParams{}, 1.0).sighting_of[0], 0);
}

TEST(Association, WorksAcrossTheWrapAndAtAnElevationOf67Degrees) {
  TrackPrediction far = prediction(1, 0.0);
  far.chart = Chart::around(directionOf({3.1415, 0.0}));
  far.state.mean << 0.0, 1.17, 0.0, 0.0;
  far.direction = far.chart.directionAt({0.0, 1.17});
  Scan scan;
  const double azimuth_sigma = kSigma / std::cos(1.17);
  scan.sightings.push_back(sightingOf(
      {-3.1412, 1.171}, Eigen::Vector2d(azimuth_sigma * azimuth_sigma, kSigma * kSigma).asDiagonal()));
  EXPECT_EQ(associate(scan, {far}, GateParams{}, 1.0).sighting_of, std::vector<int>{0});
}

TEST(Association, EmptyScansAndNoTracksAreFine) {
  EXPECT_EQ(associate(Scan{}, {prediction(1, 0.0)}, GateParams{}, 1.0).sighting_of, std::vector<int>{-1});
  EXPECT_TRUE(associate(scanOf({0.0}), {}, GateParams{}, 1.0).may_start[0]);
}

}  // namespace
}  // namespace sightline::core
