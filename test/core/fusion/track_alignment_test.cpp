#include "sightline/core/fusion/track_alignment.h"

#include <cmath>
#include <limits>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "sightline/core/model/kinematics.h"

namespace sightline::core {
namespace {

AngularState someState(double sigma = 1e-3) {
  AngularState state;
  state.mean << 0.4, -0.2, 0.05, 0.01;
  Eigen::Matrix4d root;
  root << 1.0, 0.0, 0.0, 0.0, 0.2, 0.8, 0.0, 0.0, 2.0, 0.1, 3.0, 0.0, -0.1, 1.5, 0.3, 2.0;
  state.covariance = sigma * sigma * root * root.transpose();
  return state;
}

/// Covariance of a constant-velocity Kalman filter after 20 s of sightings of `sigma` every `h` seconds.
Eigen::Matrix4d steadyCovariance(double q, double sigma, double h) {
  Motion<4> motion{Eigen::Vector4d::Zero(), Eigen::Matrix4d::Identity()};
  for (double t = 0.0; t < 20.0; t += h) {
    moveOn(motion, h);
    addWhiteAcceleration(motion, q * Eigen::Matrix2d::Identity(), h);
    condition(motion, Eigen::Vector2d::Zero(), sigma * sigma * Eigen::Matrix2d::Identity());
  }
  return motion.covariance;
}

TEST(TrackAlignment, PropagationWithEqualDensitiesIsThatOfTheSphere) {
  const AngularState state = someState();
  for (const double h : {-0.3, 0.0, 0.7}) {
    const AngularState one = propagate(state, h, 0.3e-6),
                       two = propagate(state, h, Eigen::Vector2d(0.3e-6, 0.3e-6));
    EXPECT_TRUE(one.mean.isApprox(two.mean, 1e-14));
    EXPECT_TRUE(one.covariance.isApprox(two.covariance, 1e-12));
  }
}

TEST(TrackAlignment, PropagationInStepsIsPropagationAtOnce) {
  const AngularState state = someState();
  const Eigen::Vector2d q(1e-6, 3e-6);
  AngularState stepped = state;
  for (int k = 0; k < 10; ++k) stepped = propagate(stepped, 0.07, q);
  const AngularState at_once = propagate(state, 0.7, q);
  EXPECT_TRUE(stepped.mean.isApprox(at_once.mean, 1e-13));
  EXPECT_TRUE(stepped.covariance.isApprox(at_once.covariance, 1e-12));
}

TEST(TrackAlignment, CovarianceGrowsWithTheAge) {
  const AngularState state = someState();
  double before = state.covariance.trace();
  for (double h = 0.1; h < 2.0; h += 0.1) {
    const double after = propagate(state, h, Eigen::Vector2d(1e-6, 1e-6)).covariance.trace();
    EXPECT_GT(after, before);
    before = after;
  }
}

TEST(TrackAlignment, ImpliedProcessNoiseIsTheKalmanFiltersOwn) {
  // Exact for dense sightings; for sparse ones the updated covariance is a little off the continuous one.
  for (const double scale : {1e-5, 1e-3, 1.0}) {
    for (const double q : {0.03, 0.3, 3.0}) {
      const Eigen::Vector2d dense =
          impliedProcessNoise(steadyCovariance(q * scale * scale, 0.08 * scale, 0.001));
      EXPECT_NEAR(dense(0) / (q * scale * scale), 1.0, 0.05);
      EXPECT_NEAR(dense(1) / dense(0), 1.0, 1e-9);
      const Eigen::Vector2d sparse =
          impliedProcessNoise(steadyCovariance(q * scale * scale, 0.08 * scale, 0.03));
      EXPECT_GT(sparse(0) / (q * scale * scale), 0.7);
      EXPECT_LT(sparse(0) / (q * scale * scale), 1.5);
    }
  }
}

TEST(TrackAlignment, ImpliedProcessNoiseOfAFittedLineIsThatOfAnEquallyLongMemory) {
  // A line fitted to n sightings over T: P11 = 4 sigma^2/n, P12 = 6 sigma^2/(n T), P22 = 12 sigma^2/(n T^2).
  const double T = 0.6;
  Eigen::Matrix4d P = Eigen::Matrix4d::Zero();
  P.diagonal() << 4.0, 4.0, 12.0 / (T * T), 12.0 / (T * T);
  P(0, 2) = P(2, 0) = P(1, 3) = P(3, 1) = 6.0 / T;
  EXPECT_NEAR(impliedProcessNoise(P)(0), 3.674 * 4.0 / (T * T * T), 0.01);
}

TEST(TrackAlignment, ImpliedProcessNoiseIsBoundedWhereRatesAreNotKnown) {
  Eigen::Matrix4d P = Eigen::Matrix4d::Identity();
  P.topLeftCorner<2, 2>() *= 1e-10;
  EXPECT_EQ(impliedProcessNoise(P), Eigen::Vector2d::Constant(kLargestDensityRatio * 1e-10));
}

TEST(TrackAlignment, GoodStatesAreAccepted) {
  EXPECT_FALSE(rejectionOf(someState(1e-5)));
  EXPECT_FALSE(rejectionOf(someState(0.05)));
  AngularState azimuth_alone = someState();
  azimuth_alone.covariance.diagonal() += Eigen::Vector4d(0.0, 25.0, 0.0, 25.0);
  EXPECT_FALSE(rejectionOf(azimuth_alone));
  AngularState rounded = someState();
  rounded.mean(0) = static_cast<double>(static_cast<float>(2.0 * kPi));
  EXPECT_FALSE(rejectionOf(rounded)) << "beyond 2 pi by rounding alone";
}

TEST(TrackAlignment, StatesThatHaveDivergedAreRefused) {
  const auto reasonAfter = [](auto spoil) {
    AngularState state = someState();
    spoil(state);
    const auto refusal = rejectionOf(state);
    EXPECT_EQ(refusal.value_or(Refusal{}).kind, "invalid");
    return refusal.value_or(Refusal{}).detail;
  };
  for (const double rate : {2e4, 1e8, 1e50, 1e300}) {
    EXPECT_NE(reasonAfter([rate](AngularState& s) { s.mean(3) = -rate; }).find("rate "), std::string::npos);
  }
  EXPECT_NE(reasonAfter([](AngularState& s) {
              s.covariance.row(1) *= 1e7;
              s.covariance.col(1) *= 1e7;
            }).find("above 1000 rad"),
            std::string::npos);
  EXPECT_NE(reasonAfter([](AngularState& s) {
              s.covariance.row(2) *= 1e12;
              s.covariance.col(2) *= 1e12;
            }).find("sigma of the rate"),
            std::string::npos);
  for (const double factor : {1e50, 1e100, 1e290})
    EXPECT_NE(reasonAfter([factor](AngularState& s) { s.covariance *= factor; }), "");
}

TEST(TrackAlignment, LargestPositionSigmaIsMeasuredOnTheSphere) {
  AngularState state;
  state.mean << 0.0, 1.5, 0.0, 0.0;
  state.covariance = Eigen::Vector4d(4.0, 0.01, 1.0, 1.0).asDiagonal();
  EXPECT_NEAR(largestPositionSigma(state), std::max(2.0 * std::cos(1.5), 0.1), 1e-12);
}

TEST(TrackAlignment, EveryBadStateIsRefusedWithItsReason) {
  const auto reasonAfter = [](auto spoil) {
    AngularState state = someState();
    spoil(state);
    return rejectionOf(state).value_or(Refusal{}).detail;
  };
  const double nan = std::nan("");
  EXPECT_NE(reasonAfter([nan](AngularState& s) { s.mean(2) = nan; }).find("not finite"), std::string::npos);
  EXPECT_NE(reasonAfter([nan](AngularState& s) { s.covariance(3, 1) = nan; }).find("not finite"),
            std::string::npos);
  EXPECT_NE(reasonAfter([](AngularState& s) { s.covariance.setZero(); }).find("truth"), std::string::npos);
  EXPECT_NE(reasonAfter([](AngularState& s) { s.covariance(1, 1) = -1.0; }).find("positive definite"),
            std::string::npos);
  EXPECT_NE(reasonAfter([](AngularState& s) { s.covariance(0, 1) *= 1.5; }).find("symmetric"),
            std::string::npos);
  EXPECT_NE(reasonAfter([](AngularState& s) {
              s.covariance(0, 1) = s.covariance(1, 0) =
                  2.0 * std::sqrt(s.covariance(0, 0) * s.covariance(1, 1));
            }).find("correlations"),
            std::string::npos);
  EXPECT_NE(reasonAfter([](AngularState& s) { s.mean(1) = 85.0; }).find("degrees"), std::string::npos);
  EXPECT_NE(reasonAfter([](AngularState& s) { s.covariance *= 1e8; }).find("above pi/2"), std::string::npos);
}

}  // namespace
}  // namespace sightline::core
