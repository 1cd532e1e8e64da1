#include "sightline/core/estimators/uncertainty_reduction.h"

#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <stdexcept>
#include <string>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "support/covariances.h"
#include "support/golden.h"

namespace sightline::core {
namespace {

using Eigen::Dynamic;
using Eigen::Matrix2d;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Matrix23 = Eigen::Matrix<double, 2, 3>;
using Eigen::VectorXd;
using Matrix5 = Eigen::Matrix<double, 5, 5>;

/// One fixed size is tested, that of Case, and everything else with sizes known at run time: a size takes ten
/// seconds to compile.
using AnyModel = LinearModel<double, Dynamic, Dynamic>;
using ModelAt = std::function<AnyModel(const VectorXd&)>;

VectorXd scalar(double value) {
  return VectorXd::Constant(1, value);
}

/// Three parameters, two responses, everything correlated.
struct Case {
  LinearModel<double, 3, 2> model;
  Vector2d r;
  Matrix3d C_a;
  Matrix2d C_r;
  Matrix23 C_p;

  ReducedUncertainty<double, 3, 2> reduced() const { return reduceUncertainty(model, C_a, r, C_r, C_p); }
};

template <typename Matrix>
Matrix drawn(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  Matrix matrix;
  for (Eigen::Index i = 0; i < matrix.size(); ++i)
    matrix.data()[i] = static_cast<typename Matrix::Scalar>(normal(random));
  return matrix;
}

Case randomCase(unsigned seed) {
  std::mt19937_64 random(seed);
  const Matrix5 root = drawn<Matrix5>(random);
  const Matrix5 joint = symmetric(root * root.transpose());
  Case made;
  made.C_r = joint.topLeftCorner<2, 2>();
  made.C_p = joint.topRightCorner<2, 3>();
  made.C_a = joint.bottomRightCorner<3, 3>();
  made.model = {drawn<Vector3d>(random), drawn<Vector2d>(random), drawn<Matrix23>(random)};
  made.r = drawn<Vector2d>(random);
  return made;
}

Matrix5 jointOf(const Matrix2d& C_r, const Matrix23& C_p, const Matrix3d& C_a) {
  Matrix5 joint;
  joint << C_r, C_p, C_p.transpose(), C_a;
  return joint;
}

/// Change of (a, r) that minimises Q subject to S x - y + sign e = 0, from the stationary point of
/// L = z^T C^-1 z + 2 lambda^T (S x - y + sign e) with z = (y, x).
std::pair<Vector3d, Vector2d> minimumOfLagrangian(const Case& given, double sign) {
  MatrixXd G(2, 5);
  G << -Matrix2d::Identity(), given.model.S;
  MatrixXd system = MatrixXd::Zero(7, 7);
  const MatrixXd C = jointOf(given.C_r, given.C_p, given.C_a);
  system.topLeftCorner(5, 5) = C.ldlt().solve(MatrixXd::Identity(5, 5));
  system.topRightCorner(5, 2) = G.transpose();
  system.bottomLeftCorner(2, 5) = G;
  VectorXd right = VectorXd::Zero(7);
  right.tail<2>() = -sign * (given.model.q - given.r);
  const VectorXd solution = system.fullPivLu().solve(right);
  return {solution.segment<3>(2), solution.head<2>()};
}

class GoldenReduction : public testing::TestWithParam<const char*> {};

TEST_P(GoldenReduction, MatchesTheReferenceVectors) {
  SIGHTLINE_REQUIRE_SHARED();
  const YAML::Node given = test::golden(GetParam());
  const LinearModel<double, 3, 2> model{test::array(given["a"]), test::array(given["q"]),
                                        test::matrix(given["S"])};
  Matrix23 C_p = Matrix23::Zero();
  if (!given["Cp"].IsNull()) C_p = test::matrix(given["Cp"]);
  const auto reduced = reduceUncertainty(model, test::matrix(given["Ca"]), test::array(given["r"]).matrix(),
                                         test::matrix(given["Cr"]), C_p);
  const YAML::Node expected = given["out"];
  test::expectGolden(reduced.a, test::array(expected["a"]));
  test::expectGolden(reduced.r, test::array(expected["r"]));
  test::expectGolden(reduced.C_a, test::matrix(expected["Ca"]));
  test::expectGolden(reduced.C_r, test::matrix(expected["Cr"]));
  test::expectGolden(reduced.C_p, test::matrix(expected["Cp"]));
  test::expectGolden(reduced.lambda, test::array(expected["lam"]));
  EXPECT_NEAR(reduced.chi2, expected["chi2"].as<double>(), 1e-9 * reduced.chi2);
}

INSTANTIATE_TEST_SUITE_P(UncertaintyReduction, GoldenReduction, testing::Values("noga", "noga_cp"));

/// q = a0 exp(a1).
AnyModel growth(const VectorXd& a) {
  AnyModel model{a, scalar(a(0) * std::exp(a(1))), MatrixXd(1, 2)};
  model.S << std::exp(a(1)), a(0) * std::exp(a(1));
  return model;
}

TEST(IteratedReduction, MatchesTheReferenceVectorsAfterEveryNumberOfSteps) {
  SIGHTLINE_REQUIRE_SHARED();
  const YAML::Node given = test::golden("noga_iterated");
  for (const auto& expected : given["iters"]) {
    const auto result = reduceUncertaintyIterated(
        ModelAt(growth), VectorXd(test::array(given["a"])), test::array(given["Ca"]).matrix().asDiagonal(),
        scalar(given["r"].as<double>()), scalar(given["Cr"].as<double>()), MatrixXd::Zero(1, 2),
        {1e-14, expected.first.as<int>()});
    test::expectGolden(result.reduced.a, test::array(expected.second["a"]));
    test::expectGolden(result.reduced.r, test::array(expected.second["r"]));
    test::expectGolden(result.reduced.C_a, test::matrix(expected.second["Ca"]));
    EXPECT_LE(result.iterations, expected.first.as<int>());
  }
}

IteratedReduction<double, Dynamic, Dynamic> reducedGrowth(const IterationLimits& limits) {
  return reduceUncertaintyIterated(ModelAt(growth), VectorXd(Vector2d(1.0, 0.2)),
                                   Vector2d(0.3, 0.2).asDiagonal(), scalar(4.0), scalar(0.05),
                                   MatrixXd::Zero(1, 2), limits);
}

TEST(IteratedReduction, AtConvergenceTheResponseIsTheModelsAndBeforeItIsNot) {
  const auto converged = reducedGrowth({1e-12, 50});
  ASSERT_TRUE(converged.converged);
  EXPECT_NEAR(growth(converged.reduced.a).q(0), converged.reduced.r(0), 1e-10);
  const auto one_step = reducedGrowth({1e-12, 1});
  EXPECT_FALSE(one_step.converged);
  EXPECT_GT(std::abs(growth(one_step.reduced.a).q(0) - one_step.reduced.r(0)), 1.0);
}

TEST(IteratedReduction, HalvesTheStepsOfAModelOnWhichFullStepsDiverge) {
  const ModelAt model = [](const VectorXd& a) {  // full steps on atan(a) = 0 run away from |a| > 1.39
    return AnyModel{a, scalar(std::atan(a(0))), scalar(1.0 / (1.0 + a(0) * a(0)))};
  };
  const auto result = reduceUncertaintyIterated(model, scalar(5.0), scalar(1e4), scalar(0.0), scalar(1e-6),
                                                scalar(0.0), {1e-12, 60});
  EXPECT_TRUE(result.converged);
  EXPECT_NEAR(result.reduced.a(0), 0.0, 1e-4);
}

TEST(IteratedReduction, OfALinearModelIsTheReductionItself) {
  const Case given = randomCase(5);
  const ModelAt linear = [&](const VectorXd& a) {
    return AnyModel{a, given.model.q + given.model.S * (a - given.model.a), given.model.S};
  };
  const auto result = reduceUncertaintyIterated(linear, VectorXd(given.model.a), given.C_a, VectorXd(given.r),
                                                given.C_r, given.C_p);
  const auto expected = given.reduced();
  EXPECT_TRUE(result.converged);
  EXPECT_TRUE(result.reduced.a.isApprox(expected.a, 1e-12));
  EXPECT_TRUE(result.reduced.r.isApprox(expected.r, 1e-12));
  EXPECT_TRUE(result.reduced.C_a.isApprox(expected.C_a, 1e-12));
}

TEST(UncertaintyReduction, LeavesNoDoubtBetweenModelAndResponse) {
  for (unsigned seed = 1; seed <= 50; ++seed) {
    const Case given = randomCase(seed);
    const auto reduced = given.reduced();
    const Matrix23& S = given.model.S;
    const double scale = given.C_a.norm() + given.C_r.norm();
    EXPECT_LT((reduced.C_p - S * reduced.C_a).norm(), 1e-11 * scale);
    EXPECT_LT((reduced.C_r - S * reduced.C_a * S.transpose()).norm(), 1e-11 * scale);
    EXPECT_LT((reduced.r - given.model.q - S * (reduced.a - given.model.a)).norm(), 1e-11 * scale);
  }
}

TEST(UncertaintyReduction, NeverMakesAnythingLessKnown) {
  for (unsigned seed = 1; seed <= 50; ++seed) {
    const Case given = randomCase(seed);
    const auto reduced = given.reduced();
    const double rounding = -1e-11 * (given.C_a.norm() + given.C_r.norm());
    EXPECT_GE(test::leastEigenvalue(Matrix3d(given.C_a - reduced.C_a)), rounding);
    EXPECT_GE(test::leastEigenvalue(Matrix2d(given.C_r - reduced.C_r)), rounding);
    EXPECT_GE(test::leastEigenvalue(jointOf(reduced.C_r, reduced.C_p, reduced.C_a)), rounding);
  }
}

TEST(UncertaintyReduction, IsTheMinimumOfTheLagrangianWithPlusEAndNotWithMinusE) {
  const Case given = randomCase(2);
  const auto reduced = given.reduced();
  const auto [x, y] = minimumOfLagrangian(given, 1.0);  // (19C)
  EXPECT_TRUE(x.isApprox(reduced.a - given.model.a, 1e-10));
  EXPECT_TRUE(y.isApprox(reduced.r - given.r, 1e-10));
  const auto [x_printed, y_printed] = minimumOfLagrangian(given, -1.0);
  EXPECT_TRUE(x_printed.isApprox(given.model.a - reduced.a, 1e-10));
  EXPECT_TRUE(y_printed.isApprox(given.r - reduced.r, 1e-10));
}

TEST(UncertaintyReduction, OfFixedAndOfDynamicSizeAreOne) {
  const Case given = randomCase(3);
  const AnyModel model{given.model.a, given.model.q, given.model.S};
  const auto reduced = reduceUncertainty(model, given.C_a, given.r, given.C_r, given.C_p);
  const auto expected = given.reduced();
  EXPECT_TRUE(reduced.a.isApprox(expected.a, 1e-13));
  EXPECT_TRUE(reduced.r.isApprox(expected.r, 1e-13));
  EXPECT_TRUE(reduced.C_a.isApprox(expected.C_a, 1e-12));
  EXPECT_TRUE(reduced.C_p.isApprox(expected.C_p, 1e-12));
  EXPECT_NEAR(reduced.chi2, expected.chi2, 1e-12 * expected.chi2);
}

/// A line through 20 values of noise `sigma`; the measurement is the last of them.
struct FittedLine {
  static constexpr double kSigma = 0.08;
  MatrixXd F = MatrixXd::Ones(20, 2);
  MatrixXd B;  // a = B y
  VectorXd y;

  FittedLine() {
    std::mt19937_64 random(11);
    y = kSigma * drawn<Eigen::Matrix<double, 20, 1>>(random);
    F.col(0) = VectorXd::LinSpaced(20, 0.57, 0.0);
    B = MatrixXd(F.transpose() * F).llt().solve(F.transpose());
  }
  AnyModel model() const { return {B * y, F.row(19) * (B * y), F.row(19)}; }
  MatrixXd covariance() const { return kSigma * kSigma * B * B.transpose(); }
  ReducedUncertainty<double, Dynamic, Dynamic> with(const MatrixXd& C_p) const {
    return reduceUncertainty(model(), covariance(), scalar(y(19)), scalar(kSigma * kSigma), C_p);
  }
};

TEST(UncertaintyReduction, ADatumThatServedAlreadyChangesNothingWhenCpSaysSo) {
  const FittedLine line;
  const auto reduced = line.with(FittedLine::kSigma * FittedLine::kSigma * line.B.col(19).transpose());
  EXPECT_TRUE(reduced.a.isApprox(line.model().a, 1e-12));
  EXPECT_NEAR(reduced.r(0), line.model().q(0), 1e-14);
  EXPECT_NEAR(reduced.C_r(0), (line.model().S * line.covariance() * line.model().S.transpose())(0), 1e-15);
}

TEST(UncertaintyReduction, ADatumCountedTwiceMakesTheVarianceSixteenPercentTooSmall) {
  const FittedLine line;
  const double C_q = (line.model().S * line.covariance() * line.model().S.transpose())(0);
  EXPECT_NEAR(line.with(MatrixXd::Zero(1, 2)).C_r(0) / C_q, 0.8434, 5e-5);
}

TEST(UncertaintyReduction, OfStateAndProcessNoiseRecursivelyIsTheKalmanFilter) {
  constexpr double kDensity = 0.3, kVariance = 0.0064;
  const MatrixXd H = Eigen::RowVector2d(1.0, 0.0);
  std::mt19937_64 random(4);
  std::normal_distribution<double> normal;
  std::uniform_int_distribution<int> tick(1, 5);
  VectorXd x_noga = Vector2d(0.1, 0.0), x_kalman = x_noga;
  MatrixXd P_noga = Vector2d(kVariance, 4.0).asDiagonal(), P_kalman = P_noga;
  for (int k = 0; k < 50; ++k) {
    const double h = 0.01 * tick(random);
    const VectorXd z = scalar(std::sin(0.03 * k) + std::sqrt(kVariance) * normal(random));
    MatrixXd F(2, 2), Q(2, 2);
    F << 1.0, h, 0.0, 1.0;
    Q << h * h * h / 3.0, h * h / 2.0, h * h / 2.0, h;
    Q *= kDensity;

    AnyModel model{VectorXd(4), VectorXd(1), MatrixXd(1, 4)};  // a = (state, process noise)
    model.a << x_noga, Vector2d::Zero();
    model.S << H * F, H;
    model.q = model.S * model.a;
    MatrixXd C_a(4, 4);
    C_a << P_noga, Matrix2d::Zero(), Matrix2d::Zero(), Q;
    const auto reduced = reduceUncertainty(model, C_a, z, scalar(kVariance));
    MatrixXd onward(2, 4);
    onward << F, Matrix2d::Identity();
    x_noga = onward * reduced.a;
    P_noga = symmetric(onward * reduced.C_a * onward.transpose());

    x_kalman = F * x_kalman;
    P_kalman = F * P_kalman * F.transpose() + Q;
    const VectorXd K = P_kalman.col(0) / (P_kalman(0, 0) + kVariance);
    x_kalman += K * (z(0) - x_kalman(0));
    P_kalman = (MatrixXd::Identity(2, 2) - K * H) * P_kalman;
    EXPECT_LT((x_noga - x_kalman).norm(), 1e-13);
    EXPECT_LT((P_noga - P_kalman).norm(), 1e-14);
  }
}

/// Whether C_a after the reduction is indefinite in single precision, printed (21) and Joseph form (S-7). As
/// many responses as parameters: a direction that stays unknown keeps its huge variance, and then already the
/// rounding of the exact result to single precision can be indefinite.
struct Indefinite {
  bool printed, joseph;
};

Indefinite indefiniteInSinglePrecision(unsigned seed, float prior_scale) {
  using Matrix3f = Eigen::Matrix3f;
  using Eigen::MatrixXf;
  std::mt19937_64 random(seed);
  const auto covariance = [&random] {
    const Matrix3f root = drawn<Matrix3f>(random);
    return Matrix3f(symmetric(root * root.transpose() + 0.1F * Matrix3f::Identity()));
  };
  const MatrixXf C_a = covariance() * prior_scale, C_r = covariance();
  const LinearModel<float, Dynamic, Dynamic> model{Eigen::VectorXf::Zero(3), Eigen::VectorXf::Zero(3),
                                                   drawn<Matrix3f>(random)};
  const MatrixXf& S = model.S;
  const MatrixXf D = C_r + S * C_a * S.transpose();
  const MatrixXf printed = C_a - C_a * S.transpose() * D.llt().solve(S * C_a);  // (21) as it stands
  const MatrixXf joseph = reduceUncertainty(model, C_a, Eigen::Vector3f(0.1F, -0.2F, 0.3F), C_r).C_a;
  const auto indefinite = [](const MatrixXf& C) {
    return test::leastEigenvalue(symmetric(C.cast<double>())) < 0.0;
  };
  return {indefinite(printed), indefinite(joseph)};
}

TEST(UncertaintyReduction, StaysPositiveDefiniteInSinglePrecisionWhereThePrintedFormDoesNot) {
  int printed = 0, joseph = 0;
  for (unsigned seed = 1; seed <= 200; ++seed) {
    const Indefinite result = indefiniteInSinglePrecision(seed, 1e6F);
    printed += result.printed;
    joseph += result.joseph;
  }
  EXPECT_EQ(joseph, 0);
  EXPECT_GT(printed, 20) << "the comparison is no longer one";
}

TEST(UncertaintyReduction, TakesParametersThatAreKnownExactly) {
  Case given = randomCase(6);
  given.C_p.setZero();
  given.C_a.setZero();
  const auto reduced = given.reduced();
  EXPECT_TRUE(reduced.a.isApprox(given.model.a));
  EXPECT_TRUE(reduced.r.isApprox(given.model.q, 1e-12));
  EXPECT_NEAR(reduced.C_r.norm(), 0.0, 1e-12);
}

std::string refusalOf(const Case& given) {
  try {
    given.reduced();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

TEST(UncertaintyReduction, RefusesWhatIsNoCovarianceAndNamesIt) {
  const Case good = randomCase(7);
  EXPECT_EQ(refusalOf(good), "accepted");

  Case bad = good;
  bad.C_p *= 10.0;
  EXPECT_NE(refusalOf(bad).find("C_p does not go with C_r and C_a"), std::string::npos) << refusalOf(bad);
  bad = good;
  bad.C_r = -bad.C_r;
  EXPECT_NE(refusalOf(bad).find("C_r (of the measurement)"), std::string::npos) << refusalOf(bad);
  bad = good;
  bad.C_a(0, 1) = bad.C_a(1, 0) = 2.0 * std::sqrt(bad.C_a(0, 0) * bad.C_a(1, 1));
  EXPECT_NE(refusalOf(bad).find("C_a (of the parameters)"), std::string::npos) << refusalOf(bad);
  bad = good;
  bad.C_a(0, 1) += 0.1;
  EXPECT_NE(refusalOf(bad).find("not symmetric"), std::string::npos) << refusalOf(bad);
  bad = good;
  bad.C_a(2, 2) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(refusalOf(bad).find("not finite"), std::string::npos) << refusalOf(bad);
  bad = good;
  bad.C_a.setZero();
  bad.C_p.setZero();
  bad.C_r.setZero();
  EXPECT_NE(refusalOf(bad).find("give the measurement its noise"), std::string::npos) << refusalOf(bad);
}

TEST(UncertaintyReduction, RefusesSizesThatDoNotFit) {
  const Case given = randomCase(8);
  const AnyModel model{given.model.a, given.model.q, given.model.S};
  EXPECT_THROW(reduceUncertainty(model, MatrixXd::Identity(2, 2), given.r, given.C_r, given.C_p),
               std::invalid_argument);
}

}  // namespace
}  // namespace sightline::core
