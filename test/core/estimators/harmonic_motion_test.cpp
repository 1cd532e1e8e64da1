#include "sightline/core/estimators/harmonic_motion.h"

#include <cmath>

#include <gtest/gtest.h>

#include "support/golden.h"

namespace sightline::core {
namespace {

TEST(Stumpff, MatchesTheReferenceVectors) {
  SIGHTLINE_REQUIRE_SHARED();
  for (const YAML::Node& expected : test::golden("stumpff")) {
    if (expected["z"].as<double>() > 5.0) continue;  // see the next test
    const Stumpff s = stumpff(expected["z"].as<double>());
    test::expectGolden(Eigen::Vector3d(s.c0, s.c1, s.c2), test::array(expected["c"]).matrix());
    test::expectGolden(Eigen::Vector3d(s.d0, s.d1, s.d2), test::array(expected["d"]).matrix());
  }
}

TEST(Stumpff, IsTheCosineWhereTheReferenceVectorIsACutSeries) {
  const double z = 6.0, root = std::sqrt(z);
  EXPECT_NEAR(stumpff(z).c0, std::cos(root), 1e-15);
  EXPECT_NEAR(stumpff(z).c1, std::sin(root) / root, 1e-15);
  SIGHTLINE_REQUIRE_SHARED();
  // The reference's value at z = 6 is the power series of nine terms, 1.5e-9 off the cosine: it cannot be
  // matched to 1e-9.
  double series = 0.0, term = 1.0;
  for (int k = 0; k < 9; ++k) {
    series += term;
    term *= -z / ((2 * k + 1) * (2 * k + 2));
  }
  for (const YAML::Node& expected : test::golden("stumpff")) {
    if (expected["z"].as<double>() == z) {
      EXPECT_NEAR(expected["c"][0].as<double>(), series, 1e-15);
    }
  }
  EXPECT_GT(std::abs(series - std::cos(root)), 1e-9);
}

TEST(Stumpff, SeriesAndClosedFormMeet) {
  for (const double z : {-0.5, 0.5}) {
    const Stumpff inside = stumpff(z * (1.0 - 1e-12)), outside = stumpff(z * (1.0 + 1e-12));
    EXPECT_NEAR(inside.c0, outside.c0, 1e-11);
    EXPECT_NEAR(inside.c1, outside.c1, 1e-11);
    EXPECT_NEAR(inside.c2, outside.c2, 1e-11);
    EXPECT_NEAR(inside.d0, outside.d0, 1e-11);
    EXPECT_NEAR(inside.d1, outside.d1, 1e-11);
    EXPECT_NEAR(inside.d2, outside.d2, 1e-11);
  }
}

TEST(HarmonicMotion, MatchesTheReferenceVectors) {
  SIGHTLINE_REQUIRE_SHARED();
  YAML::Node expected = test::golden("harm_transition");
  Eigen::Vector4d x = test::array(expected["x"]);
  Transition step =
      harmonicStep(x, expected["h"].as<double>(), expected["qj"].as<double>(), expected["qk"].as<double>());
  test::expectGolden(step.mean, test::array(expected["xn"]).matrix());
  test::expectGolden(step.F, test::matrix(expected["F"]));
  test::expectGolden(step.Q, test::matrix(expected["Q"]));

  expected = test::golden("harm_fixed_transition");
  x = test::array(expected["x"]);
  step = fixedHarmonicStep(x, expected["h"].as<double>(), expected["qj"].as<double>(),
                           expected["kappa"].as<double>(), expected["sk"].as<double>());
  test::expectGolden(step.mean, test::array(expected["xn"]).matrix());
  test::expectGolden(step.F, test::matrix(expected["F"]));
  test::expectGolden(step.Q, test::matrix(expected["Q"]));
}

TEST(HarmonicMotion, FollowsASinusoidAboutAnyOffsetExactly) {
  const double w = 2.5;
  Eigen::Vector4d state(3.0 + std::sin(0.4), w * std::cos(0.4), -w * w * std::sin(0.4), w * w);
  double time = 0.0;
  for (const double h : {0.01, 0.3, 0.05, 1.0}) {
    state = harmonicStep(state, h, 0.0, 0.0).mean;
    time += h;
    EXPECT_NEAR(state(0), 3.0 + std::sin(0.4 + w * time), 1e-12);
    EXPECT_NEAR(state(1), w * std::cos(0.4 + w * time), 1e-12);
  }
}

TEST(HarmonicMotion, FIsTheDerivative) {
  for (const double kappa : {-0.8, 0.0, 1e-5, 3.0, 20.0}) {
    const Eigen::Vector4d state(0.3, -1.1, 0.7, kappa);
    const Transition step = harmonicStep(state, 0.2, 0.0, 0.0);
    for (int i = 0; i < 4; ++i) {
      const Eigen::Vector4d shift = 1e-6 * Eigen::Vector4d::Unit(i);
      const Eigen::Vector4d slope = (harmonicStep(state + shift, 0.2, 0.0, 0.0).mean -
                                     harmonicStep(state - shift, 0.2, 0.0, 0.0).mean) /
                                    2e-6;
      EXPECT_LT((step.F.col(i) - slope).norm(), 1e-8) << "column " << i << ", kappa " << kappa;
    }
  }
}

TEST(HarmonicMotion, KappaIsKeptWithinItsBounds) {
  EXPECT_EQ(harmonicStep({0.0, 0.0, 0.0, -7.0}, 0.1, 0.0, 0.0).mean(3), -1.0);
  EXPECT_EQ(harmonicStep({0.0, 0.0, 0.0, 99.0}, 0.1, 0.0, 0.0).mean(3), 40.0);
}

TEST(FadingMotion, AccelerationDiesAwayAndLeavesItsRate) {
  const Transition step = fadingStep({0.0, 0.0, 1.0, 0.0}, 20.0, 1.0, 0.5, 1.0);
  EXPECT_NEAR(step.mean(2), 0.0, 1e-12);
  EXPECT_NEAR(step.mean(1), 0.5, 1e-12);                // a tau
  EXPECT_NEAR(step.mean(0), 0.5 * 20.0 - 0.25, 1e-12);  // a tau (h - tau)
}

TEST(FadingMotion, TwoStepsAreOneInMeanAndCovariance) {
  // F(h1 + h2) = F(h2) F(h1) and Q(h1 + h2) = F(h2) Q(h1) F(h2)^T + Q(h2), by series and by closed form.
  for (const auto& [h1, h2] : {std::pair{0.01, 0.03}, {0.3, 0.9}, {1.5, 4.0}, {0.001, 3.0}}) {
    const Eigen::Vector4d zero = Eigen::Vector4d::Zero();
    const Transition first = fadingStep(zero, h1, 2.0, 1.0, 0.0),
                     second = fadingStep(zero, h2, 2.0, 1.0, 0.0),
                     both = fadingStep(zero, h1 + h2, 2.0, 1.0, 0.0);
    EXPECT_TRUE((second.F * first.F).isApprox(both.F, 1e-12)) << h1 << " " << h2;
    const Eigen::Matrix4d Q = second.F * first.Q * second.F.transpose() + second.Q;
    EXPECT_TRUE(Q.isApprox(both.Q, 1e-9)) << h1 << " " << h2;
  }
}

TEST(FadingMotion, ThatHardlyFadesIsWhiteJerk) {
  const double h = 0.5;
  const Transition step = fadingStep(Eigen::Vector4d(1.0, 2.0, 3.0, 0.0), h, 2.0, 1e6, 0.0);
  const Transition jerk = fixedHarmonicStep(Eigen::Vector4d(1.0, 2.0, 3.0, 0.0), h, 2.0, 0.0, 0.0);
  EXPECT_TRUE(step.mean.isApprox(jerk.mean, 1e-5));
  EXPECT_TRUE(step.Q.isApprox(jerk.Q, 1e-5));
}

TEST(AutoRegression, MatchesTheReferenceVectors) {
  SIGHTLINE_REQUIRE_SHARED();
  for (const YAML::Node& expected : test::golden("ar2_coeffs")) {
    const Eigen::Vector2d a = autoRegression(expected["kappa"].as<double>(), expected["h1"].as<double>(),
                                             expected["h2"].as<double>());
    test::expectGolden(a, test::array(expected["a"]).matrix());
  }
}

TEST(AutoRegression, ContinuesASinusoidOnIrregularTimes) {
  const double w = 1.7, h_1 = 0.05, h_2 = 0.013, t = 0.9;
  const Eigen::Vector2d a = autoRegression(w * w, h_1, h_2);
  EXPECT_NEAR(std::sin(w * t), a(0) * std::sin(w * (t - h_1)) + a(1) * std::sin(w * (t - h_1 - h_2)), 1e-14);
}

}  // namespace
}  // namespace sightline::core
