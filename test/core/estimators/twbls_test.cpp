#include "sightline/core/estimators/twbls.h"

#include <cmath>
#include <random>
#include <stdexcept>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "support/golden.h"

namespace sightline::core {
namespace {

Measurement sighting(double time_s, double azimuth, double elevation, double sigma = 0.01) {
  Measurement measurement;
  measurement.time = Time(durationOf(time_s));
  measurement.position << azimuth, elevation;
  measurement.covariance = Eigen::Matrix2d::Identity() * sigma * sigma;
  return measurement;
}

class GoldenLine : public testing::TestWithParam<const char*> {};

TEST_P(GoldenLine, MatchesTheReferenceVectors) {
  SIGHTLINE_REQUIRE_SHARED();
  const YAML::Node expected = test::golden(GetParam());
  const Eigen::ArrayXd sigma = test::array(expected["sigma"]);
  const auto fit = fitLine(test::array(expected["age"]), test::array(expected["y"]), sigma.square(),
                           test::array(expected["w"]));
  ASSERT_TRUE(fit);
  test::expectGolden(fit->C, Eigen::Vector2d(expected["C1"].as<double>(), expected["C2"].as<double>()));
  test::expectGolden(fit->P, test::matrix(expected["P"]));
  test::expectGolden(fit->covariance, test::matrix(expected["P_sandwich"]));
  test::expectGolden(fit->E, Eigen::Vector2d(expected["E1"].as<double>(), expected["E2"].as<double>()));
  EXPECT_NEAR(fit->rms, expected["rms"].as<double>(), 1e-9 * fit->rms);
  EXPECT_NEAR(fit->efit, expected["efit"].as<double>(), 1e-9 * fit->efit);
  EXPECT_NEAR(-fit->C(0), expected["V"].as<double>(), 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Twbls, GoldenLine, testing::Values("wls_none", "wls_lin", "wls_exp"));

TEST(FitLine, RecoversALineWithoutNoiseExactlyWhateverTheWeights) {
  const Eigen::ArrayXd age = Eigen::ArrayXd::LinSpaced(20, 0.57, 0.0);
  const Eigen::ArrayXd value = 0.5 + 1.0 * (0.57 - age);
  for (const double decay : {0.05, 1.0, 1e9}) {
    const auto fit = fitLine(age, value, Eigen::ArrayXd::Constant(20, 1.0), (-age / decay).exp());
    ASSERT_TRUE(fit);
    EXPECT_NEAR(-fit->C(0), 1.0, 1e-12);
    EXPECT_NEAR(fit->C(1), 1.07, 1e-12);
    EXPECT_NEAR(fit->rms, 0.0, 1e-12);
  }
}

TEST(FitLine, DoesNotDependOnTheUnitOfTheWeightsOrTheAngularOrigin) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  Eigen::ArrayXd age(12), value(12), variance(12);
  for (int i = 0; i < 12; ++i) {
    age(i) = 0.04 * (11 - i) + 0.001 * i * i;
    value(i) = normal(random);
    variance(i) = 0.5 + 0.1 * i;
  }
  const auto fit = fitLine(age, value, variance, 1.0 / variance);
  const auto scaled = fitLine(age, value + 2.5, variance, 1e8 / variance);
  ASSERT_TRUE(fit && scaled);
  EXPECT_NEAR(scaled->C(0), fit->C(0), 1e-9);
  EXPECT_NEAR(scaled->C(1), fit->C(1) + 2.5, 1e-9);
  EXPECT_NEAR(scaled->E(0), fit->E(0), 1e-9);
  EXPECT_TRUE(scaled->covariance.isApprox(fit->covariance, 1e-9));
}

TEST(FitLine, SandwichEqualsPWhenTheWeightsAreTheInverseVariances) {
  const Eigen::ArrayXd age = Eigen::ArrayXd::LinSpaced(9, 0.4, 0.0);
  const Eigen::ArrayXd variance = Eigen::ArrayXd::LinSpaced(9, 0.01, 0.05);
  const auto fit = fitLine(age, age.sin(), variance, 1.0 / variance);
  ASSERT_TRUE(fit);
  EXPECT_TRUE(fit->covariance.isApprox(fit->P, 1e-12));
}

TEST(FitLine, MisfitIsOneOnAverageWhenTheSigmasAreRight) {
  std::mt19937_64 random(11);
  std::normal_distribution<double> normal;
  const int runs = 4000, n = 20;
  const Eigen::ArrayXd age = Eigen::ArrayXd::LinSpaced(n, 0.57, 0.0);
  const Eigen::ArrayXd variance = Eigen::ArrayXd::LinSpaced(n, 0.01, 0.04);
  double sum = 0.0;
  for (int run = 0; run < runs; ++run) {
    Eigen::ArrayXd value = 0.3 * age - 1.0;
    for (int i = 0; i < n; ++i) value(i) += std::sqrt(variance(i)) * normal(random);
    sum += fitLine(age, value, variance, (-age).exp() / variance)->misfit;
  }
  // Its spread is about sqrt(2 / 18) = 0.33; five standard errors of the mean.
  EXPECT_NEAR(sum / runs, 1.0, 5.0 * 0.33 / std::sqrt(runs));
}

TEST(FitLine, TwoSightingsUseTheStatedSigmas) {
  const Eigen::Array2d age(0.1, 0.0), value(1.0, 1.2), variance(0.01, 0.01);
  const auto fit = fitLine(age, value, variance, 1.0 / variance);
  ASSERT_TRUE(fit);
  EXPECT_TRUE(std::isnan(fit->efit));
  EXPECT_NEAR(fit->E(0), std::sqrt(0.02) / 0.1, 1e-12);
  EXPECT_NEAR(fit->E(1), 0.1, 1e-12);
}

TEST(FitLine, IsNotDeterminedByOneInstant) {
  const Eigen::Array3d age(0.2, 0.2, 0.2), ones(1.0, 1.0, 1.0);
  EXPECT_FALSE(fitLine(age, ones, ones, ones));
  EXPECT_FALSE(fitLine(age.head(1), ones.head(1), ones.head(1), ones.head(1)));
}

TEST(Twbls, PredictionVarianceFollowsEquation5C) {
  TwblsEstimator estimator{TwblsParams{}};
  for (int i = 0; i < 20; ++i) estimator.update(sighting(0.03 * i, 0.1 * i, 0.0));
  const AngularState now = *estimator.stateAt(Time(durationOf(0.57)));
  const AngularState later = *estimator.stateAt(Time(durationOf(0.87)));
  const double h = 0.3;
  const Eigen::Matrix4d P = now.covariance;
  EXPECT_NEAR(later.covariance(0, 0), P(0, 0) + 2.0 * h * P(0, 2) + h * h * P(2, 2), 1e-12);
  EXPECT_NEAR(later.mean(0), now.mean(0) + h * now.mean(2), 1e-12);
}

TEST(Twbls, WindowIsBoundedByAgeAndByCount) {
  TwblsParams params;
  params.max_sightings = 20;
  params.min_sightings = 2;
  TwblsEstimator estimator(params);
  for (int i = 0; i < 100; ++i) estimator.update(sighting(0.01 * i, 0.0, 0.0));
  EXPECT_EQ(estimator.windowSize(), 20u);
  for (int i = 0; i < 100; ++i) estimator.update(sighting(2.0 + 0.1 * i, 0.0, 0.0));
  EXPECT_EQ(estimator.windowSize(), 6u);  // ages 0, 0.1 ... 0.5: the window of 0.6 s is open at its end
}

TEST(Twbls, ASlowSensorKeepsItsLastSightings) {
  TwblsEstimator estimator{TwblsParams{}};
  for (int i = 0; i < 10; ++i) estimator.update(sighting(2.0 * i, 0.01 * i, 0.0, 1e-4));
  EXPECT_EQ(estimator.windowSize(), 5u);
  EXPECT_NEAR(estimator.stateAt(Time(durationOf(18.0)))->mean(2), 0.005, 1e-12);
}

TEST(Twbls, RatesBeforeTheyAreKnownComeFromThePrior) {
  TwblsParams params;
  params.initial_rate_sigma = 0.3;
  TwblsEstimator estimator{params};
  EXPECT_FALSE(estimator.stateAt(Time{}));
  estimator.update(sighting(0.0, 0.2, 0.1));
  const AngularState once = *estimator.stateAt(Time{});
  EXPECT_EQ(once.mean, Eigen::Vector4d(0.2, 0.1, 0.0, 0.0));
  EXPECT_DOUBLE_EQ(once.covariance(2, 2), 0.09);
  estimator.update(sighting(0.001, 0.21, 0.1));  // would be 10 rad/s with a sigma of 14 rad/s
  const AngularState twice = *estimator.stateAt(Time(durationOf(0.001)));
  EXPECT_LT(twice.covariance(2, 2), 0.09);
  EXPECT_LT(std::abs(twice.mean(2)), 0.1);
}

TEST(Twbls, CoupledSightingsGiveTheCoupledCovariance) {
  TwblsEstimator estimator{TwblsParams{}};
  for (int i = 0; i < 20; ++i) {
    Measurement measurement = sighting(0.03 * i, 0.0, 0.0);
    measurement.covariance << 4e-4, 1e-4, 1e-4, 1e-4;
    estimator.update(measurement);
  }
  const Eigen::Matrix4d P = estimator.stateAt(Time(durationOf(0.57)))->covariance;
  EXPECT_NEAR(P(0, 1) / P(1, 1), 1.0, 1e-9);  // all blocks are alike: R times one and the same 2x2
  EXPECT_NEAR(P(0, 1) / P(0, 0), 0.25, 1e-9);
}

TEST(Twbls, FinerSensorWeighsMoreInTheMergedWindow) {
  TwblsParams params;
  params.time_weight = TimeWeight::none;
  for (const SensorWeight weighting : {SensorWeight::variance, SensorWeight::ifov}) {
    params.sensor_weight = weighting;
    TwblsEstimator estimator(params);
    for (int i = 0; i < 20; ++i) {
      Measurement coarse = sighting(0.03 * i, 0.3, 0.0, 0.02);
      Measurement fine = sighting(0.03 * i, 0.0, 0.0, 0.01);
      coarse.ifov = 0.02;
      fine.ifov = 0.01;
      estimator.update(coarse);
      estimator.update(fine);
    }
    EXPECT_NEAR(estimator.stateAt(Time(durationOf(0.57)))->mean(0), 0.3 * 0.2, 1e-9);  // weights 1 : 4
  }
}

TEST(Twbls, IfovWeightWithoutIfovIsRefused) {
  TwblsParams params;
  params.sensor_weight = SensorWeight::ifov;
  TwblsEstimator estimator(params);
  EXPECT_THROW(estimator.update(sighting(0.0, 0.0, 0.0)), std::invalid_argument);
}

TEST(Twbls, FitErrorCovarianceIsThePapers) {
  TwblsParams params;
  params.covariance = TwblsCovariance::fit_error;
  TwblsEstimator estimator(params);
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal(0.0, 0.01);
  for (int i = 0; i < 20; ++i) estimator.update(sighting(0.03 * i, normal(random), normal(random)));
  const Eigen::Matrix4d P = estimator.stateAt(Time(durationOf(0.57)))->covariance;
  EXPECT_DOUBLE_EQ(P(0, 0), std::pow(estimator.fit(0)->E(1), 2));
  EXPECT_DOUBLE_EQ(P(2, 2), std::pow(estimator.fit(0)->E(0), 2));
  EXPECT_EQ(P(0, 2), 0.0);
}

TEST(Twbls, RawAnchorKeepsTheNoiseOfTheLastSighting) {
  TwblsParams params;
  params.anchor = TwblsAnchor::raw;
  params.covariance = TwblsCovariance::sandwich;
  TwblsEstimator estimator(params);
  for (int i = 0; i < 20; ++i) estimator.update(sighting(0.03 * i, i == 19 ? 0.05 : 0.0, 0.0));
  const AngularState state = *estimator.stateAt(Time(durationOf(0.57)));
  EXPECT_EQ(state.mean(0), 0.05);
  EXPECT_NEAR(state.covariance(0, 0), 1e-4, 1e-15);
  EXPECT_GT(state.covariance(0, 2), 0.0);  // its noise is in the rate as well
}

TEST(Twbls, PaperGateHasItsMinimum) {
  LineFit fit;
  fit.E << 0.1, 0.02;
  EXPECT_DOUBLE_EQ(paperGateHalfWidth(fit, 0.1, 0.01), 3.0 * 0.03);
  EXPECT_DOUBLE_EQ(paperGateHalfWidth(fit, 0.1, 0.08), 3.0 * 0.08);
}

}  // namespace
}  // namespace sightline::core
