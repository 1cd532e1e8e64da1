#include "sightline/core/evaluation/metrics.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include "sightline/core/model/chart.h"
#include "sightline/core/model/sphere.h"

#include "support/golden.h"

using namespace sightline::core;

namespace {

AngularState state(double azimuth, double elevation, double azimuth_rate = 0.0, double elevation_rate = 0.0) {
  AngularState result;
  result.mean << azimuth, elevation, azimuth_rate, elevation_rate;
  return result;
}

TEST(ErrorOf, IsAnArcOnTheSphere) {
  AngularState estimate = state(0.52, 1.0 + 0.003, 0.2, 0.1);
  estimate.covariance.setIdentity();
  const DirectionError error = errorOf(estimate, state(0.5, 1.0, 0.1, 0.3));
  EXPECT_NEAR(error.position.x(), 0.02 * std::cos(1.0), 1e-12);
  EXPECT_NEAR(error.position.y(), 0.003, 1e-12);
  ASSERT_TRUE(error.rate);
  EXPECT_NEAR(error.rate->x(), 0.1 * std::cos(1.0), 1e-12);
  EXPECT_NEAR(error.rate->y(), -0.2, 1e-12);
  EXPECT_NEAR(error.sigma.x(), std::cos(1.0), 1e-12);
  EXPECT_NEAR(error.sigma.y(), 1.0, 1e-12);
}

TEST(ErrorOf, NormalisedSquaresAreThoseWorkedByHand) {
  AngularState estimate = state(0.3, -0.2, 1.0, 2.0);
  estimate.covariance.diagonal() << 0.04, 0.01, 4.0, 1.0;
  const DirectionError error = errorOf(estimate, state(0.1, -0.1, 3.0, 2.0));
  EXPECT_NEAR(*error.position_nees, (1.0 + 1.0) / 2.0, 1e-9);           // 0.2^2 / 0.04, 0.1^2 / 0.01
  EXPECT_NEAR(*error.state_nees, (1.0 + 1.0 + 1.0 + 0.0) / 4.0, 1e-9);  // 2^2 / 4
}

TEST(ErrorOf, DoesNotSeeTheWrap) {
  AngularState estimate = state(-kPi + 0.01, 0.2);
  estimate.covariance.setIdentity();
  EXPECT_NEAR(errorOf(estimate, state(kPi - 0.02, 0.2)).position.x(), 0.03 * std::cos(0.2), 1e-12);
}

TEST(ErrorOf, IsTheAngleBetweenAtTheZenith) {
  for (const double elevation : {kPi / 2 - 1e-3, kPi / 2 - 1e-7, -kPi / 2 + 1e-3}) {
    AngularState estimate = state(2.0, elevation);
    estimate.covariance.setIdentity();
    const AngularState truth = state(-1.0, elevation);
    const double angle = angleBetween(directionOf(estimate.angles()), directionOf(truth.angles()));
    EXPECT_NEAR(errorOf(estimate, truth).position.norm(), angle, 1e-6 * angle) << elevation;
  }
}

TEST(ErrorOf, NormalisedSquareIsTheSameWhereverOnTheSphere) {
  // The same motion and error, seen from frames turned so that the target passes the zenith and the wrap.
  AngularState estimate = state(0.3, 0.2, 0.5, -0.4), truth = state(0.301, 0.1985, 0.52, -0.37);
  const Eigen::Matrix4d root = Eigen::Matrix4d::Random();
  estimate.covariance = 1e-6 * (root * root.transpose() + Eigen::Matrix4d::Identity());
  const DirectionError here = errorOf(estimate, truth);
  for (const double elevation : {0.0, 1.0, 1.3, kPi / 2 - 1e-3, -1.5}) {
    const Eigen::Matrix3d R = Chart::around(directionOf({3.1, elevation})).R_chart_tracking().transpose() *
                              Chart::around(directionOf(truth.angles())).R_chart_tracking();
    const DirectionError there = errorOf(rotateState(estimate, R), rotateState(truth, R));
    EXPECT_NEAR(*there.position_nees, *here.position_nees, 0.01 * *here.position_nees) << elevation;
    EXPECT_NEAR(*there.state_nees, *here.state_nees, 0.02 * *here.state_nees) << elevation;
  }
}

TEST(ErrorOf, ACovarianceThatIsNotPositiveDefiniteHasNoNormalisedSquare) {
  AngularState estimate = state(0.1, 0.0);
  EXPECT_FALSE(errorOf(estimate, state(0.0, 0.0)).position_nees);
  EXPECT_FALSE(errorOf(estimate, state(0.0, 0.0)).state_nees);
  estimate.covariance.setConstant(std::nan(""));
  EXPECT_FALSE(errorOf(estimate, state(0.0, 0.0)).position_nees);
  EXPECT_NEAR(errorOf(estimate, state(0.0, 0.0)).position.x(), 0.1, 1e-12);
}

TEST(ErrorOf, ASightingIsScoredLikeAnEstimate) {
  Eigen::Matrix2d covariance;
  covariance << 4e-6, 1e-6, 1e-6, 3e-6;
  AngularState estimate = state(3.14, 1.2);
  estimate.covariance.setIdentity();
  estimate.covariance.topLeftCorner<2, 2>() = covariance;
  const AngularState truth = state(-3.14, 1.201);
  const DirectionError a = errorOf(estimate, truth);
  const DirectionError b = errorOf(sightingOf(estimate.angles(), covariance), truth);
  EXPECT_LT((a.position - b.position).norm(), 1e-12);
  EXPECT_NEAR(*a.position_nees, *b.position_nees, 1e-6 * *a.position_nees);
  EXPECT_FALSE(b.rate);
  EXPECT_FALSE(b.state_nees);
}

TEST(ErrorOf, WithAzimuthAloneTheElevationDoesNotMatter) {
  AngularState estimate = state(0.2, 0.7, 1.0, 5.0);
  estimate.covariance.diagonal() << 0.01, 1.0, 4.0, 1.0;
  const DirectionError error = errorOf(estimate, state(0.1, 0.0, 3.0, 0.0), Channels::azimuth_only);
  EXPECT_NEAR(error.position.x(), 0.1, 1e-12);
  EXPECT_EQ(error.position.y(), 0.0);
  EXPECT_NEAR(*error.position_nees, 1.0, 1e-9);
  EXPECT_NEAR(*error.state_nees, 1.0, 1e-9);  // (1 + 1) / 2
}

TEST(ErrorStatistics, PoolsBothChannels) {
  ErrorStatistics statistics;
  DirectionError error;
  error.position = {0.3, 0.4};
  error.rate = Eigen::Vector2d(1.0, 1.0);
  error.position_nees = 2.0;
  statistics.add(error);
  error.position = {0.0, 0.0};
  error.rate = Eigen::Vector2d(0.0, 0.0);
  error.position_nees = std::nullopt;
  statistics.add(error);
  EXPECT_EQ(statistics.samples(), 2u);
  EXPECT_NEAR(statistics.rmse(), std::sqrt(0.25 / 4.0), 1e-12);
  EXPECT_NEAR(statistics.rateRmse(), std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(statistics.aneesPosition(), 2.0, 1e-12);
  EXPECT_TRUE(std::isnan(statistics.aneesState()));
}

TEST(ErrorStatistics, WithoutSamplesNothingIsKnown) {
  const ErrorStatistics statistics;
  EXPECT_TRUE(std::isnan(statistics.rmse()));
  EXPECT_TRUE(std::isnan(statistics.rateRmse()));
  EXPECT_TRUE(std::isnan(statistics.aneesPosition()));
}

TEST(AneesBand, IsThatOfTheSpecification) {
  const Band band = aneesBand(200.0);  // estimators.md, section 7
  EXPECT_NEAR(band.low, 0.813, 1e-3);
  EXPECT_NEAR(band.high, 1.205, 1e-3);
}

TEST(AneesBand, HoldsAnHonestCovarianceNineteenTimesInTwenty) {
  std::mt19937 random(20240607);
  std::normal_distribution<double> normal;
  const int trials = 2000, samples = 50;
  int inside = 0;
  for (int trial = 0; trial < trials; ++trial) {
    ErrorStatistics statistics;
    for (int i = 0; i < samples; ++i) {
      AngularState estimate = state(0.01 * normal(random), 0.02 * normal(random));
      estimate.covariance.diagonal() << 1e-4, 4e-4, 1.0, 1.0;
      statistics.add(errorOf(estimate, state(0.0, 0.0)));
    }
    const Band band = aneesBand(2.0 * samples);
    inside += statistics.aneesPosition() >= band.low && statistics.aneesPosition() <= band.high;
  }
  // binomial(2000, 0.95): sigma 0.0049; four of them, and the approximation's own 0.002
  EXPECT_NEAR(inside / double(trials), 0.95, 0.0215);
}

TEST(BeatsTheory, EqualsTheGoldenValues) {
  SIGHTLINE_REQUIRE_SHARED();
  const YAML::Node values = sightline::test::golden("beats_theory");
  ASSERT_GT(values.size(), 0u);
  for (const YAML::Node& entry : values) {
    EXPECT_NEAR(*beatsTheory(entry["s"].as<double>()), entry["p"].as<double>(), 1e-9);
  }
}

TEST(BeatsTheory, HasItsLimits) {
  EXPECT_NEAR(*beatsTheory(1.0), 0.5, 1e-12);
  EXPECT_NEAR(*beatsTheory(0.0), 1.0, 1e-12);
  EXPECT_NEAR(*beatsTheory(0.5), 0.6475836176504333, 1e-9);  // two equal sensors
  EXPECT_FALSE(beatsTheory(-0.1));
  EXPECT_FALSE(beatsTheory(1.1));
  EXPECT_FALSE(beatsTheory(std::nan("")));
}

TEST(BeatsTheory, IsWhatAnOptimalFuserDoes) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  const int trials = 200000;
  int beats = 0;
  for (int i = 0; i < trials; ++i) {
    const double first = normal(random), second = 2.0 * normal(random);
    beats += std::abs(0.8 * first + 0.2 * second) < std::abs(first);  // variance 0.8
  }
  EXPECT_NEAR(beats / double(trials), *beatsTheory(0.8), 4.0 * 0.5 / std::sqrt(double(trials)));
}

}  // namespace
