#include "sightline/core/estimators/kalman.h"

#include <stdexcept>

#include <gtest/gtest.h>

#include "support/golden.h"
#include "support/simulated.h"

namespace sightline::core {
namespace {

KalmanParams absolute(double process_noise, double initial_rate_sigma = KalmanParams{}.initial_rate_sigma) {
  KalmanParams params;
  params.process_noise = process_noise;
  params.initial_rate_sigma = initial_rate_sigma;
  return params;
}

TEST(Kalman, MatchesTheReferenceVectorsInBothChannels) {
  SIGHTLINE_REQUIRE_SHARED();
  const YAML::Node sightings = test::golden("noga_c"), expected = test::golden("kf_cv");
  const Eigen::ArrayXd z = test::matrix(sightings["z"]).row(0), sigma = test::array(sightings["sigma"]);
  KalmanEstimator estimator(
      absolute(expected["q"].as<double>(), 2.0));  // the reference starts with rate variance 4
  Eigen::MatrixXd values(z.size(), 6);
  for (Eigen::Index i = 0; i < z.size(); ++i) {
    Measurement measurement;
    measurement.time = Time(durationOf(sightings["t"][i].as<double>()));
    measurement.position.setConstant(z(i));
    measurement.covariance = sigma(i) * sigma(i) * Eigen::Matrix2d::Identity();
    estimator.update(measurement);
    const AngularState state = *estimator.stateAt(measurement.time);
    values.row(i) << state.mean(0), state.covariance(0, 0), state.mean(2), state.mean(1),
        state.covariance(1, 1), state.mean(3);
  }
  for (const int channel : {0, 3}) {
    test::expectGolden(values.col(channel), test::array(expected["est"]));
    test::expectGolden(values.col(channel + 1), test::array(expected["pv"]));
    test::expectGolden(values.col(channel + 2), test::array(expected["vel"]));
  }
}

TEST(Kalman, ProcessNoiseInProportionToEqualSightingsIsTheSameAsAbsolute) {
  constexpr double kSigma = 0.08;
  KalmanParams proportional;
  proportional.process_noise_ratio = 50.0;
  KalmanEstimator by_ratio(proportional), by_density(absolute(50.0 * kSigma * kSigma));
  for (const Measurement& sighting : test::sightingsOf(test::sinusoid, kSigma, 1, 2.0)) {
    by_ratio.update(sighting);
    by_density.update(sighting);
    EXPECT_TRUE(
        by_ratio.stateAt(sighting.time)->mean.isApprox(by_density.stateAt(sighting.time)->mean, 1e-9));
  }
}

TEST(Kalman, IsAsAccurateAsTheReferenceOnTheBenchmark) {
  // Reference 0.476 (8 %) and 0.424 (15 %) from 100 runs; 40 runs have a standard error of 0.005.
  const auto make = [] { return std::make_unique<KalmanEstimator>(absolute(0.3, 2.0)); };
  const auto fine = test::benchmark(test::sinusoid, 0.08, 40, make);
  EXPECT_NEAR(fine.estimate, 0.476, 0.02);
  EXPECT_NEAR(fine.prediction, 0.542, 0.02);
  EXPECT_NEAR(fine.anees, 0.97, 0.1);
  EXPECT_NEAR(test::benchmark(test::sinusoid, 0.15, 40, make).estimate, 0.424, 0.02);
}

TEST(Kalman, CouplesTheChannelsAsTheSightingsDo) {
  Eigen::Matrix2d R;
  R << 1e-4, 0.9e-4, 0.9e-4, 1e-4;
  KalmanEstimator estimator(KalmanParams{});
  for (const Measurement& sighting : test::sightingsOf(test::straight, R, 2, 2.0)) estimator.update(sighting);
  const Eigen::Matrix4d P = estimator.stateAt(Time(durationOf(2.0)))->covariance;
  EXPECT_NEAR(P(0, 1) / P(0, 0), 0.9, 1e-3);
}

TEST(Kalman, RefusesParametersOutOfRange) {
  KalmanParams bad;
  bad.process_noise = -1.0;
  EXPECT_THROW(KalmanEstimator{bad}, std::invalid_argument);
  bad = {};
  bad.process_noise_ratio = 0.0;
  EXPECT_THROW(KalmanEstimator{bad}, std::invalid_argument);
  bad = {};
  bad.initial_rate_sigma = -0.1;
  EXPECT_THROW(KalmanEstimator{bad}, std::invalid_argument);
}

}  // namespace
}  // namespace sightline::core
