#include "sightline/core/positions/position_bound.h"

#include <cmath>
#include <stdexcept>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "sightline/core/positions/position_belief.h"
#include "sightline/core/positions/rays.h"

namespace sightline::core {
namespace {

using Vector = Eigen::Vector3d;

// One sighting each of two stations at right angles, 100 m away: rho sigma along both, rho sigma/sqrt 2 up.
TEST(PositionBound, TwoRaysGiveTheirCovariance) {
  PositionBound bound(1e4, 1e3);
  bound.see({0, 0, 0}, {100, 0, 0}, 1e-6);
  bound.see({100, -100, 0}, {100, 0, 0}, 1e-6);
  const auto P = bound.covariance();
  EXPECT_NEAR(std::sqrt(P(0, 0)), 0.1, 1e-6);
  EXPECT_NEAR(std::sqrt(P(1, 1)), 0.1, 1e-6);
  EXPECT_NEAR(std::sqrt(P(2, 2)), 0.1 / std::sqrt(2.0), 1e-6);
}

// About the true path a filter's covariance is the bound.
TEST(PositionBound, IsTheCovarianceOfAFilterThatIsLinearisedAtTheTruth) {
  PositionBound bound(10.0, 5.0);
  PositionBelief belief;
  belief.covariance.diagonal() << 100, 100, 100, 25, 25, 25, 0, 0, 0;
  const Vector start(30, 40, 20), velocity(3, -2, 1);
  belief.mean << start, velocity, Vector::Zero();
  const Vector origins[2] = {{0, 0, 0}, {100, 0, 2}};
  for (int i = 1; i <= 50; ++i) {
    const double h = 0.05;
    const Vector target = start + i * h * velocity;
    bound.predict(h, 0.5);
    predict(belief, {PositionModel::Kind::white_acceleration, 0.5}, 1.0, h, {});
    for (const Vector& origin : origins) {
      bound.see(origin, target, 1e-6);
      DirectionUpdate seen;
      seen.origin = origin;
      seen.direction = (target - origin).normalized();
      seen.basis = acrossBasis(seen.direction);
      seen.R = 1e-6 * Eigen::Matrix2d::Identity();
      update(belief, seen, 4.0);
    }
  }
  const Eigen::Matrix<double, 6, 6> P = belief.covariance.topLeftCorner<6, 6>();
  EXPECT_LT((P - bound.covariance()).norm(), 1e-6 * P.norm());
}

TEST(PositionBound, StandardDeviationsMustBePositive) {
  EXPECT_THROW(PositionBound(0.0, 1.0), std::invalid_argument);
}

}  // namespace
}  // namespace sightline::core
