// What the accuracy tables stand on: targets, bounds and baselines against known answers and the reference
// figures of an independent implementation (E2, E3).

#include "monte_carlo.h"

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "bounds.h"
#include "tables.h"

namespace sightline::bench {
namespace {

Options fewRuns(int runs, int threads) {
  Options options;
  options.runs = runs;
  options.threads = threads;
  return options;
}

double meanRootBound(const char* scenario, double sigma, const Span& span, int runs = 60) {
  double sum = 0.0;
  for (int run = 0; run < runs; ++run)
    sum += sinusoidBound(simulate(scenarioOf(scenario), {{sigma}}, run), span);
  return std::sqrt(sum / runs) / sigma;
}

std::vector<Scenario> allScenarios() {
  std::vector<Scenario> all = namedScenarios();
  all.insert(all.end(), unseenScenarios().begin(), unseenScenarios().end());
  return all;
}

TEST(Scenarios, RatesAreTheDerivativesOfThePositions) {
  for (const Scenario& scenario : allScenarios()) {
    core::RandomStream random(1);
    const Trajectory path = scenario.motion(random);
    ASSERT_EQ(path.size(), static_cast<std::size_t>(kTicks)) << scenario.name;
    for (std::size_t k = 1; k < path.size();
         ++k) {  // trapezoid; white acceleration of 0.3 moves 1e-3 in a tick
      const Eigen::Vector2d step = path[k].head<2>() - path[k - 1].head<2>();
      const Eigen::Vector2d by_rates = 0.005 * (path[k].tail<2>() + path[k - 1].tail<2>());
      EXPECT_LT((step - by_rates).norm(), scenario.white_acceleration > 0.0 ? 1e-3 : 1e-4)
          << scenario.name << " at tick " << k;
    }
  }
}

TEST(Scenarios, WeaveEndsWhereItsAccelerationsTakeIt) {
  core::RandomStream random(1);
  const Eigen::Vector4d end = scenarioOf("weave").motion(random).back();
  const double azimuth_rate = 0.3 + 2.0 / 2.5 * (1.0 - std::cos(7.5)) + 1.5 * 2.0;
  const double elevation_rate = -0.2 + 1.2 * 2.0 - 2.5 / 4.0 * (1.0 - std::cos(12.0));
  EXPECT_NEAR(end(2), azimuth_rate, 1e-9);
  EXPECT_NEAR(end(3), elevation_rate, 1e-9);
}

TEST(Scenarios, TruthIsTheSameForEverySensorSetAndScalesWithIt) {
  for (const Scenario& scenario : allScenarios()) {
    Sensors small{{0.15}, 1e-3};
    const Stream one = simulate(scenario, {{0.08}}, 3), other = simulate(scenario, small, 3);
    ASSERT_EQ(one.size(), other.size());
    for (std::size_t k = 0; k < one.size(); ++k)
      EXPECT_LT((1e-3 * one[k].truth - other[k].truth).norm(), 1e-15) << scenario.name;
  }
}

TEST(Scenarios, DropoutAndOutliersAreWhereTheyBelong) {
  int outliers = 0, sightings = 0;
  for (int run = 0; run < 200; ++run) {
    for (const Instant& instant : simulate(scenarioOf("dropout"), {{0.08}}, run))
      EXPECT_EQ(instant.seen, instant.tick < 400 || instant.tick >= 500);
    const Stream stream = simulate(scenarioOf("outlier"), {{0.08}}, run);
    for (std::size_t k = 0; k < stream.size(); ++k) {
      outliers += stream[k].outlier;
      if (k < 3) {
        EXPECT_FALSE(stream[k].outlier);
      }
    }
    sightings += static_cast<int>(stream.size()) - 3;
  }
  const double share = static_cast<double>(outliers) / sightings;
  EXPECT_NEAR(share, 0.05, 4.0 * std::sqrt(0.05 * 0.95 / sightings));
}

TEST(Bounds, LineIsTheClosedFormOfRegularSightings) {
  Stream stream;
  for (int k = 0; k < 12; ++k) {
    Instant instant;
    instant.tick = 10 * k;
    instant.measurement.covariance = 0.04 * Eigen::Matrix2d::Identity();
    stream.push_back(instant);
  }
  EXPECT_NEAR(lineBound(stream), 0.04 * 2.0 * (2.0 * 12 - 1.0) / (12.0 * 13.0), 1e-12);  // at the last one
}

TEST(Bounds, SinusoidAgreesWithTheReferencesBlocks) {
  EXPECT_NEAR(meanRootBound("sin", 0.08, {100, 200}), 0.526, 0.02);
  EXPECT_NEAR(meanRootBound("sin", 0.08, {300, 500}), 0.329, 0.01);
  EXPECT_NEAR(meanRootBound("sin", 0.08, {700, 1000}), 0.157, 0.005);
}

TEST(Bounds, WhiteAccelerationAgreesWithTheReference) {
  const struct {
    const char* scenario;
    double q, sigma, reference;
  } cases[] = {{"ncv0.3", 0.3, 0.08, 0.483},
               {"ncv0.3", 0.3, 0.15, 0.421},
               {"ncv0.03", 0.03, 0.08, 0.373},
               {"ncv0.03", 0.03, 0.15, 0.3225}};
  for (const auto& each : cases) {
    double sum = 0.0;
    for (int run = 0; run < 60; ++run)
      sum += whiteAccelerationBound(simulate(scenarioOf(each.scenario), {{each.sigma}}, run), each.q, 1.0);
    EXPECT_NEAR(std::sqrt(sum / 60.0) / each.sigma, each.reference, 0.003) << each.scenario;
  }
}

TEST(Baselines, AgreeWithTheReference) {
  const struct {
    const char *scenario, *name;
    double reference;  // RMSE / sigma at 8 %, E2 and E3, 100 runs
  } cases[] = {{"sin", "KF CA 0.6", 0.441},          {"sin", "IMM CV.01+CV.8 t3", 0.495},
               {"sin", "IMM CV.01+CA1 t3", 0.458},   {"sin", "IMM CA.3+CA1 t3", 0.443},
               {"weave", "KF CV 0.5", 0.505},        {"weave", "IMM CV.01+CV.8 t10", 0.497},
               {"weave", "IMM CV.01+CA1 t3", 0.550}, {"line", "KF CV 0.001", 0.229},
               {"line", "IMM CV.01+CA3 t10", 0.296}, {"ncv0.3", "KF CV 0.3", 0.477}};
  for (const auto& each : cases) {
    for (const auto& list : {kalmanFilters(1.0, 0.0), imms(1.0, 0.0)}) {
      for (const Contender& contender : list) {
        if (contender.name != each.name) continue;
        const Sample squares =
            evaluate(scenarioOf(each.scenario), {{0.08}}, {contender}, fewRuns(100, 2)).front().estimate;
        const double error = squares.rootBand() / 1.96 / 0.08;  // the reference's is as large
        EXPECT_NEAR(squares.root() / 0.08, each.reference, 3.5 * std::sqrt(2.0) * error + 0.0005)
            << each.scenario << ", " << each.name;
      }
    }
  }
}

TEST(Baselines, FilterThatKnowsTheTruthIsConsistentAndReachesTheBound) {
  BaselineParams params;
  params.models = {{BaselineModel::Kind::velocity, 0.3}};
  const Contender contender{"", [params] { return std::make_unique<BaselineEstimator>(params); },
                            std::numeric_limits<double>::infinity()};
  const Score score = evaluate(scenarioOf("ncv0.3"), {{0.08}}, {contender}, fewRuns(100, 2)).front();
  EXPECT_NEAR(score.nees_position.mean(), 1.0, 2.0 * score.nees_position.band());
  EXPECT_NEAR(score.nees_state.mean(), 1.0, 2.0 * score.nees_state.band());
  EXPECT_NEAR(score.estimate.root() / 0.08, 0.483, 2.0 * score.estimate.rootBand() / 0.08);
}

TEST(Evaluation, FiguresDoNotDependOnTheNumberOfThreads) {
  const std::vector<Contender> contenders = ours(kTrackerGate);
  const auto alone = evaluate(scenarioOf("outlier"), sixSensors(), contenders, fewRuns(5, 1));
  const auto together = evaluate(scenarioOf("outlier"), sixSensors(), contenders, fewRuns(5, 3));
  for (std::size_t k = 0; k < alone.size(); ++k) {
    EXPECT_EQ(alone[k].estimate.values(), together[k].estimate.values());
    EXPECT_EQ(alone[k].nees_state.values(), together[k].nees_state.values());
    EXPECT_EQ(alone[k].position_at, together[k].position_at);
  }
}

TEST(Evaluation, RatioOfAScoreToItselfIsOneWithoutABand) {
  const Sample sample(std::vector<double>{1.0, 4.0, 2.0});
  const Ratio ratio = rootRatio(sample, sample);
  EXPECT_DOUBLE_EQ(ratio.value, 1.0);
  EXPECT_DOUBLE_EQ(ratio.log_band, 0.0);
  const Ratio twice = rootRatio(Sample(std::vector<double>{4.0, 16.0, 8.0}), sample);
  EXPECT_DOUBLE_EQ(twice.value, 2.0);
  EXPECT_NEAR(twice.log_band, 0.0, 1e-12);  // run by run the same factor
  EXPECT_DOUBLE_EQ(geometricMean({{2.0, 0.1}, {0.5, 0.1}}).value, 1.0);
}

}  // namespace
}  // namespace sightline::bench
