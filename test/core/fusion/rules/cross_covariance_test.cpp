#include "sightline/core/fusion/rules/cross_covariance.h"

#include <cmath>
#include <random>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "sightline/core/model/kinematics.h"
#include "sightline/core/model/sphere.h"

#include "support/covariances.h"

namespace sightline::core {
namespace {

using Eigen::Matrix2d;
using Eigen::Matrix4d;
using Eigen::MatrixXd;

/// Two Kalman filters of one target, with their exact cross-covariance by (I - K H)(F P F^T + Q)(I - K H)^T.
class TwoFilters {
 public:
  TwoFilters(double q, double sigma_a, double sigma_b) : q_(q), sigmas_{sigma_a, sigma_b} {
    for (Motion<4>& filter : filters_) {
      filter.covariance = Matrix4d::Identity();
      cross_.add();
    }
  }

  void step(double h) {
    Motion<4> shared{Eigen::Vector4d::Zero(), exact_};
    moveOn(shared, h);
    addWhiteAcceleration(shared, q_ * Matrix2d::Identity(), h);
    exact_ = shared.covariance;
    cross_.predict(h, {Eigen::Vector2d(q_, q_), Eigen::Vector2d(q_, q_)});
    for (std::size_t i = 0; i < 2; ++i) {
      Motion<4>& filter = filters_[i];
      moveOn(filter, h);
      addWhiteAcceleration(filter, q_ * Matrix2d::Identity(), h);
      const Matrix4d before = filter.covariance;
      const Matrix2d R = sigmas_[i] * sigmas_[i] * Matrix2d::Identity();
      condition(filter, Eigen::Vector2d::Zero(), R);
      Matrix4d I_KH = Matrix4d::Identity();
      I_KH.leftCols<2>() -= before.leftCols<2>() * (before.topLeftCorner<2, 2>() + R).inverse();
      exact_ = i == 0 ? Matrix4d(I_KH * exact_) : Matrix4d(exact_ * I_KH.transpose());
      cross_.update(i, before, filter.covariance);
    }
  }

  Matrix4d exact() const { return exact_; }
  Matrix4d covariance(std::size_t i) const { return filters_[i].covariance; }
  const CrossCovariance& cross() const { return cross_; }

 private:
  double q_;
  double sigmas_[2];
  Motion<4> filters_[2];
  Matrix4d exact_ = Matrix4d::Zero();
  CrossCovariance cross_;
};

TEST(CrossCovariance, EqualsTheExactRecursionOfKalmanFiltersAtEveryScale) {
  for (const double scale : {1e-5, 1.0}) {
    TwoFilters filters(0.3 * scale * scale, 0.08 * scale, 0.15 * scale);
    for (int k = 0; k < 200; ++k) filters.step(k % 3 == 0 ? 0.01 : 0.05);
    const Matrix4d expected = filters.exact();
    EXPECT_GT(expected(0, 0), 0.1 * filters.covariance(0)(0, 0)) << "the errors are to be correlated here";
    EXPECT_LT((filters.cross().between(0, 1) - expected).cwiseAbs().maxCoeff(),
              1e-9 * expected.cwiseAbs().maxCoeff());
    EXPECT_EQ(filters.cross().between(1, 0), filters.cross().between(0, 1).transpose());
  }
}

TEST(CrossCovariance, JointOfConsistentSourcesIsTakenAsItIs) {
  TwoFilters filters(0.3, 0.08, 0.15);
  for (int k = 0; k < 100; ++k) filters.step(0.03);
  const std::vector<Estimate<4>> sources{{Eigen::Vector4d::Zero(), filters.covariance(0)},
                                         {Eigen::Vector4d::Zero(), filters.covariance(1)}};
  const MatrixXd joint = filters.cross().joint(sources, {0, 1});
  EXPECT_EQ((joint.block<4, 4>(0, 4)), filters.cross().between(0, 1));
  EXPECT_EQ((joint.block<4, 4>(4, 4)), filters.covariance(1));
  EXPECT_GT(test::leastEigenvalue(joint), 0.0);
}

TEST(CrossCovariance, JointIsPositiveDefiniteWhateverTheSourcesReport) {
  TwoFilters filters(0.3, 0.08, 0.15);
  for (int k = 0; k < 100; ++k) filters.step(0.03);
  for (const double lie : {1e-1, 1e-3, 1e-6}) {  // suddenly surer by this factor
    std::vector<Estimate<4>> sources{{Eigen::Vector4d::Zero(), lie * filters.covariance(0)},
                                     {Eigen::Vector4d::Zero(), filters.covariance(1)}};
    const MatrixXd joint = filters.cross().joint(sources, {0, 1});
    EXPECT_EQ((joint.block<4, 4>(0, 0)), sources[0].covariance);
    const auto fused = maximumLikelihood(sources, joint);
    ASSERT_TRUE(fused) << lie;
    EXPECT_GE(test::leastEigenvalue(Matrix4d(sources[0].covariance - fused->covariance)),
              -1e-12 * sources[0].covariance.trace());
  }
}

TEST(CrossCovariance, UpdateNeverEnlargesTheSharedError) {
  TwoFilters filters(0.3, 0.08, 0.15);
  for (int k = 0; k < 100; ++k) filters.step(0.03);
  CrossCovariance cross = filters.cross();
  const Matrix4d before = filters.covariance(0);
  cross.update(0, before, 5.0 * before);  // a tracker that became less sure
  EXPECT_TRUE(cross.between(0, 1).isApprox(filters.cross().between(0, 1), 1e-9));
  cross.update(0, before, 0.25 * before);
  EXPECT_TRUE(cross.between(0, 1).isApprox(0.25 * filters.cross().between(0, 1), 1e-9));
}

TEST(CrossCovariance, SourcesComeAndGoWithoutTouchingTheOthers) {
  CrossCovariance cross;
  for (int i = 0; i < 3; ++i) cross.add();
  const std::vector<Eigen::Vector2d> densities{{1.0, 1.0}, {4.0, 4.0}, {9.0, 9.0}};
  cross.predict(0.1, densities);
  const Matrix4d between_0_2 = cross.between(0, 2), between_1_2 = cross.between(1, 2);
  EXPECT_NEAR(between_0_2(2, 2), 0.3, 1e-15) << "q = sqrt(1 * 9), times 0.1 s";
  cross.remove(0);
  ASSERT_EQ(cross.size(), 2u);
  EXPECT_EQ(cross.between(0, 1), between_1_2);
  cross.add();
  EXPECT_EQ(cross.between(0, 2), Matrix4d::Zero());
  EXPECT_EQ(cross.between(0, 1), between_1_2);
  cross.remove(2);
  cross.remove(1);
  cross.remove(0);
  EXPECT_EQ(cross.size(), 0u);
}

TEST(CrossCovariance, TurnsWithTheErrorsOfTheMotions) {
  // The Jacobian that turns cross-covariances is that of the motion itself, by central differences.
  const Eigen::Matrix3d R =
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(0.3, -0.5, 0.8).normalized()).toRotationMatrix();
  AngularState state;
  state.mean << 0.4, 0.9, 0.2, -0.1;
  const Matrix4d J = rotateStateJacobian(state.mean, R);
  for (int k = 0; k < 4; ++k) {
    AngularState plus = state, minus = state;
    plus.mean(k) += 1e-6, minus.mean(k) -= 1e-6;
    const Eigen::Vector4d slope = (rotateState(plus, R).mean - rotateState(minus, R).mean) / 2e-6;
    EXPECT_LT((slope - J.col(k)).norm(), 1e-8) << k;
  }

  CrossCovariance cross;
  cross.add();
  cross.add();
  cross.predict(0.1, {Eigen::Vector2d(1.0, 2.0), Eigen::Vector2d(1.0, 2.0)});
  const Matrix4d before = cross.between(0, 1);
  cross.transform({J, 2.0 * J});
  EXPECT_TRUE(cross.between(0, 1).isApprox(2.0 * J * before * J.transpose(), 1e-12));
}

}  // namespace
}  // namespace sightline::core
