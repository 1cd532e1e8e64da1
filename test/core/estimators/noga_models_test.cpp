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

TEST(NogaModels, StraightFlightMovesThePositionByTheRate) {
  const Transition step = transitionOf({Kind::straight, 0.0}, Eigen::Vector4d::Zero(), 0.5);
  const Eigen::Vector4d after = step.F * Eigen::Vector4d(0.1, 0.2, 0.05, 2.0);
  EXPECT_TRUE(after.isApprox(Eigen::Vector4d(0.2, 0.2, 0.0, 0.0), 1e-15)) << "it knows no more than the rate";
  EXPECT_TRUE((step.Q.topLeftCorner<2, 2>().isZero()));
}

TEST(NogaModels, AFixedHarmonicOfZeroRateAndAccelerationStaysWhereItIs) {
  const Transition step =
      transitionOf({Kind::fixed_harmonic, 1.0, 0.0, 8.0}, Eigen::Vector4d(0.4, 0.0, 0.0, 3.0), 2.0);
  EXPECT_NEAR((step.F * Eigen::Vector4d(0.4, 0.0, 0.0, 3.0))(0), 0.4, 1e-14);
  EXPECT_NEAR(step.mean(3), 8.0, 1e-14) << "it hands its kappa to the others";
}

TEST(NogaModels, ProcessNoiseIsInProportionToTheDensity) {
  for (const Kind kind : {Kind::straight, Kind::harmonic, Kind::fixed_harmonic, Kind::fading}) {
    const Transition one = transitionOf({kind, 1.0}, Eigen::Vector4d::Zero(), 0.3);
    const Transition seven = transitionOf({kind, 7.0}, Eigen::Vector4d::Zero(), 0.3);
    ASSERT_GT(one.Q(0, 0), 0.0);
    EXPECT_NEAR(seven.Q(0, 0) / one.Q(0, 0), 7.0, 1e-12);
    EXPECT_NEAR(seven.Q(0, 1) / one.Q(0, 1), 7.0, 1e-12);
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
