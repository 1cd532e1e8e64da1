#include "sightline/core/positions/rays.h"

#include <cmath>
#include <vector>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "sightline/core/model/sphere.h"
#include "sightline/core/simulation/random_stream.h"

namespace sightline::core {
namespace {

using Vector = Eigen::Vector3d;

/// A ray from `origin` to `target` with the same standard deviation [rad] in all directions across it.
Ray rayTo(const Vector& origin, const Vector& target, double sigma) {
  Ray ray;
  ray.origin = origin;
  ray.direction = (target - origin).normalized();
  ray.covariance = sigma * sigma * (Eigen::Matrix3d::Identity() - ray.direction * ray.direction.transpose());
  return ray;
}

/// The same with the rates of a target that moves at `velocity`, seen from a station at `station_velocity`.
Ray movingRayTo(const Vector& origin, const Vector& target, const Vector& velocity, double sigma,
                double rate_sigma, const Vector& station_velocity = Vector::Zero()) {
  Ray ray = rayTo(origin, target, sigma);
  const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - ray.direction * ray.direction.transpose();
  ray.motion = RayMotion{across * (velocity - station_velocity) / (target - origin).norm(),
                         rate_sigma * rate_sigma * across, station_velocity};
  return ray;
}

/// The ray with errors drawn from its covariances.
Ray disturbed(const Ray& ray, double sigma, double rate_sigma, RandomStream& random) {
  const Eigen::Matrix<double, 2, 3> B = acrossBasis(ray.direction);
  Ray noisy = ray;
  noisy.direction = (ray.direction + B.transpose() * sigma * random.normalPair()).normalized();
  if (noisy.motion) noisy.motion->rate += B.transpose() * rate_sigma * random.normalPair();
  return noisy;
}

TEST(Rays, AcrossBasisIsOrthonormalAndAcrossEverywhere) {
  for (const Vector& direction :
       {Vector(1, 0, 0), Vector(0, 0, 1), Vector(0, 0, -1), Vector(-0.3, 0.5, -0.9), Vector(1e-9, 0, -1)}) {
    const Vector u = direction.normalized();
    const auto B = acrossBasis(u);
    EXPECT_LT((B * B.transpose() - Eigen::Matrix2d::Identity()).norm(), 1e-7) << direction.transpose();
    EXPECT_LT((B * u).norm(), 1e-7) << direction.transpose();
  }
}

TEST(Rays, InnovationIsTheAngleToThePointAndZeroBehindGivesNothing) {
  const Ray ray = rayTo({0, 0, 0}, {100, 0, 0}, 1e-3);
  const auto seen = innovationOf(ray, {100, 0.1, -0.2});
  ASSERT_TRUE(seen);
  EXPECT_NEAR(seen->residual.norm(), std::hypot(0.1, 0.2) / 100.0, 1e-8);
  EXPECT_NEAR(seen->range, 100.0, 1e-3);
  EXPECT_FALSE(innovationOf(ray, {-1, 0, 0}));
  EXPECT_FALSE(innovationOf(ray, {0, 0, 0}));
}

TEST(Rays, InnovationsDerivativeIsThatOfTheResidual) {
  const Ray ray = rayTo({3, -4, 1}, {60, 20, 30}, 1e-3);
  const Vector point(60, 20, 30);
  const auto at = innovationOf(ray, point);
  ASSERT_TRUE(at);
  for (int axis = 0; axis < 3; ++axis) {
    const auto moved = innovationOf(ray, point + 1e-4 * Vector::Unit(axis));
    ASSERT_TRUE(moved);
    EXPECT_LT(((at->residual - moved->residual) / 1e-4 - at->H.col(axis)).norm(), 1e-6);
  }
}

// Stations at (0, 0) and (100, 0), target at (50, 50): rays at 45 degrees, range 50 sqrt 2, sigma 1 mrad.
// Along east: 1/var = 2 (1/2)/(rho sigma)^2, so sigma_east = rho sigma; the same to the north; up: two
// measurements of rho sigma, so rho sigma/sqrt 2.
TEST(Rays, TwoRaysCrossAtThePointWithTheCovarianceWorkedOutByHand) {
  const Vector target(50, 50, 0);
  const Crossing crossing = intersect({rayTo({0, 0, 0}, target, 1e-3), rayTo({100, 0, 0}, target, 1e-3)});
  ASSERT_EQ(crossing.verdict, CrossingVerdict::crossing);
  EXPECT_LT((crossing.at.point - target).norm(), 1e-9);
  const double s = 50.0 * std::sqrt(2.0) * 1e-3;
  const Vector expected(s * s, s * s, s * s / 2.0);
  EXPECT_LT((crossing.at.covariance - Eigen::Matrix3d(expected.asDiagonal())).norm(), 1e-12);
  EXPECT_NEAR(crossing.at.parallax, kPi / 2.0, 1e-9);
  EXPECT_NEAR(crossing.at.relative_sigma, 1e-3, 1e-9);
  EXPECT_EQ(crossing.at.degrees, 1);
  EXPECT_NEAR(crossing.at.chi_square, 0.0, 1e-12);
}

// The upper ray passes 0.2 m above the lower one: with equal sigmas and ranges the point lies between, each
// residual 0.1 m / 70.7 m, chi-square 2 (0.1/70.7)^2 / sigma^2.
TEST(Rays, ChiSquareOfSkewRaysIsThatOfTheirDistance) {
  const double rho = 50.0 * std::sqrt(2.0);
  const Crossing crossing =
      intersect({rayTo({0, 0, 0}, {50, 50, 0.1}, 1e-3), rayTo({100, 0, 0}, {50, 50, -0.1}, 1e-3)});
  ASSERT_EQ(crossing.verdict, CrossingVerdict::crossing);
  EXPECT_NEAR(crossing.at.chi_square, 2.0 * std::pow(0.1 / rho / 1e-3, 2), 1e-5);
  EXPECT_NEAR(crossing.at.point.z(), 0.0, 1e-7);
}

// A station ten times nearer counts a hundred times as much at equal sigma: distances in metres from the rays
// would not know.
TEST(Rays, NearStationsCountMoreThanFarOnes) {
  const Crossing crossing =
      intersect({rayTo({0, -100, 0}, {0, 0, 1.0}, 1e-3), rayTo({1000, 0, 0}, {0, 0, 0.0}, 1e-3)});
  ASSERT_EQ(crossing.verdict, CrossingVerdict::crossing);
  EXPECT_NEAR(crossing.at.point.z(), 100.0 / 101.0, 1e-3);
}

TEST(Rays, VelocityFollowsFromTheRatesAlsoSeenFromAMovingStation) {
  const Vector target(40, 70, 25), velocity(3, -5, 1), ship(4, 2, 0);
  const Crossing crossing = intersect({movingRayTo({0, 0, 0}, target, velocity, 1e-4, 1e-4),
                                       movingRayTo({100, 0, 0}, target, velocity, 1e-4, 1e-4, ship)});
  ASSERT_EQ(crossing.verdict, CrossingVerdict::crossing);
  ASSERT_TRUE(crossing.at.velocity);
  EXPECT_LT((*crossing.at.velocity - velocity).norm(), 1e-8);
  EXPECT_EQ(crossing.at.degrees, 2);
  EXPECT_GT(crossing.at.velocityCovariance().trace(), 0.0);
}

TEST(Rays, PointVelocityAndChiSquareAreConsistentOverManyDraws) {
  const std::vector<Vector> origins{{0, 0, 0}, {120, 10, 3}, {50, -60, 8}};
  const Vector target(60, 80, 30), velocity(-6, 4, 2);
  const double sigma = 2e-3, rate_sigma = 3e-3;
  RandomStream random(11);
  const int draws = 400;
  double point_nees = 0.0, velocity_nees = 0.0, chi_square = 0.0;
  Vector mean_error = Vector::Zero();
  for (int draw = 0; draw < draws; ++draw) {
    std::vector<Ray> rays;
    for (const Vector& origin : origins)
      rays.push_back(
          disturbed(movingRayTo(origin, target, velocity, sigma, rate_sigma), sigma, rate_sigma, random));
    const Crossing crossing = intersect(rays);
    ASSERT_EQ(crossing.verdict, CrossingVerdict::crossing);
    const Vector error = crossing.at.point - target, velocity_error = *crossing.at.velocity - velocity;
    mean_error += error / draws;
    point_nees += error.dot(crossing.at.covariance.llt().solve(error)) / draws;
    velocity_nees += velocity_error.dot(crossing.at.velocityCovariance().llt().solve(velocity_error)) / draws;
    chi_square += crossing.at.chi_square / draws;
    EXPECT_EQ(crossing.at.degrees, 6);
  }
  // Means of `draws` chi-squares of d degrees: d +- 3.5 sqrt(2 d/draws).
  EXPECT_NEAR(point_nees, 3.0, 3.5 * std::sqrt(2.0 * 3.0 / draws));
  EXPECT_NEAR(velocity_nees, 3.0, 3.5 * std::sqrt(2.0 * 3.0 / draws));
  EXPECT_NEAR(chi_square, 6.0, 3.5 * std::sqrt(2.0 * 6.0 / draws));
  EXPECT_LT(mean_error.norm(), 0.04);
}

TEST(Rays, MetresAndKilometresMakeNoDifference) {
  const auto crossingIn = [](double unit) {
    const Vector target = unit * Vector(50, 50, 10);
    return intersect({rayTo(Vector::Zero(), target, 1e-3), rayTo(unit * Vector(100, 0, 0), target, 1e-3)});
  };
  const Eigen::Matrix3d in_metres = crossingIn(1.0).at.covariance;
  for (const double unit : {0.01, 1000.0}) {
    const Crossing crossing = crossingIn(unit);
    ASSERT_EQ(crossing.verdict, CrossingVerdict::crossing) << unit;
    EXPECT_LT((crossing.at.point / unit - Vector(50, 50, 10)).norm(), 1e-8);
    EXPECT_LT((crossing.at.covariance / (unit * unit) - in_metres).norm(), 1e-9 * in_metres.norm());
  }
}

TEST(Rays, RaysThatDoNotCrossAreToldApart) {
  const Ray ray = rayTo({0, 0, 0}, {50, 50, 0}, 1e-3);
  EXPECT_EQ(intersect({}).verdict, CrossingVerdict::too_few);
  EXPECT_EQ(intersect({ray}).verdict, CrossingVerdict::too_few);
  EXPECT_EQ(intersect({ray, rayTo({100, 0, 0}, {150, 50, 0}, 1e-3)}).verdict, CrossingVerdict::parallel);
  EXPECT_EQ(intersect({ray, rayTo({100, 0, 0}, {200, 50, 0}, 1e-3)}).verdict, CrossingVerdict::behind);
  Ray bad = rayTo({100, 0, 0}, {50, 50, 0}, 1e-3);
  bad.covariance.setZero();
  EXPECT_EQ(intersect({ray, bad}).verdict, CrossingVerdict::bad_ray);
  bad = ray;
  bad.direction.x() = std::nan("");
  EXPECT_EQ(intersect({ray, bad}).verdict, CrossingVerdict::bad_ray);
  EXPECT_EQ(refusalOf(CrossingVerdict::parallel).kind, "no parallax");
}

TEST(Rays, PlaneTestIsZeroForRaysOfOneTargetAndPositiveForOthers) {
  const Vector target(40, 70, 25), velocity(3, -5, 1);
  const Ray a = movingRayTo({0, 0, 0}, target, velocity, 1e-3, 1e-3);
  const Ray b = movingRayTo({100, 0, 0}, target, velocity, 1e-3, 1e-3);
  const auto same = planeTest(a, b);
  ASSERT_TRUE(same);
  EXPECT_NEAR(same->offset, 0.0, 1e-15);
  EXPECT_NEAR(*same->offset_rate, 0.0, 1e-15);
  EXPECT_TRUE(same->isAhead());
  EXPECT_NEAR(same->range_a, target.norm(), 1e-9);
  EXPECT_EQ(same->degrees(), 2);

  // The same crossing with another velocity: the rates do not agree out of the plane.
  const auto other = planeTest(a, movingRayTo({100, 0, 0}, target, velocity + Vector(0, 0, 5), 1e-3, 1e-3));
  ASSERT_TRUE(other);
  EXPECT_GT(other->distanceSquared(), 100.0);
  EXPECT_FALSE(planeTest(a, a));
}

TEST(Rays, PlaneTestIsChiSquareOverManyDraws) {
  const Vector target(40, 70, 25), velocity(3, -5, 1), ship(4, 2, 0);
  RandomStream random(5);
  const int draws = 1000;
  double offset = 0.0, rate = 0.0;
  for (int draw = 0; draw < draws; ++draw) {
    const Ray a = disturbed(movingRayTo({0, 0, 0}, target, velocity, 2e-3, 3e-3), 2e-3, 3e-3, random);
    const Ray b =
        disturbed(movingRayTo({100, 20, 5}, target, velocity, 2e-3, 3e-3, ship), 2e-3, 3e-3, random);
    const auto test = planeTest(a, b);
    ASSERT_TRUE(test);
    offset += test->offset * test->offset / test->variance / draws;
    rate += *test->offset_rate * *test->offset_rate / test->rate_variance / draws;
  }
  EXPECT_NEAR(offset, 1.0, 3.5 * std::sqrt(2.0 / draws));
  EXPECT_NEAR(rate, 1.0, 3.5 * std::sqrt(2.0 / draws));
}

TEST(Rays, DistanceToATargetIsChiSquareOverManyDraws) {
  Eigen::Matrix<double, 6, 1> truth;
  truth << 40, 70, 25, 3, -5, 1;
  const Eigen::Matrix<double, 6, 6> P =
      (Eigen::Matrix<double, 6, 1>() << 0.04, 0.01, 0.02, 0.1, 0.2, 0.1).finished().asDiagonal();
  RandomStream random(8);
  const int draws = 1000;
  double of_direction = 0.0, of_both = 0.0;
  for (int draw = 0; draw < draws; ++draw) {
    Eigen::Matrix<double, 6, 1> state = truth;
    for (int i = 0; i < 6; ++i) state(i) += std::sqrt(P(i, i)) * random.normalPair().x();
    const Ray ray = disturbed(movingRayTo({100, 20, 5}, truth.head<3>(), truth.tail<3>(), 2e-3, 3e-3), 2e-3,
                              3e-3, random);
    of_direction += *distanceSquared(ray, state, P, false) / draws;
    of_both += *distanceSquared(ray, state, P, true) / draws;
  }
  EXPECT_NEAR(of_direction, 2.0, 3.5 * std::sqrt(4.0 / draws));
  EXPECT_NEAR(of_both, 4.0, 3.5 * std::sqrt(8.0 / draws));
  EXPECT_FALSE(distanceSquared(rayTo({40, 70, 100}, {40, 70, 200}, 1e-3), truth, P, false)) << "behind";
}

TEST(Rays, RaysOfOneTargetLieAtOneAngleAboutTheBaseline) {
  const Vector a(0, 0, 0), b(100, 20, 5), target(40, 70, 25);
  const Vector axis = (b - a).normalized();
  RandomStream random(3);
  const PlaneAngle of_a = planeAngle(rayTo(a, target, 1e-3), axis);
  EXPECT_NEAR(of_a.angle, planeAngle(rayTo(b, target, 1e-3), axis).angle, 1e-12);
  double variance = 0.0;
  for (int draw = 0; draw < 1000; ++draw) {
    const double error =
        planeAngle(disturbed(rayTo(a, target, 1e-3), 1e-3, 0.0, random), axis).angle - of_a.angle;
    variance += error * error / 1000.0;
  }
  EXPECT_NEAR(variance / of_a.variance, 1.0, 3.5 * std::sqrt(2.0 / 1000.0));
  EXPECT_TRUE(std::isinf(planeAngle(rayTo(a, b, 1e-3), axis).variance));
}

}  // namespace
}  // namespace sightline::core
