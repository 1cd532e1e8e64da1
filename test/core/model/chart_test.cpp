#include "sightline/core/model/chart.h"

#include <cmath>

#include <gtest/gtest.h>

namespace sightline::core {
namespace {

TEST(Chart, LowTargetsKeepTheirAzimuthAndElevationButForAConstant) {
  const Chart chart = Chart::around(directionOf({3.1, 0.5}));
  EXPECT_LT((chart.coordinatesOf(directionOf({3.1, 0.5})) - Eigen::Vector2d(0.0, 0.5)).norm(), 1e-12);
  EXPECT_LT(
      (chart.coordinatesOf(directionOf({-3.1, 0.6})) - Eigen::Vector2d(2.0 * std::acos(-1.0) - 6.2, 0.6))
          .norm(),
      1e-12);
}

TEST(Chart, HighTargetsStandAtItsOrigin) {
  for (const double elevation : {1.35, 1.5707963, -1.4}) {
    const Eigen::Vector3d direction = directionOf({2.0, elevation});
    EXPECT_LT(Chart::around(direction).coordinatesOf(direction).norm(), 1e-12);
  }
}

TEST(Chart, HoldsTheTargetItWasMadeForAndNotOnesNearItsPoles) {
  for (double elevation = -1.57; elevation <= 1.57; elevation += 0.01) {
    const Eigen::Vector3d direction = directionOf({1.0, elevation});
    const Chart chart = Chart::around(direction);
    EXPECT_TRUE(chart.holds(chart.coordinatesOf(direction))) << elevation;
    EXPECT_FALSE(chart.holds({0.0, 1.45}));
    EXPECT_FALSE(chart.holds({3.0, 0.0}));
  }
}

TEST(Chart, StaysTiltedOnTheWayDownFromTheZenith) {
  const Eigen::Vector3d high = directionOf({1.0, 1.5}), on_the_way = directionOf({1.0, 1.0}),
                        low = directionOf({1.0, 0.7});
  const Chart tilted = Chart::around(high);
  EXPECT_LT(tilted.following(on_the_way).coordinatesOf(on_the_way).norm(), 1e-12);
  EXPECT_NEAR(tilted.following(low).coordinatesOf(low).y(), 0.7, 1e-12);
  EXPECT_NEAR(Chart::around(low).following(on_the_way).coordinatesOf(on_the_way).y(), 1.0, 1e-12);
}

TEST(Chart, DirectionsAndStatesGoThereAndBack) {
  const Chart chart = Chart::around(directionOf({2.0, 1.45}));
  const Eigen::Vector3d direction = directionOf({1.0, 1.5});
  EXPECT_LT((chart.directionAt(chart.coordinatesOf(direction)) - direction).norm(), 1e-14);
  AngularState state;
  state.mean << 1.0, 1.5, 0.3, -0.1;
  state.covariance = Eigen::Vector4d(1e-4, 2e-6, 3e-3, 4e-5).asDiagonal();
  const AngularState back = chart.toTracking(chart.fromTracking(state));
  EXPECT_LT((back.mean - state.mean).norm(), 1e-10);
  EXPECT_TRUE(back.covariance.isApprox(state.covariance, 1e-8));
}

TEST(Chart, UprightAndTiltedAreBothTheRotationOfTheirFrame) {
  AngularState state;
  state.mean << -3.1, 0.4, 0.3, -0.1;
  state.covariance = Eigen::Vector4d(1e-4, 2e-6, 3e-3, 4e-5).asDiagonal();
  state.covariance(0, 3) = state.covariance(3, 0) = 1e-5;
  Eigen::Matrix2d sigmas;
  sigmas << 1e-4, 3e-5, 3e-5, 4e-4;
  const Sighting sighting = sightingOf(state.angles(), sigmas);
  for (const Chart& chart :
       {Chart::around(directionOf({3.1, 0.5})), Chart::around(directionOf({3.1, 1.4}))}) {
    const AngularState expected = rotateState(state, chart.R_chart_tracking());
    const AngularState in_chart = chart.fromTracking(state);
    EXPECT_LT((in_chart.mean - expected.mean).norm(), 1e-12);
    EXPECT_TRUE(in_chart.covariance.isApprox(expected.covariance, 1e-12));
    EXPECT_LT((chart.toTracking(expected).mean - state.mean).norm(), 1e-12);
    const Eigen::Matrix2d J = rotationJacobian(state.angles(), chart.R_chart_tracking());
    EXPECT_TRUE(chart.covarianceOf(sighting).isApprox(J * sigmas * J.transpose(), 1e-11));
  }
}

TEST(Chart, MotionBeyondAPoleComesBackAsADirection) {
  AngularState state;
  state.mean << 0.1, 1.8, 0.3, -0.1;  // an upright chart's prediction far ahead
  state.covariance = 1e-4 * Eigen::Matrix4d::Identity();
  const Chart chart = Chart::around(directionOf({3.0, 1.2}));
  const AngularState in_tracking = chart.toTracking(state);
  EXPECT_NEAR(in_tracking.mean(1), kPi - 1.8, 1e-12);
  EXPECT_LT((directionOf(in_tracking.angles()) - chart.directionAt(state.angles())).norm(), 1e-12);
}

TEST(Chart, NearTheZenithASightingsCovarianceIsRoundInTheTiltedChart) {
  const double elevation = 1.56, sigma = 1e-3;
  const double azimuth_sigma = sigma / std::cos(elevation);
  const Sighting sighting = sightingOf(
      {0.4, elevation}, Eigen::Vector2d(azimuth_sigma * azimuth_sigma, sigma * sigma).asDiagonal());
  const Chart chart = Chart::around(directionOf({-2.0, 1.5}));
  EXPECT_TRUE(chart.covarianceOf(sighting).isApprox(Eigen::Matrix2d::Identity() * sigma * sigma, 0.02));
}

}  // namespace
}  // namespace sightline::core
