#include "sightline/core/estimators/charted_estimator.h"

#include <memory>

#include <gtest/gtest.h>

#include "sightline/core/estimators/estimators.h"

#include "support/times.h"

namespace sightline::core {
namespace {

using test::at;

Tracklet trackletAt(double time, const Eigen::Vector2d& angles, double sigma = 1e-3) {
  Tracklet tracklet;
  tracklet.time = at(time);
  tracklet.sensor = "sensor";
  tracklet.sighting = sightingOf(angles, Eigen::Matrix2d::Identity() * sigma * sigma);
  return tracklet;
}

ChartedEstimator startedAt(const Eigen::Vector2d& angles) {
  return ChartedEstimator(makeEstimator(EstimatorParams{}), trackletAt(0.0, angles));
}

TEST(ChartedEstimator, FollowsATargetRoundTheSensorAcrossTheWrapOfTheAzimuth) {
  ChartedEstimator estimator = startedAt({0.0, 0.1});
  int moves = 0;
  for (int k = 1; k <= 700; ++k)
    moves += estimator.update(trackletAt(0.03 * k, {wrapAngle(0.01 * k), 0.1})) ? 1 : 0;
  const AngularState state = estimator.stateAt(at(21.0));
  EXPECT_NEAR(wrapAngle(state.angles().x() - 7.0), 0.0, 1e-3);
  EXPECT_NEAR(state.rates().x(), 0.01 / 0.03, 1e-2);
  EXPECT_GE(moves, 2) << "a chart does not reach all the way round";
}

TEST(ChartedEstimator, AnUncertainStampWidensTheSightingAlongTheMotion) {
  ChartedEstimator certain = startedAt({0.0, 0.0});
  for (int k = 1; k < 30; ++k) certain.update(trackletAt(0.03 * k, {0.03 * k * 0.2, 0.0}));
  ChartedEstimator uncertain = certain;
  certain.update(trackletAt(0.9, {0.18, 0.0}));
  uncertain.update(trackletAt(0.9, {0.18, 0.0}), 0.05 * 0.05);
  const auto variance = [](const ChartedEstimator& it) { return it.stateAt(at(0.9)).anglesCovariance(); };
  EXPECT_GT(variance(uncertain)(0, 0), 1.05 * variance(certain)(0, 0));
  EXPECT_NEAR(variance(uncertain)(1, 1) / variance(certain)(1, 1), 1.0, 0.05) << "it does not climb";
}

TEST(ChartedEstimator, ACopyGoesItsOwnWay) {
  ChartedEstimator original = startedAt({0.0, 0.0});
  for (int k = 1; k < 10; ++k) original.update(trackletAt(0.03 * k, {0.0, 0.0}));
  const ChartedEstimator copy = original;
  const AngularState before = copy.stateAt(at(0.3));
  for (int k = 10; k < 40; ++k) original.update(trackletAt(0.03 * k, {0.01, 0.0}));
  EXPECT_EQ(copy.stateAt(at(0.3)).mean, before.mean);
  EXPECT_NE(original.stateAt(at(0.3)).mean, before.mean);
}

TEST(ChartedEstimator, ThePredictionInTheChartIsTheStateInTheTrackingFrame) {
  ChartedEstimator estimator = startedAt({1.0, 0.8});
  for (int k = 1; k < 20; ++k) estimator.update(trackletAt(0.03 * k, {1.0 + 0.002 * k, 0.8}));
  const ChartedState prediction = estimator.predict(at(0.7));
  const AngularState state = estimator.stateAt(at(0.7));
  EXPECT_LT(
      angleBetween(prediction.chart.directionAt(prediction.state.angles()), directionOf(state.angles())),
      1e-12);
}

}  // namespace
}  // namespace sightline::core
