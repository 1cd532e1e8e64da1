#include "sightline/core/association/gate.h"

#include <cmath>
#include <random>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

namespace sightline::core {
namespace {

AngularState prediction() {
  AngularState state;
  state.mean << 0.2, -0.1, 0.0, 0.0;
  state.covariance.setIdentity();
  state.covariance.topLeftCorner<2, 2>() << 4e-4, 1e-4, 1e-4, 2e-4;
  return state;
}

const Eigen::Matrix2d kR = (Eigen::Matrix2d() << 1e-4, -2e-5, -2e-5, 3e-4).finished();

TEST(Gate, ThresholdIsTheChiSquareQuantile) {
  GateParams params;
  params.probability = 0.95;
  EXPECT_NEAR(gateThreshold(params), 5.991464547107979, 1e-12);
  params.probability = 0.9973002039367398;  // three sigma in one dimension
  EXPECT_NEAR(gateThreshold(params), 11.829158081900795, 1e-9);
}

TEST(Gate, AcceptsTheStatedShareOfGenuineSightings) {
  GateParams params;
  params.probability = 0.9;
  const Gate gate = gateOf(prediction(), kR, params);
  const Eigen::Matrix2d L = Eigen::LLT<Eigen::Matrix2d>(gate.covariance).matrixL();
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  const int draws = 40000;
  int inside = 0, inside_rectangle = 0;
  GateParams rectangle = params;
  rectangle.shape = GateShape::rectangle;
  for (int i = 0; i < draws; ++i) {
    const double a = normal(random), b = normal(random);
    const Eigen::Vector2d innovation = L * Eigen::Vector2d(a, b);
    inside += isInside(gate, innovation, params);
    inside_rectangle += isInside(gate, innovation, rectangle);
  }
  EXPECT_NEAR(inside, 0.9 * draws, 5.0 * std::sqrt(0.9 * 0.1 * draws));
  EXPECT_GT(inside_rectangle, inside);  // the rectangle holds the ellipse
}

TEST(Gate, CovarianceIsThatOfTheInnovation) {
  const Gate gate = gateOf(prediction(), kR, GateParams{}, 2.0);
  EXPECT_TRUE(gate.covariance.isApprox(2.0 * (prediction().anglesCovariance() + kR), 1e-15));
  EXPECT_EQ(gate.centre, Eigen::Vector2d(0.2, -0.1));
}

TEST(Gate, MinimumAndMaximumBoundTheHalfWidth) {
  GateParams params;
  params.min_half_width = 0.5;
  const Gate wide = gateOf(prediction(), kR, params);
  EXPECT_NEAR(wide.half_width(0), 0.5, 1e-12);
  EXPECT_TRUE(isInside(wide, {0.3, 0.0}, params));
  params.min_half_width = 0.0;
  params.max_half_width = 0.01;
  const Gate narrow = gateOf(prediction(), kR, params);
  EXPECT_EQ(narrow.half_width(1), 0.01);
  EXPECT_FALSE(isInside(narrow, {0.011, 0.0}, params));
  EXPECT_TRUE(isInside(narrow, {0.009, 0.0}, params));
}

TEST(Gate, DistanceEqualsTheSolvedOneAtAnyScale) {
  for (const double scale : {1e-10, 1.0, 1e4}) {
    Gate gate;
    gate.covariance << 4.0 * scale, 1.0 * scale, 1.0 * scale, 2.0 * scale;
    const Eigen::Vector2d innovation = std::sqrt(scale) * Eigen::Vector2d(1.0, -2.0);
    EXPECT_NEAR(distanceSquared(gate, innovation), innovation.dot(gate.covariance.ldlt().solve(innovation)),
                1e-12);
  }
}

}  // namespace
}  // namespace sightline::core
