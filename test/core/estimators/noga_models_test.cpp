#include "sightline/core/estimators/noga_models.h"

#include <cmath>
#include <limits>
#include <stdexcept>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "support/covariances.h"

namespace sightline::core {
namespace {

using Kind = ResponseModel::Kind;

ResponseBelief someBelief() {
  ResponseBelief belief;
  for (int channel = 0; channel < 2; ++channel) {
    belief.mean[channel] << 0.1, 0.2 - 0.3 * channel, 0.05, 2.0;
    belief.covariance[channel].diagonal() << 1e-4, 1e-3, 1e-2, 0.5;
  }
  return belief;
}

const Eigen::Vector2d kUnits{1.0, 1.0};

TEST(NogaModels, StraightFlightMovesThePositionByTheRate) {
  ResponseBelief belief = someBelief();
  step(belief, {Kind::straight, 0.0}, kUnits, 0.5, false);
  for (int channel = 0; channel < 2; ++channel) {
    const Eigen::Vector4d before = someBelief().mean[channel];
    EXPECT_NEAR(belief.mean[channel](0), before(0) + 0.5 * before(1), 1e-15);
    EXPECT_NEAR(belief.mean[channel](1), before(1), 1e-15);
    EXPECT_NEAR(belief.covariance[channel](0, 0), 1e-4 + 0.25 * 1e-3, 1e-15);
  }
}

TEST(NogaModels, ProcessNoiseGrowsWithTheSquareOfTheUnit) {
  for (const Kind kind : {Kind::straight, Kind::fixed_harmonic, Kind::fading}) {
    ResponseBelief calm, one, ten;  // certain of all but what the model adds
    step(calm, {kind, 0.0}, {1.0, 10.0}, 0.3, false);
    step(one, {kind, 0.7}, {1.0, 10.0}, 0.3, false);
    const double added = one.covariance[0](0, 0) - calm.covariance[0](0, 0);
    ASSERT_GT(added, 0.0);
    EXPECT_NEAR((one.covariance[1](0, 0) - calm.covariance[1](0, 0)) / added, 100.0, 1e-9);
  }
}

TEST(NogaModels, AFixedHarmonicOfZeroRateAndAccelerationStaysWhereItIs) {
  ResponseBelief belief = someBelief();
  for (Eigen::Vector4d& mean : belief.mean) mean << 0.4, 0.0, 0.0, 8.0;
  step(belief, {Kind::fixed_harmonic, 1.0, 0.0, 8.0}, kUnits, 2.0, false);
  EXPECT_NEAR(belief.mean[0](0), 0.4, 1e-14);
  EXPECT_NEAR(belief.mean[0](3), 8.0, 1e-14) << "it hands its kappa to the others";
}

TEST(NogaModels, EveryDefaultModelKeepsCovariancesPositiveForwardAndBackInTime) {
  for (const ResponseModel& model : defaultResponseModels()) {
    for (const double h : {-0.2, 0.0, 1e-3, 0.03, 1.0, 30.0}) {
      ResponseBelief belief = someBelief();
      belief.cross.setConstant(1e-7);
      step(belief, model, {0.01, 0.02}, h, true);
      for (const Eigen::Matrix4d& P : belief.covariance) {
        EXPECT_TRUE(P.isApprox(P.transpose(), 1e-12));
        EXPECT_GE(test::leastEigenvalue(P), -1e-12 * P.trace()) << "h = " << h << ", q = " << model.q;
      }
      EXPECT_TRUE(belief.cross.allFinite());
    }
  }
}

TEST(NogaModels, ATurnMovesPositionAndRatesAsOfAnyMotionAndLeavesKappa) {
  ResponseBelief belief = someBelief();
  belief.cross(0, 1) = 2e-5;
  const Eigen::Matrix3d R = Eigen::AngleAxisd(0.4, Eigen::Vector3d(1.0, 2.0, -1.0).normalized()).matrix();
  const Motion<4> expected = rotateMotion(motionOf(belief), R);
  turn(belief, R);
  const Motion<4> found = motionOf(belief);
  EXPECT_TRUE(found.mean.isApprox(expected.mean, 1e-12));
  EXPECT_TRUE(found.covariance.isApprox(expected.covariance, 1e-6));  // J by differences
  for (int channel = 0; channel < 2; ++channel)
    EXPECT_EQ(belief.mean[channel](3), someBelief().mean[channel](3));
}

TEST(NogaModels, ModelsThatCannotWorkAreRefused) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NO_THROW(check(ResponseModel{}));
  EXPECT_THROW(check({Kind::straight, -1.0}), std::invalid_argument);
  EXPECT_THROW(check({Kind::straight, nan}), std::invalid_argument);
  EXPECT_THROW(check({Kind::harmonic, 1.0, -1.0}), std::invalid_argument);
  EXPECT_THROW(check({Kind::fixed_harmonic, 1.0, 0.0, nan}), std::invalid_argument);
  EXPECT_THROW(check({Kind::fading, 1.0, 0.0, 0.0, 0.0}), std::invalid_argument);
  EXPECT_THROW(check({Kind::fading, 1.0, 0.0, 0.0, 1.0, 0.0}), std::invalid_argument);
}

}  // namespace
}  // namespace sightline::core
