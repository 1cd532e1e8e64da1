#include "sightline/core/estimators/noga.h"

#include <cmath>
#include <stdexcept>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <gtest/gtest.h>

#include "support/simulated.h"

namespace sightline::core {
namespace {

NogaParams printed(int rows = 18, bool weighted = false) {
  NogaParams params;
  params.rows = rows;
  params.weighted = weighted;
  params.covariance = NogaCovariance::printed;
  return params;
}

auto maker(const NogaParams& params) {
  return [params] { return std::make_unique<NogaEstimator>(params); };
}

/// One channel of section 4.1 as it stands, in the printed form of the reduction.
struct Literal {
  double q, C_q, r_hat, C_r_hat;
};

Literal literal(const std::vector<Measurement>& sightings, std::size_t k, int channel,
                const NogaParams& params) {
  const auto n = static_cast<Eigen::Index>(params.rows);
  const auto y = [&](std::size_t j) { return sightings[j].position(channel); };
  const auto w = [&](std::size_t j) {
    const double d = seconds(sightings[k].time - sightings[j].time);
    return params.weighted ? d * std::exp(-d) : 1.0;
  };
  Eigen::MatrixXd F(n, 2);
  Eigen::VectorXd Y(n);
  for (Eigen::Index row = 0; row < n; ++row) {
    const std::size_t j = k - static_cast<std::size_t>(n - row);
    F.row(row) << w(j - 1) * y(j - 1), w(j - 2) * y(j - 2);
    Y(row) = y(j);
  }
  const Eigen::Vector2d a = F.jacobiSvd(Eigen::ComputeThinU | Eigen::ComputeThinV).solve(Y);  // (16C)
  const Eigen::Matrix2d C_a =
      (Y - F * a).squaredNorm() / static_cast<double>(n - 2) * Eigen::Matrix2d(F.transpose() * F).inverse();
  const Eigen::RowVector2d S(w(k - 1) * y(k - 1), w(k - 2) * y(k - 2));
  const double q = S * a, C_q = S * C_a * S.transpose(), C_r = sightings[k].covariance(channel, channel);
  const double r = y(k), D = C_r + C_q;
  return {q, C_q, r + C_r / D * (q - r), C_r - C_r * C_r / D};  // (20), (22)
}

class LiteralNoga : public testing::TestWithParam<std::pair<int, bool>> {};

TEST_P(LiteralNoga, IsWhatTheEstimatorComputes) {
  const auto [rows, weighted] = GetParam();
  const NogaParams params = printed(rows, weighted);
  auto sightings = test::sightingsOf(test::sinusoid, 0.08, 7, 3.0);
  for (std::size_t i = 0; i < sightings.size(); ++i) {  // at equal times: none is late
    sightings[i].time = Time(std::chrono::milliseconds(30 * i));
    sightings[i].ifov = 1.0;
  }
  NogaEstimator estimator(params);
  for (std::size_t k = 0; k < sightings.size(); ++k) {
    const auto expected = estimator.stateAt(sightings[k].time);
    estimator.update(sightings[k]);
    if (k < static_cast<std::size_t>(rows) + 2) continue;
    ASSERT_TRUE(estimator.isAutoRegressive());
    const AngularState state = *estimator.stateAt(sightings[k].time);
    for (int channel = 0; channel < 2; ++channel) {
      const Literal literally = literal(sightings, k, channel, params);
      const double size = std::abs(literally.q) + 1.0;
      EXPECT_NEAR(expected->mean(channel), literally.q, 1e-9 * size);
      EXPECT_NEAR(expected->covariance(channel, channel), literally.C_q, 1e-8 * literally.C_q + 1e-11);
      EXPECT_NEAR(state.mean(channel), literally.r_hat, 1e-9 * size);
      EXPECT_NEAR(state.covariance(channel, channel), literally.C_r_hat, 1e-8 * literally.C_r_hat + 1e-11);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Noga, LiteralNoga,
                         testing::Values(std::pair(18, false), std::pair(18, true), std::pair(3, false),
                                         std::pair(3, true)));

TEST(Noga, IsAsAccurateAsTheReferenceOnTheBenchmark) {
  // References from 100 runs; 40 runs have a standard error of 0.005 at 18 rows. Three rows have one degree
  // of freedom and heavy tails: the band is wide.
  const auto fine = test::benchmark(test::sinusoid, 0.08, 40, maker(printed()));
  EXPECT_NEAR(fine.estimate, 0.777, 0.025);
  EXPECT_NEAR(fine.prediction, 0.917, 0.025);
  const auto coarse = test::benchmark(test::sinusoid, 0.15, 40, maker(printed()));
  EXPECT_NEAR(coarse.estimate, 0.731, 0.025);
  EXPECT_NEAR(coarse.prediction, 0.851, 0.025);
  EXPECT_NEAR(test::benchmark(test::sinusoid, 0.08, 40, maker(printed(3))).estimate, 1.258, 0.15);
  EXPECT_NEAR(test::benchmark(test::sinusoid, 0.08, 40, maker(printed(3, true))).estimate, 2.730, 0.1);
  EXPECT_NEAR(test::benchmark(test::sinusoid, 0.08, 40, maker(printed(18, true))).estimate, 4.912, 0.1);
}

TEST(Noga, PrintedCovarianceIsFarTooSmallAndTheResidualOneIsNot) {
  EXPECT_GT(test::benchmark(test::sinusoid, 0.08, 20, maker(printed())).anees, 5.0);
  const auto residual = test::benchmark(test::sinusoid, 0.08, 20, maker(NogaParams{}));
  EXPECT_GT(residual.anees, 0.6);
  EXPECT_LT(residual.anees, 1.2);
  EXPECT_GT(residual.innovation, 0.7);
  EXPECT_LT(residual.innovation, 1.1);
}

TEST(Noga, TheKindOfCovarianceChangesNoEstimate) {
  NogaEstimator by_residual{NogaParams{}}, as_printed{printed()};
  for (const Measurement& sighting : test::sightingsOf(test::sinusoid, 0.08, 8, 3.0)) {
    by_residual.update(sighting);
    as_printed.update(sighting);
    const Time soon = sighting.time + durationOf(0.03);
    EXPECT_EQ(by_residual.stateAt(sighting.time)->mean, as_printed.stateAt(sighting.time)->mean);
    EXPECT_EQ(by_residual.stateAt(soon)->mean, as_printed.stateAt(soon)->mean);
  }
}

TEST(Noga, FedBackEstimatesRunAway) {
  NogaParams params = printed(3);
  params.feedback = true;
  EXPECT_GT(test::benchmark(test::sinusoid, 0.08, 5, maker(params)).estimate, 3.0);
}

TEST(Noga, GoesByAStraightLineUntilTheRowsAreThere) {
  NogaEstimator estimator{NogaParams{}};
  const auto sightings = test::sightingsOf(test::straight, 1e-4, 9, 2.0);
  for (std::size_t i = 0; i < 30; ++i) {
    estimator.update(sightings[i]);
    EXPECT_EQ(estimator.isAutoRegressive(), i >= 20);
    if (i < 4 || i >= 20) continue;
    const Eigen::Vector4d truth = test::straight(test::timeOf(sightings[i]));
    EXPECT_LT((estimator.stateAt(sightings[i].time)->angles() - truth.head<2>()).norm(), 5e-4);
  }
}

TEST(Noga, BeginsItsRowsAnewAfterAPause) {
  NogaEstimator estimator{NogaParams{}};
  int after_pause = 0;
  for (Measurement sighting : test::sightingsOf(test::straight, 1e-4, 10, 4.0)) {
    const bool late = test::timeOf(sighting) > 2.0;
    if (late) {
      sighting.time += durationOf(1.0);
      sighting.position += test::straight(1.0).head<2>() - test::straight(0.0).head<2>();
    }
    estimator.update(sighting);
    if (late && ++after_pause <= 20) {
      EXPECT_FALSE(estimator.isAutoRegressive());
    }
    const Eigen::Vector4d truth = test::straight(test::timeOf(sighting));
    EXPECT_LT((estimator.stateAt(sighting.time)->angles() - truth.head<2>()).norm(), 1e-3);
  }
  EXPECT_TRUE(estimator.isAutoRegressive());
}

TEST(Noga, CarriesOnAtTheLinesRateBeyondTheLongestInterval) {
  NogaEstimator estimator{NogaParams{}};
  Time last{};
  for (const Measurement& sighting : test::sightingsOf(test::straight, 1e-4, 11, 2.0)) {
    estimator.update(sighting);
    last = sighting.time;
  }
  for (const double ahead : {0.1, 1.0}) {
    const AngularState state = *estimator.stateAt(last + durationOf(ahead));
    const Eigen::Vector4d truth = test::straight(seconds(last.time_since_epoch()) + ahead);
    // The auto-regression does not see that the intervals differ, by 20 ms at the most.
    EXPECT_LT((state.angles() - truth.head<2>()).norm(), 0.3 * 0.02 + 2e-3 * ahead);
    EXPECT_LT((state.rates() - truth.tail<2>()).norm(), 2e-3);
  }
}

TEST(Noga, RefusesParametersOutOfRange) {
  EXPECT_THROW(NogaEstimator{printed(2)}, std::invalid_argument);
  EXPECT_THROW(NogaEstimator{printed(63)}, std::invalid_argument);
  NogaParams no_rate;
  no_rate.initial_rate_sigma = -0.1;
  EXPECT_THROW(NogaEstimator{no_rate}, std::invalid_argument);
}

}  // namespace
}  // namespace sightline::core
