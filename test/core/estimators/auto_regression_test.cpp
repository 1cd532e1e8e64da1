#include "sightline/core/estimators/auto_regression.h"

#include <cmath>
#include <random>

#include <Eigen/LU>
#include <Eigen/SVD>
#include <gtest/gtest.h>

#include "support/simulated.h"

namespace sightline::core {
namespace {

Eigen::ArrayXd unweighted(const Eigen::ArrayXd& value) {
  return Eigen::ArrayXd::Ones(value.size());
}

TEST(AutoRegression, OfAStraightLineAtEqualIntervalsIsTwiceTheLastLessTheOneBefore) {
  const Eigen::ArrayXd value = 0.5 + 1.3 * Eigen::ArrayXd::LinSpaced(20, 0.0, 0.57);
  const auto fit = fitAutoRegression(value, unweighted(value));
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->a(0), 2.0, 1e-9);
  EXPECT_NEAR(fit->a(1), -1.0, 1e-9);
  EXPECT_NEAR(fit->efit_squared, 0.0, 1e-25);
}

TEST(AutoRegression, OfAnOscillationAtEqualIntervalsIsTwiceTheCosine) {
  const double phase = 2.5 * 0.03;
  const Eigen::ArrayXd value = (phase * Eigen::ArrayXd::LinSpaced(20, 0.0, 19.0)).sin();
  const auto fit = fitAutoRegression(value, unweighted(value));
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->a(0), 2.0 * std::cos(phase), 1e-9);
  EXPECT_NEAR(fit->a(1), -1.0, 1e-9);
}

TEST(AutoRegression, OfNoisySightingsShrinksTowardsTheMeanOfTheLastTwo) {
  // Errors in variables: where the truth is near (2, -1), the reference has (0.49, 0.44) at 8 % noise and
  // (0.54, 0.39) at 4 %. Which stretch of the curve it is taken from moves it by some hundredths.
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  int count = 0;
  for (unsigned run = 1; run <= 30; ++run) {
    const auto sightings = test::sightingsOf(test::sinusoid, 0.08, run);
    Eigen::ArrayXd value(20);
    for (std::size_t last = 19; last < sightings.size(); ++last) {
      for (int channel = 0; channel < 2; ++channel) {
        for (int i = 0; i < 20; ++i)
          value(i) = sightings[last - 19 + static_cast<std::size_t>(i)].position(channel);
        sum += fitAutoRegression(value, unweighted(value))->a;
        ++count;
      }
    }
  }
  EXPECT_NEAR(sum(0) / count, 0.49, 0.06);
  EXPECT_NEAR(sum(1) / count, 0.44, 0.06);
}

TEST(AutoRegression, WeightedByAgeGivesTheNewestOfAConstantSignalANegativeWeight) {
  // Three rows, as the paper prints them.
  const Eigen::ArrayXd value = Eigen::ArrayXd::Constant(5, 0.7);
  const Eigen::ArrayXd age =
      Eigen::ArrayXd::LinSpaced(5, 0.15, 0.03);  // seen from the sighting after the last
  const Eigen::ArrayXd weight = age * (-age).exp();
  const auto fit = fitAutoRegression(value, weight);
  ASSERT_TRUE(fit);
  EXPECT_NEAR(weight(4) * fit->a(0), -0.935, 5e-4);
  EXPECT_NEAR(weight(3) * fit->a(1), 1.933, 5e-4);
}

TEST(AutoRegression, AgreesWithTheSingularValueDecompositionOverAllConditions) {
  std::mt19937_64 random(9);
  std::normal_distribution<double> normal;
  for (const double spread : {1.0, 1e-3, 1e-6}) {  // of the values about 1
    Eigen::ArrayXd value(20), weight(20);
    for (int i = 0; i < 20; ++i) {
      value(i) = 1.0 + spread * normal(random);
      weight(i) = 1.0 + 0.1 * spread * normal(random);
    }
    const auto fit = fitAutoRegression(value, weight);
    ASSERT_TRUE(fit);
    Eigen::MatrixXd F(18, 2);
    const Eigen::ArrayXd regressor = weight * value;
    F << regressor.segment(1, 18).matrix(), regressor.head(18).matrix();
    const Eigen::VectorXd y = value.tail(18).matrix();
    const Eigen::Vector2d a = F.jacobiSvd(Eigen::ComputeThinU | Eigen::ComputeThinV).solve(y);
    const double rounding = 1e-14 / spread;
    EXPECT_LT((fit->a - a).norm(), 10.0 * rounding);
    EXPECT_NEAR(fit->efit_squared, (y - F * a).squaredNorm() / 16.0, 1e-6 * fit->efit_squared);
    if (spread < 1e-5) continue;  // the comparison's inverse is the less exact one
    const Eigen::Matrix2d product = fit->C_a * Eigen::Matrix2d(F.transpose() * F);
    EXPECT_TRUE(product.isApprox(fit->efit_squared * Eigen::Matrix2d::Identity(), 1e-9 / spread));
  }
}

TEST(AutoRegression, DoesNotDependOnTheUnitOfTheAngles) {
  std::mt19937_64 random(10);
  std::normal_distribution<double> normal;
  const Eigen::ArrayXd value =
      Eigen::ArrayXd::Zero(20).unaryExpr([&](double) { return 1.0 + 0.1 * normal(random); });
  const auto large = fitAutoRegression(value, unweighted(value));
  const auto small = fitAutoRegression(1e-5 * value, unweighted(value));
  ASSERT_TRUE(large && small);
  EXPECT_TRUE(small->a.isApprox(large->a, 1e-9));
  EXPECT_TRUE(small->C_a.isApprox(large->C_a, 1e-9));
  EXPECT_NEAR(small->efit_squared, 1e-10 * large->efit_squared, 1e-19 * large->efit_squared);
}

TEST(AutoRegression, GivesWhatTheRowsLeaveOpenZero) {
  const Eigen::ArrayXd constant = Eigen::ArrayXd::Constant(20, 0.7);
  const auto same = fitAutoRegression(constant, unweighted(constant));
  ASSERT_TRUE(same);
  EXPECT_TRUE(same->a.isApprox(Eigen::Vector2d(0.5, 0.5), 1e-12)) << "the shortest of all solutions";
  EXPECT_TRUE(same->C_a.allFinite());

  const auto nothing = fitAutoRegression(Eigen::ArrayXd::Zero(20), unweighted(constant));
  ASSERT_TRUE(nothing);
  EXPECT_EQ(nothing->a.norm(), 0.0);
  EXPECT_EQ(nothing->C_a.norm(), 0.0);

  Eigen::ArrayXd pulse = Eigen::ArrayXd::Zero(8);
  pulse(0) = 1.0;  // only the older regressor of the first row is not zero
  const auto one = fitAutoRegression(pulse, unweighted(pulse));
  ASSERT_TRUE(one);
  EXPECT_EQ(one->a.norm(), 0.0);
  EXPECT_TRUE(one->C_a.allFinite());
}

TEST(AutoRegression, NeedsThreeRows) {
  EXPECT_FALSE(fitAutoRegression(Eigen::ArrayXd::Ones(4), Eigen::ArrayXd::Ones(4)));
  EXPECT_TRUE(fitAutoRegression(Eigen::ArrayXd::Ones(5), Eigen::ArrayXd::Ones(5)));
}

}  // namespace
}  // namespace sightline::core
