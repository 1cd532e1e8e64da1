#include "sightline/core/estimators/rate_prior.h"

#include <cmath>

#include <gtest/gtest.h>

#include "sightline/core/model/sphere.h"

namespace sightline::core {
namespace {

constexpr double kSigma = 1e-3;  // of a sighting [rad]

Eigen::Matrix2d both() {
  return 2.0 * kSigma * kSigma * Eigen::Matrix2d::Identity();
}

double densityAt(double distance, double h) {
  return std::exp(rate_prior::logDensityOfOffset({distance, 0.0}, both(), h));
}

TEST(RatePrior, TheDensityOfTheOffsetIsOneOverThePlane) {
  for (const double h : {0.001, 0.03, 1.0}) {
    double sum = 0.0;
    const double growth = 1.01;
    for (double r = 1e-6; r < 20.0; r *= growth) {
      const double middle = r * std::sqrt(growth);
      sum += densityAt(middle, h) * kPi * r * r * (growth * growth - 1.0);
    }
    EXPECT_NEAR(sum, 1.0, 1e-3) << h;
  }
}

TEST(RatePrior, TheDensityOfTheRatesIsThatOfTheOffsetAfterOneSecond) {
  for (const double rate : {0.0, 1e-3, 0.1}) {
    EXPECT_NEAR(rate_prior::logDensityOfRates({rate, 0.0}, both()),
                rate_prior::logDensityOfOffset({rate, 0.0}, both(), 1.0), 0.1);
  }
}

TEST(RatePrior, FallsWithTheSquareOfTheDistanceSoThatNoRateIsImpossible) {
  for (double distance = 0.03; distance < 0.3; distance *= 1.5) {
    // one over 2 pi and the logarithms from 0.3 times the noise to 30 rad/s
    const double share = densityAt(distance, 0.1) * distance * distance;
    const double expected = 1.0 / (2.0 * kPi * std::log(30.0 * 0.1 / (0.3 * std::sqrt(2.0) * kSigma)));
    EXPECT_NEAR(share, expected, 0.15 * expected) << distance;
  }
}

TEST(RatePrior, BeyondItsReachTheDensityIsLess) {
  for (const double h : {0.001, 0.1, 10.0, 600.0}) {
    for (const double log_density : {-3.0, 0.0, 5.0, 10.0}) {
      const double reach = rate_prior::reach(log_density, both() / 2.0, both().trace(), h);
      for (double r = std::max(reach, 1e-5); r < 3.0; r *= 1.1)
        EXPECT_LT(rate_prior::logDensityOfOffset({0.6 * r, 0.8 * r}, both(), h), log_density + 1e-9);
    }
  }
  EXPECT_EQ(rate_prior::reach(1e3, both(), 0.0, 1.0), 0.0);
}

TEST(RatePrior, AfterTwoSightingsTheSigmaIsThatOfTheRateSeenOrOfWhatTheNoiseHides) {
  for (const double rate : {0.3, 1.0, 10.0}) {  // from ten times the noise on
    const double h = 1.0 / 30.0;
    EXPECT_NEAR(rate_prior::sigma({rate * h, 0.0}, both(), h), rate / std::sqrt(2.0), 0.3 * rate) << rate;
  }
  for (const double h : {0.1, 10.0, 600.0}) {
    const double hidden = std::sqrt(2.0) * kSigma / h;
    const double sigma = rate_prior::sigma({0.3 * kSigma, 0.0}, both(), h);
    EXPECT_LT(sigma, hidden) << h;
    EXPECT_GT(sigma, 0.1 * hidden) << h;
  }
}

TEST(InitialRate, IsOpenUntilTwoInstantsAreSeenAndAGivenOneStaysAsItIs) {
  InitialRate unknown(0.0), given(0.3);
  EXPECT_TRUE(unknown.isOpen());
  EXPECT_FALSE(given.isOpen());
  EXPECT_DOUBLE_EQ(given.sigma(), 0.3);
  unknown.learn({0.0, 0.0}, both(), 0.0);
  EXPECT_TRUE(unknown.isOpen()) << "one instant tells no rate";
  unknown.learn({0.1, 0.0}, both(), 0.1);
  given.learn({0.1, 0.0}, both(), 0.1);
  EXPECT_FALSE(unknown.isOpen());
  EXPECT_NEAR(unknown.sigma(), 0.7, 0.2);
  EXPECT_DOUBLE_EQ(given.sigma(), 0.3);
}

TEST(InitialRate, ATargetSeenOnceIsOnTheSphereAndNoFarther) {
  const InitialRate unknown(0.0);
  for (const double h : {0.0, 0.01, 1.0, 3600.0}) {
    const AngularState state = unknown.stateAfter(h, {0.2, 0.1}, both());
    EXPECT_EQ(state.angles(), Eigen::Vector2d(0.2, 0.1));
    EXPECT_LE(state.anglesCovariance().diagonal().maxCoeff(), 1.0 + 2.0 * both()(0, 0));
    EXPECT_EQ(Eigen::LLT<Eigen::Matrix4d>(state.covariance).info(), Eigen::Success) << h;
  }
}

}  // namespace
}  // namespace sightline::core
