#include "sightline/core/estimators/noga_consistent.h"

#include <cmath>
#include <random>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "sightline/core/estimators/uncertainty_reduction.h"

#include "support/golden.h"

namespace sightline::core {
namespace {

class GoldenBank : public testing::TestWithParam<const char*> {};

TEST_P(GoldenBank, MatchesTheReferenceVectors) {
  SIGHTLINE_REQUIRE_SHARED();
  const YAML::Node expected = test::golden(GetParam());
  NogaConsistentParams params = bankOfSection43();
  params.outlier_share = expected["eps"].as<double>();
  params.outlier_width = expected["Vout"].as<double>();
  params.dwell = expected["tau"].as<double>();
  NogaConsistentEstimator estimator(params);
  const Eigen::ArrayXd t = test::array(expected["t"]), sigma = test::array(expected["sigma"]);
  for (Eigen::Index k = 0; k < t.size(); ++k) {
    Measurement sighting;
    sighting.time = Time(durationOf(t(k)));
    for (int channel = 0; channel < 2; ++channel)
      sighting.position(channel) = expected["z"][channel][k].as<double>();
    sighting.covariance = Eigen::Matrix2d::Identity() * sigma(k) * sigma(k);
    const auto prediction = estimator.stateAt(sighting.time);
    estimator.update(sighting);
    const AngularState state = *estimator.stateAt(sighting.time);
    for (int channel = 0; channel < 2; ++channel) {
      const auto value = [&](const char* name) { return expected[name][channel][k].as<double>(); };
      EXPECT_NEAR(state.mean(channel), value("est"), 1e-9) << k;
      EXPECT_NEAR(state.covariance(channel, channel), value("pv"), 1e-9) << k;
      EXPECT_NEAR(state.mean(channel + 2), value("vel"), 1e-9) << k;
      if (k == 0) continue;
      EXPECT_NEAR(prediction->mean(channel), value("pred"), 1e-9) << k;
      EXPECT_NEAR(prediction->covariance(channel, channel), value("ppv"), 1e-9) << k;
    }
    const Eigen::ArrayXd probabilities = estimator.probabilities();
    EXPECT_LT((probabilities - test::array(expected["mu"][0][k])).abs().maxCoeff(), 1e-9) << k;
  }
}

INSTANTIATE_TEST_SUITE_P(NogaConsistent, GoldenBank, testing::Values("noga_c", "noga_c_gate"));

Measurement sighting(double time_s, const Eigen::Vector2d& position, const Eigen::Matrix2d& covariance) {
  Measurement measurement;
  measurement.time = Time(durationOf(time_s));
  measurement.position = position;
  measurement.covariance = covariance;
  return measurement;
}

TEST(NogaConsistent, OneStepIsTheUncertaintyReductionWithTheProcessNoiseAmongTheInputs) {
  // One straight model, no soft gate: (20)-(23) on a = (x, v, w_x, w_v) from the state that the estimator
  // starts with.
  NogaConsistentParams params = bankOfSection43();
  params.models = {{ResponseModel::Kind::straight, 0.3}};
  params.outlier_share = 0.0;
  NogaConsistentEstimator estimator(params);
  const Eigen::Matrix2d R = Eigen::Matrix2d::Identity() * 0.01;
  estimator.update(sighting(0.0, {0.2, 0.0}, R));
  estimator.update(sighting(0.1, {0.5, 0.0}, R));

  const double h = 0.1, q = 0.3;
  LinearModel<double, 4, 1> model;
  model.a << 0.2, 0.0, 0.0, 0.0;
  model.S << 1.0, h, 1.0, 0.0;  // H [F, I]
  model.q = model.S * model.a;
  Eigen::Matrix4d C_a = Eigen::Matrix4d::Zero();
  C_a.topLeftCorner<2, 2>() << 0.01, 0.0, 0.0, 4.0;
  C_a.bottomRightCorner<2, 2>() << q * h * h * h / 3.0, q * h * h / 2.0, q * h * h / 2.0, q * h;
  Eigen::Matrix<double, 1, 1> r(0.5), C_r(0.01);
  const auto reduced = reduceUncertainty(model, C_a, r, C_r, Eigen::Matrix<double, 1, 4>::Zero());
  Eigen::Matrix<double, 2, 4> propagation;
  propagation << 1.0, h, 1.0, 0.0, 0.0, 1.0, 0.0, 1.0;
  const Eigen::Vector2d x = propagation * reduced.a;
  const Eigen::Matrix2d P = propagation * reduced.C_a * propagation.transpose();

  const AngularState state = *estimator.stateAt(Time(durationOf(0.1)));
  EXPECT_NEAR(state.mean(0), x(0), 1e-12);
  EXPECT_NEAR(state.mean(2), x(1), 1e-12);
  EXPECT_NEAR(state.covariance(0, 0), P(0, 0), 1e-12);
  EXPECT_NEAR(state.covariance(0, 2), P(0, 1), 1e-12);
  EXPECT_NEAR(state.covariance(2, 2), P(1, 1), 1e-12);
}

TEST(NogaConsistent, WithoutAGivenAmplitudeItIsFreeOfScale) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  std::vector<Eigen::Vector2d> positions;
  for (int k = 0; k < 150; ++k) {
    positions.emplace_back(std::sin(0.03 * k) + 0.1 * normal(random),
                           std::cos(0.03 * k) + 0.1 * normal(random));
  }
  AngularState reference;
  for (const double scale : {1.0, 1e-2, 1e-4}) {
    NogaConsistentParams params;
    params.initial_rate_sigma = 2.0 * scale;
    NogaConsistentEstimator estimator(params);
    for (int k = 0; k < 150; ++k) {
      estimator.update(sighting(0.03 * k, scale * positions[static_cast<std::size_t>(k)],
                                Eigen::Matrix2d::Identity() * 0.01 * scale * scale));
    }
    const AngularState state = *estimator.stateAt(Time(durationOf(4.5)));
    if (scale == 1.0) reference = state;
    EXPECT_LT((state.mean / scale - reference.mean).norm(), 1e-6);
    EXPECT_TRUE((state.covariance / (scale * scale)).isApprox(reference.covariance, 1e-6));
  }
}

TEST(NogaConsistent, CoupledSightingsOfVanishingCorrelationGiveTheUncoupledResultOfOneModel) {
  NogaConsistentParams params = bankOfSection43();
  params.models = {{ResponseModel::Kind::harmonic, 0.3, 1.0}};
  NogaConsistentEstimator apart(params), together(params);
  params.outlier_share = 0.0;
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal(0.0, 0.05);
  for (int k = 0; k < 60; ++k) {
    const Eigen::Vector2d position(std::sin(0.05 * k) + normal(random), 0.3 * k * 0.05 + normal(random));
    Eigen::Matrix2d R = Eigen::Matrix2d::Identity() * 0.0025;
    apart.update(sighting(0.05 * k, position, R));
    R(0, 1) = R(1, 0) = 0.0025 * 2e-6;  // just enough to take the coupled way
    together.update(sighting(0.05 * k, position, R));
  }
  const AngularState a = *apart.stateAt(Time(durationOf(2.95))),
                     b = *together.stateAt(Time(durationOf(2.95)));
  // The soft gate judges channels together on the coupled way: equal but for its outlier share of 1 %.
  EXPECT_LT((a.mean - b.mean).norm(), 0.05);
  EXPECT_TRUE(b.covariance.isApprox(a.covariance, 0.1));
}

TEST(NogaConsistent, CoupledNoiseIsUsed) {
  // Strongly correlated noise: the difference of the channels is nearly free of noise, and the estimate must
  // know it.
  NogaConsistentEstimator estimator{NogaConsistentParams{}};
  std::mt19937_64 random(6);
  std::normal_distribution<double> normal(0.0, 0.05);
  Eigen::Matrix2d R;
  R << 1.0, 0.99, 0.99, 1.0;
  R *= 0.0025;
  double squared = 0.0;
  for (int k = 0; k < 200; ++k) {
    const double common = normal(random), own = 0.1 * normal(random);
    estimator.update(sighting(0.03 * k, {common + 0.7 * own, common - 0.7 * own}, R));
    const AngularState state = *estimator.stateAt(Time(durationOf(0.03 * k)));
    if (k > 50) squared += std::pow(state.mean(0) - state.mean(1), 2) / 150.0;
    if (k > 50) {
      const double difference_variance =
          state.covariance(0, 0) + state.covariance(1, 1) - 2.0 * state.covariance(0, 1);
      EXPECT_LT(difference_variance, 0.2 * state.covariance(0, 0));
    }
  }
  EXPECT_LT(std::sqrt(squared), 0.0071);  // the noise of the difference itself is 0.1 sqrt(2) 0.05 = 0.0071
}

TEST(NogaConsistent, OutliersAreTakenWithCare) {
  NogaConsistentEstimator estimator{NogaConsistentParams{}};
  const Eigen::Matrix2d R = Eigen::Matrix2d::Identity() * 1e-4;
  for (int k = 0; k < 100; ++k) estimator.update(sighting(0.03 * k, {0.0, 0.0}, R));
  estimator.update(sighting(3.0, {0.3, 0.0}, R));  // thirty sigmas off
  EXPECT_LT(std::abs(estimator.stateAt(Time(durationOf(3.0)))->mean(0)), 0.002);
}

TEST(NogaConsistent, CovarianceIsPositiveDefiniteBeforeAndLongAfterTheLastSighting) {
  NogaConsistentEstimator estimator{NogaConsistentParams{}};
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal(0.0, 0.01);
  for (int k = 0; k < 100; ++k) {
    estimator.update(sighting(0.03 * k, {std::sin(0.09 * k) + normal(random), 0.1 * k + normal(random)},
                              Eigen::Matrix2d::Identity() * 1e-4));
  }
  double last = 0.0;
  for (const double h : {-1.0, -0.1, 0.0, 0.1, 1.0, 10.0, 1e4}) {
    const AngularState state = *estimator.stateAt(Time(durationOf(2.97 + h)));
    ASSERT_TRUE(state.mean.allFinite() && state.covariance.allFinite()) << h;
    EXPECT_GT(state.covariance.diagonal().minCoeff(), 0.0) << h;
    if (h >= 0.0) {
      EXPECT_GE(state.covariance(0, 0), last) << h;
      last = state.covariance(0, 0);
    }
  }
}

TEST(NogaConsistent, AnotherChartChangesNothingForTheMotionItDescribes) {
  const Eigen::Matrix3d R =
      Eigen::AngleAxisd(0.3, Eigen::Vector3d(0.2, 1.0, 0.5).normalized()).toRotationMatrix();
  NogaConsistentEstimator stays{NogaConsistentParams{}};
  std::mt19937_64 random(8);
  std::normal_distribution<double> normal(0.0, 0.002);
  for (int k = 0; k < 100; ++k) {
    stays.update(sighting(
        0.03 * k, {0.05 * std::sin(0.03 * k) + normal(random), 0.02 * std::cos(0.03 * k) + normal(random)},
        Eigen::Matrix2d::Identity() * 4e-6));
  }
  const auto moves = stays.clone();
  moves->rotate(R);
  const AngularState a = rotateState(*stays.stateAt(Time(durationOf(2.97))), R);
  const AngularState b = *moves->stateAt(Time(durationOf(2.97)));
  EXPECT_LT((a.mean - b.mean).norm(), 1e-5);
  EXPECT_TRUE(b.covariance.isApprox(a.covariance, 0.01));
}

/// Mean normalised squared error of the position, and its root mean square in sigmas, of targets whose white
/// acceleration has the density `q` sigma^2 [1/s^3], in 40 s.
struct Straightness {
  double anees = 0.0, error = 0.0;
};

Straightness follow(double q, unsigned runs) {
  constexpr double kSigma = 1e-3, kStep = 1.0 / 30.0;
  Straightness sums;
  double count = 0.0;
  for (unsigned run = 1; run <= runs; ++run) {
    std::mt19937_64 random(run);
    std::normal_distribution<double> normal;
    NogaConsistentEstimator estimator{NogaConsistentParams{}};
    Eigen::Vector4d truth(0.01, 0.02, 0.01 * normal(random), 0.01 * normal(random));
    for (int k = 0; k < 1200; ++k) {
      for (int channel = 0; channel < 2; ++channel) {
        const double gain = kSigma * std::sqrt(q * kStep) * normal(random);
        truth(channel) += kStep * (truth(channel + 2) + 0.5 * gain);
        truth(channel + 2) += gain;
      }
      const Eigen::Vector2d noise(normal(random), normal(random));
      const Measurement seen = sighting(kStep * k, truth.head<2>() + kSigma * noise,
                                        kSigma * kSigma * Eigen::Matrix2d::Identity());
      estimator.update(seen);
      if (k < 60) continue;
      const AngularState state = *estimator.stateAt(seen.time);
      const Eigen::Vector2d error = (state.mean - truth).head<2>();
      sums.anees += error.dot(state.anglesCovariance().llt().solve(error)) / 2.0;
      sums.error += error.squaredNorm() / 2.0 / (kSigma * kSigma);
      ++count;
    }
  }
  return {sums.anees / count, std::sqrt(sums.error / count)};
}

TEST(NogaConsistent, StraightTargetsAndNearlyStraightOnesHaveHonestCovariances) {
  const Straightness straight = follow(0.0, 60);
  EXPECT_GT(straight.anees, 0.8);  // with a calmest density of 0.01 sigma^2: 0.73
  EXPECT_LT(straight.anees, 1.2);
  EXPECT_LT(straight.error, 0.12);  // and 0.166
  for (const double q : {1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1.0}) {
    const Straightness found = follow(q, 10);
    EXPECT_GT(found.anees, 0.7) << q;
    EXPECT_LT(found.anees, 1.45) << q;  // without steps between 1e-6 and 1: up to 3.1
  }
}

}  // namespace
}  // namespace sightline::core
