#include "sightline/core/fusion/rules/intersection_weights.h"

#include <cmath>

#include <Eigen/LU>
#include <gtest/gtest.h>

namespace sightline::core {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using Eigen::VectorXd;

TEST(IntersectionWeights, AreNonNegativeAndSumToOne) {
  const VectorXd weights = determinantWeights<2>({Matrix2d(Vector2d(1.0, 9.0).asDiagonal()),
                                                  Matrix2d(Vector2d(8.0, 2.0).asDiagonal()),
                                                  Matrix2d(Vector2d(3.0, 3.0).asDiagonal())});
  EXPECT_GE(weights.minCoeff(), 0.0);
  EXPECT_NEAR(weights.sum(), 1.0, 1e-12);
}

TEST(IntersectionWeights, EqualInformationsGetEqualWeights) {
  const VectorXd weights = determinantWeights<2>({Matrix2d::Identity(), Matrix2d::Identity()});
  EXPECT_NEAR(weights(0), 0.5, 1e-9);
}

TEST(IntersectionWeights, AClearlyBetterSourceGetsAllTheWeight) {
  const VectorXd weights = determinantWeights<2>({Matrix2d::Identity(), 100.0 * Matrix2d::Identity()});
  EXPECT_NEAR(weights(1), 1.0, 1e-6);
}

TEST(IntersectionWeights, DeterminantIsNotLargerThanOnAnyPointOfAGrid) {
  const Matrix2d a = Vector2d(1.0, 16.0).asDiagonal(), b = Vector2d(6.0, 2.0).asDiagonal();
  const auto volume = [&](double w) { return -std::log((w * a + (1.0 - w) * b).determinant()); };
  const double least = volume(determinantWeights<2>({a, b})(0));
  for (int k = 0; k <= 1000; ++k) EXPECT_LE(least, volume(k / 1000.0) + 1e-8);
}

}  // namespace
}  // namespace sightline::core
