#include "sightline/core/estimators/imm.h"

#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

#include "sightline/core/estimators/kalman.h"

#include "support/simulated.h"

namespace sightline::core {
namespace {

ImmParams bank(std::vector<ImmModel> models, double dwell) {
  ImmParams params;
  params.models = std::move(models);
  params.dwell = dwell;
  params.initial_rate_sigma = params.initial_acceleration_sigma = 2.0;
  return params;
}

auto maker(const ImmParams& params) {
  return [params] { return std::make_unique<ImmEstimator>(params); };
}

TEST(Imm, OfOneConstantVelocityModelIsTheKalmanFilter) {
  KalmanParams params;
  params.process_noise = 0.3;
  KalmanEstimator kalman(params);
  ImmParams one = bank({{1, {0.3, 0.0}}}, 1.0);
  one.initial_rate_sigma = params.initial_rate_sigma;
  ImmEstimator imm(one);
  for (const Measurement& sighting : test::sightingsOf(test::sinusoid, 0.08, 3, 3.0)) {
    kalman.update(sighting);
    imm.update(sighting);
    for (const double ahead : {0.0, 0.2}) {
      const AngularState a = *kalman.stateAt(sighting.time + durationOf(ahead));
      const AngularState b = *imm.stateAt(sighting.time + durationOf(ahead));
      EXPECT_TRUE(b.mean.isApprox(a.mean, 1e-10));
      EXPECT_TRUE(b.covariance.isApprox(a.covariance, 1e-10));
    }
  }
}

TEST(Imm, IsAsAccurateAsTheReferenceOnTheBenchmark) {
  // References from 100 runs: E2 for the two sinusoids, E3 for the line; 40 runs have a standard error of
  // 0.005.
  const auto two = maker(bank({{1, {0.01, 0.0}}, {1, {0.8, 0.0}}}, 10.0));
  const auto fine = test::benchmark(test::sinusoid, 0.08, 40, two);
  EXPECT_NEAR(fine.estimate, 0.501, 0.02);
  EXPECT_NEAR(fine.prediction, 0.572, 0.02);
  EXPECT_NEAR(fine.anees, 0.91, 0.1);
  EXPECT_NEAR(test::benchmark(test::sinusoid, 0.15, 40, two).estimate, 0.439, 0.02);
  EXPECT_NEAR(test::benchmark(test::straight, 0.08, 40, two).estimate, 0.298, 0.02);

  const auto curved = maker(bank({{1, {0.01, 0.0}}, {2, {1.0, 0.0}}}, 3.0));
  EXPECT_NEAR(test::benchmark(test::sinusoid, 0.08, 40, curved).estimate, 0.463, 0.02);
  EXPECT_NEAR(test::benchmark(test::straight, 0.08, 40, curved).estimate, 0.312, 0.02);
  const auto both_curved = maker(bank({{2, {0.3, 0.0}}, {2, {1.0, 0.0}}}, 3.0));
  EXPECT_NEAR(test::benchmark(test::sinusoid, 0.08, 40, both_curved).estimate, 0.447, 0.02);
}

TEST(Imm, OfTheDefaultBankIsBetterThanTheKalmanFilterOnCurveAndStraight) {
  const auto kalman = [] { return std::make_unique<KalmanEstimator>(KalmanParams{}); };
  for (const test::Path path : {test::sinusoid, test::straight}) {
    EXPECT_LT(test::benchmark(path, 0.08, 20, maker({})).estimate,
              0.95 * test::benchmark(path, 0.08, 20, kalman).estimate);
  }
}

TEST(Imm, TwoSightingsTellTheRateAndNoAcceleration) {
  for (const double h : {0.02, 0.1, 10.0}) {
    for (const double rate : {0.055, 0.3}) {
      ImmEstimator estimator(ImmParams{});
      for (const double t : {0.0, h}) {
        Measurement sighting;
        sighting.time = Time(durationOf(t));
        sighting.position << rate * t, 0.2;
        sighting.covariance = 1e-10 * Eigen::Matrix2d::Identity();
        estimator.update(sighting);
      }
      const double ahead = h < 1.0 ? 0.5 : 1.5 * h;
      const AngularState state = *estimator.stateAt(Time(durationOf(h + ahead)));
      EXPECT_NEAR(state.mean(0), rate * (h + ahead), 0.1 * rate * ahead) << h << " s, " << rate << " rad/s";
    }
  }
}

/// Straight until 5 s, then hard round the bend.
Eigen::Vector4d swerving(double t) {
  const double s = std::max(0.0, t - 5.0);
  return {0.1 * t + 2.0 * s * s, 0.05 * t, 0.1 + 4.0 * s, 0.05};
}

TEST(Imm, ChangesTheModelWhenTheTargetManoeuvres) {
  ImmEstimator estimator(ImmParams{});
  double quiet_before = 0.0, quiet_after = 1.0;
  for (const Measurement& sighting : test::sightingsOf(swerving, 0.01, 4, 5.6)) {
    estimator.update(sighting);
    const double quiet = estimator.probabilities()(0);
    if (test::timeOf(sighting) < 5.0) quiet_before = quiet;
    quiet_after = quiet;
  }
  EXPECT_GT(quiet_before, 0.5);
  EXPECT_LT(quiet_after, 0.01);
}

TEST(Imm, FollowsAConstantAccelerationWithoutLag) {
  ImmEstimator estimator(bank({{2, {1e-6, 0.0}}}, 1.0));
  constexpr double kSigma = 0.01;
  for (const Measurement& sighting : test::sightingsOf(swerving, kSigma, 5, 8.0)) {
    if (test::timeOf(sighting) < 5.0) continue;
    estimator.update(sighting);
  }
  const AngularState state = *estimator.stateAt(Time(durationOf(9.0)));
  const Eigen::Vector4d error = state.mean - swerving(9.0);
  EXPECT_LT(std::abs(error(0)), 4.0 * std::sqrt(state.covariance(0, 0)));
  EXPECT_LT(std::abs(error(0)), 0.1) << "a constant-velocity model would be 2 rad behind";
  EXPECT_LT(std::abs(error(2)), 4.0 * std::sqrt(state.covariance(2, 2)));
}

TEST(Imm, PredictsTheMixtureOfTheModels) {
  ImmEstimator estimator(ImmParams{});
  for (const Measurement& sighting : test::sightingsOf(test::sinusoid, 0.08, 6, 3.0))
    estimator.update(sighting);
  const AngularState now = *estimator.stateAt(Time(durationOf(3.0)));
  const AngularState soon = *estimator.stateAt(Time(durationOf(3.0) + Duration(1)));
  EXPECT_TRUE(soon.mean.isApprox(now.mean, 1e-6)) << "no jump between estimate and prediction";
  EXPECT_TRUE(soon.covariance.isApprox(now.covariance, 1e-6));
}

TEST(Imm, RefusesParametersOutOfRange) {
  EXPECT_THROW(ImmEstimator(bank({}, 1.0)), std::invalid_argument);
  EXPECT_THROW(ImmEstimator(bank({{1, {0.1, 0.0}}}, 0.0)), std::invalid_argument);
  EXPECT_THROW(ImmEstimator(bank({{3, {0.1, 0.0}}}, 1.0)), std::invalid_argument);
  EXPECT_THROW(ImmEstimator(bank({{1, {0.0, 0.0}}}, 1.0)), std::invalid_argument);
  EXPECT_THROW(ImmEstimator(bank({{1, {-0.1, 1.0}}}, 1.0)), std::invalid_argument);
  ImmParams no_rate;
  no_rate.initial_rate_sigma = -1.0;
  EXPECT_THROW(ImmEstimator{no_rate}, std::invalid_argument);
}

}  // namespace
}  // namespace sightline::core
