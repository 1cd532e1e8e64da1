#include "sightline/core/smoothing/bank_smoothing.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "support/simulated.h"

namespace sightline::core {
namespace {

struct ForwardRun {
  NogaConsistentEstimator estimator{NogaConsistentParams()};
  std::vector<BankStep> steps;
};

ForwardRun run(double sigma, double stated, unsigned seed) {
  ForwardRun run;
  for (Measurement sighting : test::sightingsOf(test::sinusoid, sigma, seed, 6.0)) {
    sighting.covariance = stated * stated * Eigen::Matrix2d::Identity();
    if (auto step = run.estimator.updateWithStep(sighting)) run.steps.push_back(std::move(*step));
  }
  return run;
}

TEST(BankSmoothing, ProbabilitiesSumToOneAndCovariancesStayPositive) {
  const ForwardRun forward = run(0.08, 0.08, 1);
  const auto models = NogaConsistentParams().models;
  SmoothedBank smoothed = nothingLater(forward.estimator);
  for (std::size_t k = forward.steps.size(); k-- > 0;) {
    smoothed = smoothedBack(forward.steps[k], models, smoothed);
    EXPECT_NEAR(smoothed.weights.sum(), 1.0, 1e-12);
    EXPECT_GE(smoothed.weights.minCoeff(), 0.0);
    EXPECT_EQ(Eigen::LLT<Eigen::Matrix4d>(motionOf(smoothed).covariance).info(), Eigen::Success) << k;
  }
}

// The evidence of the harmonic models comes late; the smoother knows from the start.
TEST(BankSmoothing, KnowsTheModelBeforeTheFilterDoes) {
  const auto models = NogaConsistentParams().models;
  const auto harmonic =
      std::find_if(models.begin(), models.end(),
                   [](const ResponseModel& model) { return model.kind == ResponseModel::Kind::harmonic; }) -
      models.begin();
  const std::size_t early = 30;
  constexpr unsigned kRuns = 20;
  double by_filter = 0.0, by_smoother = 0.0;
  for (unsigned seed = 1; seed <= kRuns; ++seed) {
    const ForwardRun forward = run(0.08, 0.08, seed);
    SmoothedBank smoothed = nothingLater(forward.estimator);
    for (std::size_t k = forward.steps.size(); k-- > early;)
      smoothed = smoothedBack(forward.steps[k], models, smoothed);
    by_smoother += smoothed.weights(harmonic) / kRuns;
    by_filter += forward.steps[early].chain.probabilities()(harmonic) / kRuns;
  }
  EXPECT_GT(by_smoother, 0.8);
  EXPECT_LT(by_filter, 0.4);
}

TEST(BankSmoothing, FindsTheNoiseThatIsHalfOfWhatIsStatedByLaterSightingsToo) {
  const ForwardRun forward = run(0.04, 0.08, 3);
  const auto models = NogaConsistentParams().models;
  SmoothedBank smoothed = nothingLater(forward.estimator);
  for (std::size_t k = forward.steps.size(); k-- > 6;)
    smoothed = smoothedBack(forward.steps[k], models, smoothed);
  EXPECT_NEAR(noiseOf(smoothed)(0), 0.25, 0.15);  // after six sightings the filter still believes more
  EXPECT_GT(forward.steps[6].from.noise(forward.steps[6].chain.probabilities())(0), noiseOf(smoothed)(0));
}

TEST(BankSmoothing, ThePartsOfAStepLeadToTheSameAsTheWhole) {
  const ForwardRun forward = run(0.08, 0.08, 4);
  const auto models = NogaConsistentParams().models;
  const BankStep& step = forward.steps.back();
  const BankStep rest = remainderOf(step, models, 1e-9);
  const SmoothedBank later = nothingLater(forward.estimator);
  const AngularState whole = motionOf(smoothedBack(step, models, later)),
                     part = motionOf(smoothedBack(rest, models, later));
  EXPECT_TRUE(whole.mean.isApprox(part.mean, 1e-6));
  EXPECT_TRUE(whole.covariance.isApprox(part.covariance, 1e-3));
}

}  // namespace
}  // namespace sightline::core
