#include "sightline/core/positions/position_belief.h"

#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "sightline/core/model/sphere.h"
#include "sightline/core/positions/rays.h"

namespace sightline::core {
namespace {

using Vector = Eigen::Vector3d;
constexpr double kNoOutliers = 1e6;

/// A target 100 m to the east that moves north, with correlations everywhere.
PositionBelief someBelief(int slots = 0) {
  PositionBelief belief;
  belief.mean << 100, 0, 20, 1, 5, -1, 0.2, -0.3, 0.1;
  for (int slot = 0; slot < slots; ++slot) addSlot(belief, 1e-6);
  const Eigen::Index n = belief.mean.size();
  Eigen::MatrixXd A(n, n);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < n; ++j)
      A(i, j) = std::sin(1.0 + static_cast<double>(3 * i + 7 * j)) * (i >= kMotionSize ? 1e-3 : 0.5);
  const Eigen::MatrixXd P = A * A.transpose() / static_cast<double>(n);
  belief.covariance = P;
  belief.covariance.diagonal() *= 1.2;
  return belief;
}

DirectionUpdate directionTo(const Vector& origin, const Vector& point, double sigma, int slot) {
  DirectionUpdate seen;
  seen.origin = origin;
  seen.direction = (point - origin).normalized();
  seen.basis = acrossBasis(seen.direction);
  seen.R = sigma * sigma * Eigen::Matrix2d::Identity();
  seen.slot = slot;
  return seen;
}

bool isPositiveDefinite(const PositionMatrix& P) {
  return P.llt().info() == Eigen::Success && (P - P.transpose()).norm() == 0.0;
}

TEST(PositionBelief, SlotsComeAndGoWithoutTouchingTheRest) {
  PositionBelief belief = someBelief(3);
  const PositionBelief before = belief;
  removeSlot(belief, 1);
  ASSERT_EQ(belief.slots(), 2);
  const Eigen::Index kept = kMotionSize + 2;
  EXPECT_EQ(belief.covariance.topLeftCorner(kept, kept), before.covariance.topLeftCorner(kept, kept));
  EXPECT_EQ(belief.covariance.bottomRightCorner(2, 2), before.covariance.bottomRightCorner(2, 2));
  EXPECT_EQ(belief.covariance.bottomLeftCorner(2, kept), before.covariance.bottomLeftCorner(2, kept));
  addSlot(belief, 4.0);
  EXPECT_EQ(belief.slots(), 3);
  EXPECT_EQ(belief.covariance.bottomRightCorner(2, 2), Eigen::Matrix2d(4.0 * Eigen::Matrix2d::Identity()));
  EXPECT_EQ(belief.covariance.bottomLeftCorner(2, 11).norm(), 0.0);
}

TEST(PositionBelief, PredictionIsThatOfTheTransitionMatrix) {
  const double h = 0.7, ratio = 3.0, unit_squared = 0.02, q = ratio * unit_squared;
  PositionBelief belief = someBelief(1);
  const PositionBelief before = belief;
  std::array<SlowError, kMostStations> slow;
  slow[0] = {4e-6, 2.0};
  predict(belief, {PositionModel::Kind::white_jerk, ratio}, unit_squared, h, slow);

  Eigen::MatrixXd F = Eigen::MatrixXd::Identity(11, 11), Q = Eigen::MatrixXd::Zero(11, 11);
  const double phi = std::exp(-h / 2.0);
  const double block[3][3] = {{std::pow(h, 5) / 20, std::pow(h, 4) / 8, std::pow(h, 3) / 6},
                              {std::pow(h, 4) / 8, std::pow(h, 3) / 3, h * h / 2},
                              {std::pow(h, 3) / 6, h * h / 2, h}};
  for (int i = 0; i < 3; ++i) {
    F(i, 3 + i) = F(3 + i, 6 + i) = h;
    F(i, 6 + i) = h * h / 2;
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) Q(3 * a + i, 3 * b + i) = q * block[a][b];
  }
  for (int i = 9; i < 11; ++i) {
    F(i, i) = phi;
    Q(i, i) = 4e-6 * (1 - phi * phi);
  }
  EXPECT_LT((belief.mean - F * before.mean).norm(), 1e-12);
  EXPECT_LT((belief.covariance - F * before.covariance * F.transpose() - Q).norm(), 1e-12);
}

TEST(PositionBelief, WhiteAccelerationKnowsNoAccelerationOfItsOwn) {
  PositionBelief belief = someBelief();
  predict(belief, {PositionModel::Kind::white_acceleration, 2.0}, 0.5, 0.1, {});
  EXPECT_EQ(belief.mean.tail<3>().norm(), 0.0);
  EXPECT_DOUBLE_EQ(belief.covariance(6, 6), 1.0);
  EXPECT_DOUBLE_EQ(belief.covariance(0, 6), 0.0);
}

// Far away and for small angles the update is that of a linear filter.
TEST(PositionBelief, UpdateIsTheKalmanUpdateForSmallAngles) {
  PositionBelief belief = someBelief(2);
  const PositionBelief before = belief;
  const DirectionUpdate seen = directionTo({-1e4, 0, 0}, {100, 0.3, 20.5}, 1e-4, 1);
  const UpdateResult result = update(belief, seen, kNoOutliers);

  const Vector r = before.mean.head<3>() - seen.origin, v = r.normalized();
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(2, 13);
  H.leftCols<3>() = seen.basis / r.norm();
  H.rightCols<2>().setIdentity();
  const Eigen::Vector2d nu = seen.basis * seen.direction / seen.direction.dot(v) - seen.basis * v;
  const Eigen::MatrixXd P = before.covariance;
  const Eigen::Matrix2d S = H * P * H.transpose() + seen.R;
  const Eigen::MatrixXd K = P * H.transpose() * S.inverse();
  EXPECT_LT((belief.mean - before.mean - K * nu).norm(), 1e-4 * (K * nu).norm());
  EXPECT_LT((belief.covariance - (P - K * S * K.transpose())).norm(), 1e-4 * P.norm());
  EXPECT_NEAR(result.distance_squared, nu.dot(S.inverse() * nu), 1e-4 * result.distance_squared);
  EXPECT_NEAR(result.log_determinant, std::log(S.determinant()), 1e-6);
  EXPECT_TRUE(isPositiveDefinite(belief.covariance));
}

TEST(PositionBelief, NearTargetsAreIteratedToTheDirectionSeen) {
  PositionBelief belief;
  belief.mean.head<3>() << 10, 0, 0;
  belief.covariance.diagonal() << 25, 25, 25, 1, 1, 1, 1, 1, 1;
  const DirectionUpdate seen = directionTo(Vector::Zero(), {10, 6, 0}, 1e-4, -1);
  update(belief, seen, kNoOutliers);
  // 25 (10 - x) = 0 along the ray is not told; across it the line must be met.
  EXPECT_LT(angleBetween(belief.mean.head<3>(), seen.direction), 1e-3);
}

TEST(PositionBelief, DirectionsFromBehindChangeNothing) {
  PositionBelief belief = someBelief();
  const PositionBelief before = belief;
  EXPECT_TRUE(update(belief, directionTo({0, 0, 0}, {-50, 0, 0}, 1e-3, -1), 4.0).is_behind);
  EXPECT_TRUE(updateAlone(belief, directionTo({0, 0, 0}, {-50, 0, 0}, 1e-3, -1), 4.0).is_behind);
  EXPECT_EQ(belief.mean, before.mean);
  EXPECT_EQ(belief.covariance, before.covariance);
}

TEST(PositionBelief, OutliersMoveTheTargetLessThanTheyWouldHave) {
  PositionBelief cautious = someBelief(), trusting = someBelief();
  const DirectionUpdate seen = directionTo({0, 0, 0}, {100, 30, 20}, 1e-3, -1);
  update(cautious, seen, 4.0);
  update(trusting, seen, kNoOutliers);
  const Vector start = someBelief().mean.head<3>();
  EXPECT_LT((cautious.mean.head<3>() - start).norm(), 0.8 * (trusting.mean.head<3>() - start).norm());
}

// (P-6): the log range's variance stays what it was to the last digits, although it is correlated with all
// else.
TEST(PositionBelief, OneStationAloneLeavesTheRangeAsItWas) {
  PositionBelief belief = someBelief(1);
  const Vector origin(0, 0, 0);
  const auto variance = [&](const PositionBelief& b) {
    const Vector r = b.mean.head<3>() - origin, v = r.normalized();
    return v.dot(b.covariance.topLeftCorner<3, 3>() * v) / r.squaredNorm();
  };
  const double before = variance(belief), range = belief.mean.head<3>().norm();
  for (int i = 0; i < 20; ++i) updateAlone(belief, directionTo(origin, {100, 0.1, 20}, 1e-4, 0), 4.0);
  EXPECT_NEAR(variance(belief) / before, 1.0, 1e-9);
  EXPECT_NEAR(belief.mean.head<3>().norm(), range, 1e-9);
  EXPECT_LT(angleBetween(belief.mean.head<3>(), Vector(100, 0.1, 20)), 3e-3);
  EXPECT_TRUE(isPositiveDefinite(belief.covariance));

  PositionBelief plain = someBelief(1);
  for (int i = 0; i < 20; ++i) update(plain, directionTo(origin, {100, 0.1, 20}, 1e-4, 0), 4.0);
  EXPECT_LT(variance(plain), 0.9 * before) << "the correlations of this belief do not tell the updates apart";
}

TEST(PositionBelief, OneStationAloneStillTellsTheDirection) {
  PositionBelief belief = someBelief(), plain = someBelief();
  const DirectionUpdate seen = directionTo({0, 0, 0}, {100, 1, 20}, 1e-3, -1);
  updateAlone(belief, seen, kNoOutliers);
  update(plain, seen, kNoOutliers);
  const Eigen::Matrix2d across =
      seen.basis * belief.covariance.topLeftCorner<3, 3>() * seen.basis.transpose();
  EXPECT_LT(std::sqrt(across.trace()), 3e-3 * 102.0);
  EXPECT_LT(angleBetween(belief.mean.head<3>(), plain.mean.head<3>()), 1e-3);
}

TEST(PositionBelief, AnOldDirectionSaysWhatItWouldHaveSaidInTime) {
  constexpr double kAge = 0.2;  // [s]
  const PositionModel still{PositionModel::Kind::white_jerk, 0.0};
  const DirectionUpdate fresh = directionTo({0, -60, 3}, {100.3, 0.4, 20.2}, 1e-3, -1);
  PositionBelief in_time = someBelief(), late = someBelief();
  const UpdateResult expected = update(in_time, fresh, kNoOutliers);
  predict(in_time, still, 1.0, kAge, {});
  predict(late, still, 1.0, kAge, {});
  DirectionUpdate old = fresh;
  old.age = kAge;
  const UpdateResult result = update(late, old, kNoOutliers);
  EXPECT_NEAR(result.distance_squared, expected.distance_squared, 1e-9 * expected.distance_squared);
  EXPECT_LT((late.mean - in_time.mean).norm(), 1e-5);
  EXPECT_LT((late.covariance - in_time.covariance).norm(), 1e-5 * in_time.covariance.norm());
}

TEST(PositionBelief, AnOldDirectionOfOneStationAloneIsThatOfWhereTheTargetWas) {
  PositionBelief belief = someBelief();
  belief.covariance *= 1e-6;
  const Vector origin(0, -60, 3), point = belief.mean.head<3>(), velocity = belief.mean.segment<3>(3),
                                  acceleration = belief.mean.segment<3>(6);
  DirectionUpdate old =
      directionTo(origin, point - 0.2 * velocity + 0.5 * 0.2 * 0.2 * acceleration, 1e-4, -1);
  PositionBelief unaware = belief;
  EXPECT_GT(updateAlone(unaware, old, kNoOutliers).distance_squared, 100.0);
  old.age = 0.2;
  EXPECT_LT(updateAlone(belief, old, kNoOutliers).distance_squared, 1e-9);
}

}  // namespace
}  // namespace sightline::core
