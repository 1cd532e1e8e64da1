#include "sightline/core/fusion/rules/fusion_rules.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <string>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "support/covariances.h"
#include "support/golden.h"

namespace sightline::core {
namespace {

using Eigen::Matrix4d;
using Eigen::MatrixXd;
using Eigen::Vector4d;
using Sources = std::vector<Estimate<4>>;
using Fused = std::optional<FusedEstimate<4>>;

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double normal() { return normal_(engine_); }
  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine_);
  }

  Eigen::VectorXd normals(Eigen::Index n) {
    return Eigen::VectorXd::NullaryExpr(n, [this] { return normal(); });
  }

  /// Covariance of standard deviations about `sigma` (positions) and ten times that (rates), correlated at
  /// random.
  Matrix4d covariance(double sigma = 1.0) {
    const MatrixXd root = MatrixXd::NullaryExpr(4, 6, [this] { return normal(); });
    const Vector4d units =
        sigma * Vector4d(uniform(0.3, 2.0), uniform(0.3, 2.0), uniform(3.0, 20.0), uniform(3.0, 20.0));
    return units.asDiagonal() * (root * root.transpose() / 6.0) * units.asDiagonal();
  }

  Sources sources(std::size_t n, double sigma = 1.0) {
    Sources sources(n);
    for (Estimate<4>& source : sources) source = {sigma * Vector4d(normals(4)), covariance(sigma)};
    return sources;
  }

 private:
  std::mt19937_64 engine_;
  std::normal_distribution<double> normal_;
};

Matrix4d rootOf(const Matrix4d& P) {
  return Eigen::LLT<Matrix4d>(P).matrixL();
}

/// A valid joint covariance in which every pair has correlation `rho` in the whitened coordinates, 0 <= rho
/// < 1.
MatrixXd jointOf(const Sources& sources, double rho) {
  const auto n = static_cast<Eigen::Index>(sources.size());
  MatrixXd joint(4 * n, 4 * n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) {
      const Matrix4d whole = rootOf(sources[i].covariance) * rootOf(sources[j].covariance).transpose();
      joint.block<4, 4>(4 * i, 4 * j) = (i == j ? 1.0 : rho) * whole;
    }
  }
  return joint;
}

/// Covariance of the fused error when the sources' errors have this joint covariance.
Matrix4d actualCovariance(const FusedEstimate<4>& fused, const MatrixXd& joint) {
  MatrixXd gains(4, joint.cols());
  for (std::size_t i = 0; i < fused.gains.size(); ++i) {
    gains.middleCols<4>(4 * static_cast<Eigen::Index>(i)) = fused.gains[i];
  }
  return gains * joint * gains.transpose();
}

/// Smallest eigenvalue of b - a in units of b: >= 0 means a <= b.
double loewnerMargin(const Matrix4d& a, const Matrix4d& b) {
  const Matrix4d inverse_root = rootOf(b).inverse();
  const Matrix4d difference = inverse_root * (b - a) * inverse_root.transpose();
  return test::leastEigenvalue(difference);
}

double logDeterminant(const MatrixXd& P) {
  return 2.0 * MatrixXd(Eigen::LLT<MatrixXd>(P).matrixL()).diagonal().array().log().sum();
}

/// Largest difference of two results, in units of `reference`'s standard deviations.
double disagreement(const FusedEstimate<4>& value, const FusedEstimate<4>& reference) {
  const Vector4d sigma = reference.covariance.diagonal().cwiseSqrt();
  const Vector4d mean = (value.mean - reference.mean).cwiseQuotient(sigma);
  const Matrix4d covariance = sigma.cwiseInverse().asDiagonal() * (value.covariance - reference.covariance) *
                              sigma.cwiseInverse().asDiagonal();
  return std::max(mean.cwiseAbs().maxCoeff(), covariance.cwiseAbs().maxCoeff());
}

struct Rule {
  std::string name;
  std::function<Fused(const Sources&)> fuse;
  bool two_only = false;
  bool any_units = true;       // invariant to every linear change of coordinates
  bool loewner_bound = false;  // P <= P_i
  double precision = 1e-8;     // of the result, in its own standard deviations
};

const std::vector<Rule>& rules() {
  static const std::vector<Rule> all{
      {"weighted covariance", [](const Sources& s) { return weightedCovariance(s); }, false, true, true},
      {"maximum likelihood", [](const Sources& s) { return maximumLikelihood(s, jointOf(s, 0.4)); }, false,
       false, true},
      {"Bar-Shalom and Campo",
       [](const Sources& s) { return barShalomCampo<4>(s[0], s[1], jointOf(s, 0.4).block<4, 4>(0, 4)); },
       true, false, true},
      {"intersection, determinant",
       [](const Sources& s) { return covarianceIntersection(s, IntersectionWeights::determinant); }},
      {"intersection, trace",
       [](const Sources& s) { return covarianceIntersection(s, IntersectionWeights::trace); }, false, false},
      {"inverse intersection", [](const Sources& s) { return inverseCovarianceIntersection(s[0], s[1]); },
       true, true, false, 1e-6},
  };
  return all;
}

/// Runs a property over every rule, on random sources; two of them where the rule knows no more.
void forEveryRule(const std::function<void(const Rule&, const Sources&)>& property) {
  for (const Rule& rule : rules()) {
    SCOPED_TRACE(rule.name);
    Random random(11);
    for (int trial = 0; trial < 50; ++trial) {
      property(rule, random.sources(rule.two_only ? 2 : 2 + static_cast<std::size_t>(trial) % 5));
    }
  }
}

TEST(FusionRules, MatchGoldenVectors) {
  SIGHTLINE_REQUIRE_SHARED();
  const YAML::Node golden = test::golden("fusion");
  const auto estimate = [&golden](const std::string& x, const std::string& P) {
    return Estimate<2>{test::array(golden[x]).matrix(), test::matrix(golden[P])};
  };
  const Estimate<2> a = estimate("x1", "P1"), b = estimate("x2", "P2");
  const Eigen::Matrix2d P12 = test::matrix(golden["P12"]);
  MatrixXd joint(4, 4);
  joint << a.covariance, P12, P12.transpose(), b.covariance;
  const Eigen::Vector2d half = Eigen::Vector2d::Constant(0.5);

  const auto expect = [&golden](const std::string& name, const std::optional<FusedEstimate<2>>& fused) {
    SCOPED_TRACE(name);
    ASSERT_TRUE(fused);
    test::expectGolden(fused->mean, test::array(golden["out"][name]["x"]).matrix());
    test::expectGolden(fused->covariance, test::matrix(golden["out"][name]["P"]));
  };
  expect("convex", weightedCovariance<2>({a, b}));
  expect("bar_shalom_campo", barShalomCampo<2>(a, b, P12));
  expect("ml", maximumLikelihood<2>({a, b}, joint));
  expect("ci_trace", covarianceIntersection<2>({a, b}, IntersectionWeights::trace));
  // Its optimiser was a coarse grid on which 1/2 is the best weight; the formulas are compared at that
  // weight.
  expect("ci_det", covarianceIntersection<2>({a, b}, half));
  expect("ici_det", inverseCovarianceIntersection<2>(a, b, 0.5));
}

TEST(FusionRules, OptimisedWeightsAreNoWorseThanGoldensGridAndNextToIt) {
  SIGHTLINE_REQUIRE_SHARED();
  const YAML::Node golden = test::golden("fusion");
  const Estimate<2> a{test::array(golden["x1"]).matrix(), test::matrix(golden["P1"])};
  const Estimate<2> b{test::array(golden["x2"]).matrix(), test::matrix(golden["P2"])};
  const double grid_ci = logDeterminant(test::matrix(golden["out"]["ci_det"]["P"]));
  const double grid_ici = logDeterminant(test::matrix(golden["out"]["ici_det"]["P"]));
  const double ci =
      logDeterminant(covarianceIntersection<2>({a, b}, IntersectionWeights::determinant)->covariance);
  const double ici = logDeterminant(inverseCovarianceIntersection<2>(a, b)->covariance);
  EXPECT_LE(ci, grid_ci);
  EXPECT_LE(ici, grid_ici);
  // By an independent search: w = 0.49122810 and 0.50194026.
  EXPECT_NEAR((*intersectionWeights<2>({a, b}, IntersectionWeights::determinant))(0), 0.491228101651189,
              1e-7);
  EXPECT_NEAR(ci, -1.1507046242487924, 1e-8);
  EXPECT_NEAR(ici, -1.3279603811865868, 1e-8);
}

TEST(FusionRules, FusedCovarianceIsNeverLargerThanTheBestSource) {
  forEveryRule([](const Rule& rule, const Sources& sources) {
    const Fused fused = rule.fuse(sources);
    ASSERT_TRUE(fused);
    double least_volume = std::numeric_limits<double>::infinity();
    double harmonic = 0.0;
    for (const Estimate<4>& source : sources) {
      if (rule.loewner_bound) {
        EXPECT_GE(loewnerMargin(fused->covariance, source.covariance), -1e-9);
      }
      least_volume = std::min(least_volume, logDeterminant(source.covariance));
      harmonic += 1.0 / source.covariance.trace() / static_cast<double>(sources.size());
    }
    if (rule.name == "intersection, trace") {
      EXPECT_LE(fused->covariance.trace(), (1.0 + 1e-9) / harmonic);
    } else {
      EXPECT_LE(logDeterminant(fused->covariance), least_volume + 1e-7);
    }
  });
}

TEST(FusionRules, CovarianceIsSymmetricPositiveDefiniteAndGainsAddUpToOne) {
  forEveryRule([](const Rule& rule, const Sources& sources) {
    const Fused fused = rule.fuse(sources);
    ASSERT_TRUE(fused);
    EXPECT_EQ(fused->covariance, fused->covariance.transpose());
    EXPECT_EQ(Eigen::LLT<Matrix4d>(fused->covariance).info(), Eigen::Success);
    Matrix4d sum = Matrix4d::Zero();
    Vector4d mean = Vector4d::Zero();
    for (std::size_t i = 0; i < sources.size(); ++i) {
      sum += fused->gains[i];
      mean += fused->gains[i] * sources[i].mean;
    }
    EXPECT_TRUE(sum.isApprox(Matrix4d::Identity(), 1e-9)) << sum;
    EXPECT_TRUE(mean.isApprox(fused->mean, 1e-9));
  });
}

TEST(FusionRules, OrderOfSourcesDoesNotMatter) {
  forEveryRule([](const Rule& rule, const Sources& sources) {
    Sources turned(sources.rbegin(), sources.rend());
    EXPECT_LT(disagreement(*rule.fuse(turned), *rule.fuse(sources)), 10.0 * rule.precision);
  });
}

TEST(FusionRules, OrderOfSourcesWithEqualCovariancesDoesNotMatter) {
  forEveryRule([](const Rule& rule, Sources sources) {
    for (Estimate<4>& source : sources) source.covariance = sources.front().covariance;
    Sources turned(sources.rbegin(), sources.rend());
    EXPECT_LT(disagreement(*rule.fuse(turned), *rule.fuse(sources)), 1e-6);
  });
}

TEST(FusionRules, UnitsDoNotMatter) {
  forEveryRule([](const Rule& rule, const Sources& sources) {
    const Fused plain = rule.fuse(sources);
    for (const double unit : {1e-5, 1e-3, 1e3}) {
      Sources scaled = sources;
      for (Estimate<4>& source : scaled) source.mean *= unit, source.covariance *= unit * unit;
      const Fused fused = rule.fuse(scaled);
      ASSERT_TRUE(fused) << unit;
      FusedEstimate<4> expected = *plain;
      expected.mean *= unit, expected.covariance *= unit * unit;
      EXPECT_LT(disagreement(*fused, expected), rule.precision) << unit;
    }
  });
}

TEST(FusionRules, LinearChangeOfCoordinatesDoesNotMatter) {
  Matrix4d T;
  T << 1.0, 0.3, 0.0, 0.0, -0.2, 0.8, 0.0, 0.0, 0.1, 0.0, 1e3, 20.0, 0.0, 0.4, 0.0, 1e-3;
  forEveryRule([&T](const Rule& rule, const Sources& sources) {
    if (!rule.any_units) return;
    Sources turned = sources;
    for (Estimate<4>& source : turned) source = {T * source.mean, T * source.covariance * T.transpose()};
    FusedEstimate<4> expected = *rule.fuse(sources);
    expected = {T * expected.mean, T * expected.covariance * T.transpose(), {}};
    EXPECT_LT(disagreement(*rule.fuse(turned), expected), 100.0 * rule.precision);
  });
}

TEST(FusionRules, BarShalomCampoEqualsMaximumLikelihoodOfTwo) {
  Random random(3);
  for (int trial = 0; trial < 100; ++trial) {
    const Sources sources = random.sources(2, 1e-4);
    const MatrixXd joint = jointOf(sources, random.uniform(0.0, 0.9));
    const Fused pair = barShalomCampo<4>(sources[0], sources[1], joint.block<4, 4>(0, 4));
    ASSERT_TRUE(pair);
    EXPECT_LT(disagreement(*pair, *maximumLikelihood(sources, joint)), 1e-8);
  }
}

TEST(FusionRules, MaximumLikelihoodWithoutCorrelationIsWeightedCovariance) {
  Random random(4);
  for (std::size_t n = 1; n < 7; ++n) {
    const Sources sources = random.sources(n);
    EXPECT_LT(disagreement(*maximumLikelihood(sources, jointOf(sources, 0.0)), *weightedCovariance(sources)),
              1e-9);
  }
}

TEST(FusionRules, SingleSourcePassesThrough) {
  forEveryRule([](const Rule& rule, const Sources& sources) {
    if (rule.two_only) return;
    const Fused fused = rule.fuse({sources.front()});
    ASSERT_TRUE(fused);
    EXPECT_LT(disagreement(*fused, {sources.front().mean, sources.front().covariance, {}}), 1e-12);
  });
}

TEST(FusionRules, DeterminantWeightsEqualAnIndependentSearch) {
  Random random(5);
  for (int trial = 0; trial < 30; ++trial) {
    const Sources sources = random.sources(2);
    const auto volume = [&sources](double w) {
      return logDeterminant(covarianceIntersection(sources, Eigen::Vector2d(w, 1.0 - w))->covariance);
    };
    double best = std::numeric_limits<double>::infinity();
    for (int k = 0; k <= 2000; ++k) best = std::min(best, volume(k / 2000.0));
    const Fused fused = covarianceIntersection(sources, IntersectionWeights::determinant);
    EXPECT_LE(logDeterminant(fused->covariance), best + 1e-8);
  }
}

TEST(FusionRules, DeterminantWeightsMeetTheConditionOfOptimalityForManySources) {
  // At the optimum of this convex problem tr(P Y_i) <= 4 for every source.
  Random random(6);
  for (const std::size_t n : {3u, 6u, 12u, 32u}) {
    const Sources sources = random.sources(n, 1e-5);
    const auto weights = intersectionWeights(sources, IntersectionWeights::determinant);
    ASSERT_TRUE(weights);
    EXPECT_NEAR(weights->sum(), 1.0, 1e-12);
    EXPECT_GE(weights->minCoeff(), 0.0);
    const Matrix4d P = covarianceIntersection(sources, *weights)->covariance;
    for (const Estimate<4>& source : sources) {
      EXPECT_LE(Eigen::LLT<Matrix4d>(source.covariance).solve(P).trace(), 4.0 + 1e-6);
    }
  }
}

TEST(FusionRules, DeterminantWeightsGoToTheSourceThatIsBetterInEverything) {
  Sources sources(3);
  sources[0].covariance = 4.0 * Matrix4d::Identity();
  sources[2].covariance = 2.0 * Matrix4d::Identity();
  const auto weights = intersectionWeights(sources, IntersectionWeights::determinant);
  EXPECT_NEAR((*weights)(1), 1.0, 1e-6);
}

TEST(FusionRules, IntersectionCoversTheErrorWhateverTheCorrelation) {
  Random random(7);
  for (int trial = 0; trial < 50; ++trial) {
    const Sources sources = random.sources(3);
    for (const double rho : {0.0, 0.5, 0.95}) {
      for (const auto criterion : {IntersectionWeights::determinant, IntersectionWeights::trace}) {
        const Fused fused = covarianceIntersection(sources, criterion);
        EXPECT_GE(loewnerMargin(actualCovariance(*fused, jointOf(sources, rho)), fused->covariance), -1e-9);
      }
    }
  }
}

// As the inverse is operator convex: (w P_a + (1-w) P_b)^-1 <= w P_a^-1 + (1-w) P_b^-1.
TEST(FusionRules, InverseIntersectionIsTighterThanIntersectionWithTheWeightsExchanged) {
  Random random(8);
  for (int trial = 0; trial < 50; ++trial) {
    const Sources sources = random.sources(2);
    const double w = random.uniform(0.05, 0.95);
    const Fused inverse = inverseCovarianceIntersection<4>(sources[0], sources[1], w);
    const Fused plain = covarianceIntersection(sources, Eigen::Vector2d(1.0 - w, w));
    EXPECT_GE(loewnerMargin(inverse->covariance, plain->covariance), -1e-9);
  }
}

/// Mean of e^T P^-1 e / 4 over draws of the sources' errors from their joint covariance.
double anees(const Rule& rule, const Sources& sources, const MatrixXd& joint, int draws, Random& random) {
  const MatrixXd root = Eigen::LLT<MatrixXd>(joint).matrixL();
  double sum = 0.0;
  for (int draw = 0; draw < draws; ++draw) {
    const Eigen::VectorXd errors = root * random.normals(root.cols());
    Sources drawn = sources;
    for (std::size_t i = 0; i < drawn.size(); ++i)
      drawn[i].mean = errors.segment<4>(4 * static_cast<Eigen::Index>(i));
    const Fused fused = rule.fuse(drawn);
    sum += fused->mean.dot(Eigen::LLT<Matrix4d>(fused->covariance).solve(fused->mean)) / 4.0;
  }
  return sum / draws;
}

// The mean of n normalised squared errors of four components scatters by sqrt(2 / (4 n)) about 1; five times
// that.
constexpr int kDraws = 4000;
const double kBand = 5.0 * std::sqrt(2.0 / (4.0 * kDraws));

TEST(FusionRules, WeightedCovarianceIsConsistentForIndependentSources) {
  Random random(9);
  const Sources sources = random.sources(4, 1e-3);
  EXPECT_NEAR(anees(rules()[0], sources, jointOf(sources, 0.0), kDraws, random), 1.0, kBand);
}

TEST(FusionRules, WeightedCovarianceIsOptimisticForCorrelatedSourcesByWhatTheFormulaSays) {
  Random random(10);
  const Sources sources = random.sources(4, 1e-3);
  const MatrixXd joint = jointOf(sources, 0.4);
  const Fused fused = weightedCovariance(sources);
  const double expected =
      Eigen::LLT<Matrix4d>(fused->covariance).solve(actualCovariance(*fused, joint)).trace() / 4.0;
  EXPECT_GT(expected, 1.3);
  EXPECT_NEAR(anees(rules()[0], sources, joint, kDraws, random), expected, expected * kBand);
}

TEST(FusionRules, MaximumLikelihoodIsConsistentForCorrelatedSources) {
  Random random(12);
  const Sources sources = random.sources(4, 1e-3);
  EXPECT_NEAR(anees(rules()[1], sources, jointOf(sources, 0.4), kDraws, random), 1.0, kBand);
}

TEST(FusionRules, UndeterminedInputGivesNoResult) {
  forEveryRule([](const Rule& rule, const Sources& sources) {
    if (rule.name == "maximum likelihood" || rule.name == "Bar-Shalom and Campo") return;  // see below
    Sources broken = sources;
    broken[1].covariance = Matrix4d::Zero();
    EXPECT_FALSE(rule.fuse(broken)) << "zero covariance";
    broken[1].covariance = sources[1].covariance;
    broken[1].covariance(2, 2) = -1.0;
    EXPECT_FALSE(rule.fuse(broken)) << "negative variance";
    broken[1].covariance(2, 2) = std::nan("");
    EXPECT_FALSE(rule.fuse(broken)) << "covariance not a number";
    broken[1] = sources[1];
    broken[1].covariance(0, 1) = broken[1].covariance(1, 0) =
        1.5 * std::sqrt(broken[1].covariance(0, 0) * broken[1].covariance(1, 1));
    EXPECT_FALSE(rule.fuse(broken)) << "correlation above one";
    broken[1] = sources[1];
    broken[1].mean(0) = std::numeric_limits<double>::infinity();
    EXPECT_FALSE(rule.fuse(broken)) << "infinite mean";
  });
  EXPECT_FALSE(weightedCovariance<4>({}));
}

TEST(FusionRules, ImpossibleCorrelationGivesNoResult) {
  const Sources sources(2);
  MatrixXd joint = MatrixXd::Identity(8, 8);
  joint.topRightCorner<4, 4>() = joint.bottomLeftCorner<4, 4>() = 1.2 * Matrix4d::Identity();
  EXPECT_FALSE(maximumLikelihood(sources, joint));
  EXPECT_FALSE(barShalomCampo<4>(sources[0], sources[1], joint.topRightCorner<4, 4>()));
  EXPECT_THROW(maximumLikelihood(sources, MatrixXd::Identity(4, 4)), std::invalid_argument);
}

TEST(FusionRules, IntersectionNeverMeetsWeightsThatAreNoNumbers) {
  Random random(5);
  for (int trial = 0; trial < 300; ++trial) {
    Sources sources = random.sources(3, 1e-3);
    const double scale = std::pow(10.0, trial - 150.0);
    sources[trial % 3].covariance *= scale;
    for (const auto criterion : {IntersectionWeights::determinant, IntersectionWeights::trace}) {
      const auto weights = intersectionWeights(sources, criterion);
      if (weights) {
        EXPECT_TRUE((weights->array() >= 0.0).all()) << scale;
        EXPECT_NEAR(weights->sum(), 1.0, 1e-9) << scale;
      }
      EXPECT_NO_THROW(covarianceIntersection(sources, criterion)) << scale;
    }
  }
  Sources sources(2);
  sources[0].covariance *= 1e-320;  // whose reciprocal is infinite
  EXPECT_NO_THROW(covarianceIntersection(sources, IntersectionWeights::trace));
  EXPECT_NO_THROW(covarianceIntersection(sources, IntersectionWeights::determinant));
}

TEST(FusionRules, WeightsThatAreNoneAreRefused) {
  const Sources sources(2);
  EXPECT_THROW(covarianceIntersection(sources, Eigen::Vector2d(0.7, 0.7)), std::invalid_argument);
  EXPECT_THROW(covarianceIntersection(sources, Eigen::Vector2d(1.5, -0.5)), std::invalid_argument);
  EXPECT_THROW(covarianceIntersection(sources, Eigen::Vector3d::Constant(1.0 / 3.0)), std::invalid_argument);
  EXPECT_THROW(inverseCovarianceIntersection<4>(sources[0], sources[1], 1.1), std::invalid_argument);
}

}  // namespace
}  // namespace sightline::core
