#include "sightline/core/estimators/twbls_consistent.h"

#include <cmath>
#include <random>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <gtest/gtest.h>

#include "support/golden.h"

namespace sightline::core {
namespace {

TwblsConsistentParams absolute(const std::vector<double>& densities) {
  TwblsConsistentParams params;
  params.process_noises.clear();
  for (const double density : densities) params.process_noises.push_back({density, 0.0});
  params.initial_rate_sigma = 1e6;  // as the reference: no prior
  params.noise.enabled = false;
  return params;
}

TEST(TwblsConsistent, MatchesTheReferenceVectors) {
  SIGHTLINE_REQUIRE_SHARED();
  const YAML::Node expected = test::golden("twbls_consistent");
  TwblsConsistentParams params = absolute(expected["qs"].as<std::vector<double>>());
  params.sightings = expected["N"].as<int>();
  params.exact_window = true;
  params.memory = expected["tf"].as<double>();
  TwblsConsistentEstimator estimator(params);
  const Eigen::ArrayXd t = test::array(expected["t"]), sigma = test::array(expected["sigma"]);
  for (Eigen::Index k = 0; k < t.size(); ++k) {
    Measurement sighting;
    sighting.time = Time(durationOf(t(k)));
    for (int channel = 0; channel < 2; ++channel)
      sighting.position(channel) = expected["z"][channel][k].as<double>();
    sighting.covariance = Eigen::Matrix2d::Identity() * sigma(k) * sigma(k);
    estimator.update(sighting);
    if (k == 0) continue;  // the reference starts with a rate sigma of its own
    const AngularState state = *estimator.stateAt(sighting.time);
    for (int channel = 0; channel < 2; ++channel) {
      const auto value = [&](const char* name) { return expected[name][channel][k].as<double>(); };
      EXPECT_NEAR(state.mean(channel), value("pos"), 1e-9);
      EXPECT_NEAR(state.mean(channel + 2), value("vel"), 1e-9 * (1.0 + std::abs(value("vel"))));
      EXPECT_NEAR(state.covariance(channel, channel), value("Ppos"), 1e-9);
      EXPECT_NEAR(state.covariance(channel + 2, channel + 2), value("Pvel"), 1e-9 * value("Pvel"));
      EXPECT_NEAR(state.covariance(channel, channel + 2), value("Pcv"), 1e-9);
      if (k + 1 < t.size()) {
        const AngularState next = *estimator.stateAt(Time(durationOf(t(k + 1))));
        EXPECT_NEAR(next.mean(channel), value("pred"), 1e-9);
        EXPECT_NEAR(next.covariance(channel, channel), value("vpred"), 1e-9);
      }
    }
    const Eigen::ArrayXd weights = estimator.weights();
    EXPECT_LT((weights - test::array(expected["w"][0][k])).abs().maxCoeff(), 1e-9);
  }
}

/// (S-4).
Eigen::MatrixXd kernel(const Eigen::ArrayXd& age) {
  Eigen::MatrixXd K(age.size(), age.size());
  for (Eigen::Index i = 0; i < age.size(); ++i) {
    for (Eigen::Index j = 0; j < age.size(); ++j) {
      const double m = std::min(age(i), age(j)), M = std::max(age(i), age(j));
      K(i, j) = m * m * (3.0 * M - m) / 6.0;
    }
  }
  return K;
}

/// (S-5) as written, one channel, by Cholesky factorisation of R + q K.
Eigen::Vector2d byTheKernel(const Eigen::ArrayXd& age, const Eigen::ArrayXd& value,
                            const Eigen::ArrayXd& variance, double q, Eigen::Matrix2d& P) {
  Eigen::MatrixXd covariance = q * kernel(age), F(age.size(), 2);
  covariance.diagonal() += variance.matrix();
  F << age.matrix(), Eigen::VectorXd::Ones(age.size());
  const Eigen::LLT<Eigen::MatrixXd> llt(covariance);
  P = (F.transpose() * llt.solve(F)).inverse();
  return P * F.transpose() * llt.solve(value.matrix());
}

TEST(TwblsConsistent, ItsYardstickMatchesTheReferenceVectors) {
  SIGHTLINE_REQUIRE_SHARED();
  const YAML::Node K = test::golden("wna_kernel"), expected = test::golden("gls"),
                   line = test::golden("wls_none");
  test::expectGolden(kernel(test::array(K["age"])), test::matrix(K["K"]));
  Eigen::Matrix2d P;
  const Eigen::Vector2d C = byTheKernel(test::array(line["age"]), test::array(line["y"]),
                                        test::array(line["sigma"]).square(), expected["q"].as<double>(), P);
  test::expectGolden(C, Eigen::Vector2d(expected["C1"].as<double>(), expected["C2"].as<double>()));
  test::expectGolden(P, test::matrix(expected["P"]));
}

TEST(TwblsConsistent, EqualsGeneralisedLeastSquaresWithTheKernelOnAMovingWindow) {
  std::mt19937_64 random(2);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  const double q = 0.4;
  TwblsConsistentParams params = absolute({q});
  params.sightings = 15;
  params.exact_window = true;
  TwblsConsistentEstimator estimator(params);
  std::vector<Measurement> all;
  double time = 0.0;
  for (int k = 0; k < 40; ++k) {
    Measurement sighting;
    sighting.time = Time(durationOf(time));
    sighting.position << std::sin(time) + 0.05 * normal(random), std::cos(time) + 0.05 * normal(random);
    const double sigma = 0.03 + 0.05 * uniform(random);
    sighting.covariance = Eigen::Matrix2d::Identity() * sigma * sigma;
    estimator.update(sighting);
    all.push_back(sighting);
    time += 0.01 * std::floor(1.0 + 5.0 * uniform(random));
    if (k < 2) continue;
    const auto n = static_cast<Eigen::Index>(std::min<std::size_t>(all.size(), 15));
    Eigen::ArrayXd age(n), value(n), variance(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const Measurement& past = all[all.size() - static_cast<std::size_t>(n - i)];
      age(i) = seconds(sighting.time - past.time);
      value(i) = past.position(0);
      variance(i) = past.covariance(0, 0);
    }
    Eigen::Matrix2d P;
    const Eigen::Vector2d C = byTheKernel(age, value, variance, q, P);
    const AngularState state = *estimator.stateAt(sighting.time);
    EXPECT_NEAR(state.mean(0), C(1), 1e-9);
    EXPECT_NEAR(state.mean(2), -C(0), 1e-8);
    EXPECT_NEAR(state.covariance(0, 0), P(1, 1), 1e-10);
    EXPECT_NEAR(state.covariance(0, 2), -P(0, 1), 1e-9);
    EXPECT_NEAR(state.covariance(2, 2), P(0, 0), 1e-8);
  }
}

TEST(TwblsConsistent, CoupledSightingsGiveTheSameAsSightingsTurnedIntoTheirAxes) {
  // A covariance with correlation is a diagonal one seen in turned axes: estimates must turn along.
  const double turn = 0.6;
  Eigen::Matrix2d T;
  T << std::cos(turn), -std::sin(turn), std::sin(turn), std::cos(turn);
  TwblsConsistentEstimator straight(absolute({0.01, 1.0})), turned(absolute({0.01, 1.0}));
  std::mt19937_64 random(4);
  std::normal_distribution<double> normal;
  Measurement sighting;
  for (int k = 0; k < 80; ++k) {
    sighting.time = Time(std::chrono::milliseconds(30 * k));
    sighting.position << 0.05 * normal(random), 0.2 * normal(random);
    sighting.covariance = Eigen::Vector2d(0.0025, 0.04).asDiagonal();
    straight.update(sighting);
    sighting.position = T * sighting.position;
    sighting.covariance = symmetric(T * sighting.covariance * T.transpose());
    turned.update(sighting);
  }
  const AngularState a = *straight.stateAt(sighting.time), b = *turned.stateAt(sighting.time);
  Eigen::Matrix4d both = Eigen::Matrix4d::Zero();
  both.topLeftCorner<2, 2>() = both.bottomRightCorner<2, 2>() = T;
  EXPECT_LT((b.mean - both * a.mean).norm(), 1e-9);
  EXPECT_TRUE(b.covariance.isApprox(both * a.covariance * both.transpose(), 1e-9));
}

TEST(TwblsConsistent, CovarianceIsHonestForAWhiteAccelerationTarget) {
  // The truth is drawn from the middle model of the bank; the mean of the normalised squared error over
  // independent runs.
  const double q = 0.3, sigma = 0.08, h = 0.03;
  std::mt19937_64 random(8);
  std::normal_distribution<double> normal;
  const int runs = 400;
  double sum = 0.0;
  for (int run = 0; run < runs; ++run) {
    TwblsConsistentEstimator estimator(absolute({0.01, q, 10.0}));
    double position = 0.0, rate = 0.5 * normal(random);
    Measurement sighting;
    for (int k = 0; k < 100; ++k) {
      const double a = std::sqrt(q * h) * normal(random), b = normal(random);
      position += h * rate + 0.5 * h * a + std::sqrt(q * h * h * h / 12.0) * b;
      rate += a;
      sighting.time = Time(std::chrono::milliseconds(30 * k));
      sighting.position << position + sigma * normal(random), sigma * normal(random);
      sighting.covariance = Eigen::Matrix2d::Identity() * sigma * sigma;
      estimator.update(sighting);
    }
    const AngularState state = *estimator.stateAt(sighting.time);
    sum += std::pow(state.mean(0) - position, 2) / state.covariance(0, 0);
  }
  // 400 independent squares of standard normals: 1 +- 3.3 sqrt(2 / 400); the mixture's spread may lower it a
  // little.
  EXPECT_GT(sum / runs, 0.75);
  EXPECT_LT(sum / runs, 1.23);
}

}  // namespace
}  // namespace sightline::core
