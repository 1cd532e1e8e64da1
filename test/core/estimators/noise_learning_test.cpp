#include "sightline/core/estimators/noise_learning.h"

#include <cmath>
#include <optional>
#include <random>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "sightline/core/estimators/noga_consistent.h"
#include "sightline/core/estimators/twbls_consistent.h"

#include "support/simulated.h"

namespace sightline::core {
namespace {

TEST(NoiseLearning, DensityIsStudentsT) {
  // With the scale integrated out over an inverse gamma distribution of shape a and mean 1 = b / a, one
  // channel's innovation has a t density of 2 a degrees of freedom; its constant is left out, as it is common
  // to all models, and is that of the normal density.
  NoiseLearningParams params;
  params.trust = 8.0;
  NoiseLearning learning(params);
  const double a = 4.0, d2 = 3.0, log_S = -1.5;
  const double expected = -0.5 * (log_S + std::log(2.0 * M_PI)) - (a + 0.5) * std::log1p(d2 / (2.0 * a));
  EXPECT_NEAR(learning.logDensity(d2, log_S), expected, 1e-14);
}

TEST(NoiseLearning, CountsFromTheFourthInnovationOnAndWeighsEachByWhatWasKnownBeforeIt) {
  NoiseLearningParams params;
  params.trust = 8.0;
  params.memory = 1e9;
  NoiseLearning learning(params);
  const double d2 = 3.0;
  const auto densityBy = [&](double a) {
    return -0.5 * std::log(2.0 * M_PI) - (a + 0.5) * std::log1p(d2 / (2.0 * a));
  };
  for (int innovation = 1; innovation <= 3; ++innovation) {
    learning.next(0.03);
    EXPECT_FALSE(learning.isLearning()) << innovation;
    EXPECT_EQ(learning.learnt(1.0, d2), 1.0) << innovation;
    EXPECT_NEAR(learning.logDensity(d2, 0.0), densityBy(4.0), 1e-9) << innovation;
  }
  for (const double a : {4.0, 4.5, 5.0}) {
    learning.next(0.03);
    EXPECT_NEAR(learning.logDensity(d2, 0.0), densityBy(a), 1e-9);
    EXPECT_NEAR(learning.learnt(1.0, d2), (a + 0.5 * d2) / (a + 0.5), 1e-9);
  }
}

TEST(NoiseLearning, IsTheNormalDensityWhereNothingIsLearnt) {
  NoiseLearningParams params;
  params.enabled = false;
  NoiseLearning learning(params);
  for (int i = 0; i < 10; ++i) learning.next(0.03);
  EXPECT_NEAR(learning.logDensity(3.0, -1.5), -0.5 * (3.0 - 1.5 + std::log(2.0 * M_PI)), 1e-14);
  EXPECT_EQ(learning.learnt(1.0, 25.0), 1.0);
}

TEST(NoiseLearning, FindsTheMeanSquareOfTheInnovations) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal(0.0, 0.2);  // variance 0.04 of the stated one
  NoiseLearningParams params;
  params.memory = 30.0;
  NoiseLearning learning(params);
  double scale = 1.0;
  for (int i = 0; i < 3000; ++i) {
    learning.next(0.03);
    const double innovation = normal(random);
    scale = learning.learnt(scale, innovation * innovation / scale);
  }
  EXPECT_NEAR(scale, 0.04, 3.0 * 0.04 * std::sqrt(2.0 / 1000.0));  // a thousand sightings count
}

TEST(NoiseLearning, StaysWithinItsBounds) {
  NoiseLearning learning(NoiseLearningParams{});
  double still = 1.0, wild = 1.0;
  for (int i = 0; i < 1000; ++i) {
    learning.next(0.03);
    still = learning.learnt(still, 0.0);
    wild = learning.learnt(wild, 1e6);
  }
  EXPECT_EQ(still, NoiseLearningParams{}.min_scale);
  EXPECT_EQ(wild, NoiseLearningParams{}.max_scale);
}

TEST(NoiseLearning, RefusesParametersOutOfRange) {
  const auto with = [](auto change) {
    NoiseLearningParams params;
    change(params);
    return NoiseLearning(params);
  };
  EXPECT_THROW(with([](auto& p) { p.memory = 0.0; }), std::invalid_argument);
  EXPECT_THROW(with([](auto& p) { p.trust = 0.0; }), std::invalid_argument);
  EXPECT_THROW(with([](auto& p) { p.min_scale = 2.0; }), std::invalid_argument);
  EXPECT_THROW(with([](auto& p) { p.max_scale = NAN; }), std::invalid_argument);
}

/// Root mean square error over the true sigma, ANEES and the noise found, over t > 4 s, of sightings whose
/// stated sigma is `misstated` times the true one of 8 %.
struct Misstated {
  double rmse = 0.0, anees = 0.0, found = 0.0;
};

template <typename Make>
Misstated track(const Make& make, double misstated) {
  constexpr double kSigma = 0.08;
  constexpr unsigned kRuns = 40;
  Misstated sums;
  double count = 0.0;
  for (unsigned seed = 0; seed < kRuns; ++seed) {
    auto estimator = make();
    for (Measurement sighting : test::sightingsOf(test::sinusoid, kSigma, seed)) {
      sighting.covariance *= misstated * misstated;
      estimator.update(sighting);
      const double t = test::timeOf(sighting);
      if (t <= 4.0) continue;
      const AngularState state = *estimator.stateAt(sighting.time);
      for (int channel = 0; channel < 2; ++channel) {
        const double error = state.mean(channel) - test::sinusoid(t)(channel);
        sums.rmse += error * error;
        sums.anees += error * error / state.covariance(channel, channel);
        sums.found += estimator.noiseScale()(channel);
        ++count;
      }
    }
  }
  return {std::sqrt(sums.rmse / count) / kSigma, sums.anees / count, sums.found / count};
}

/// What the stated variance, of which nothing is known at first, leaves in the mean noise found over t > 4 s
/// where innovations are as expected, in true variances.
double leftOfTheStated(double misstated) {
  const double truth = 1.0 / (misstated * misstated);
  NoiseLearning learning{NoiseLearningParams{}};
  double scale = 1.0, sum = 0.0, count = 0.0;
  std::optional<double> last;
  for (const Measurement& sighting : test::sightingsOf(test::sinusoid, 0.08, 1)) {
    const double t = test::timeOf(sighting);
    if (last) {
      learning.next(t - *last);
      scale = learning.learnt(scale, truth / scale);
    }
    last = t;
    if (t <= 4.0) continue;
    sum += scale / truth;
    ++count;
  }
  return sum / count - 1.0;
}

/// `make` takes the parameters of the learning.
template <typename Make>
void expectIndifferentToTheStatedSigma(const Make& make) {
  NoiseLearningParams credulous;
  credulous.enabled = false;
  const auto learning = [&] { return make(NoiseLearningParams{}); };
  const Misstated honest = track(learning, 1.0);
  EXPECT_NEAR(honest.found, 1.0, 0.1);
  EXPECT_NEAR(honest.rmse / track([&] { return make(credulous); }, 1.0).rmse, 1.0, 0.02);
  for (const double misstated : {0.5, 3.0, 10.0}) {
    const Misstated found = track(learning, misstated),
                    believed = track([&] { return make(credulous); }, misstated);
    EXPECT_NEAR(found.rmse / honest.rmse, 1.0, 0.1) << misstated;
    EXPECT_NEAR(found.found * misstated * misstated, honest.found + leftOfTheStated(misstated), 0.1)
        << misstated;
    EXPECT_NEAR(found.anees / honest.anees, 1.0, 0.15) << misstated;
    EXPECT_GT(std::abs(std::log(believed.anees)), 2.0 * std::abs(std::log(found.anees))) << misstated;
  }
}

TEST(NoiseLearning, MakesNogaIndifferentToTheStatedSigma) {
  expectIndifferentToTheStatedSigma([](const NoiseLearningParams& noise) {
    NogaConsistentParams params;
    params.noise = noise;
    return NogaConsistentEstimator(params);
  });
}

TEST(NoiseLearning, MakesTwblsIndifferentToTheStatedSigma) {
  expectIndifferentToTheStatedSigma([](const NoiseLearningParams& noise) {
    TwblsConsistentParams params;
    params.noise = noise;
    return TwblsConsistentEstimator(params);
  });
}

TEST(NoiseLearning, TellsTheChannelsApart) {
  // Elevation four times as calm as stated, azimuth as stated.
  Eigen::Matrix2d truth = Eigen::Vector2d(0.0064, 0.0004).asDiagonal();
  NogaConsistentEstimator estimator{NogaConsistentParams{}};
  for (Measurement sighting : test::sightingsOf(test::straight, truth, 3)) {
    sighting.covariance = 0.0064 * Eigen::Matrix2d::Identity();
    estimator.update(sighting);
  }
  EXPECT_NEAR(estimator.noiseScale()(0), 1.0, 0.5);
  EXPECT_NEAR(estimator.noiseScale()(1), 1.0 / 16.0, 0.03);
}

}  // namespace
}  // namespace sightline::core
