#include "sightline/core/smoothing/step_back.h"

#include <Eigen/LU>
#include <gtest/gtest.h>

namespace sightline::core {
namespace {

using Matrix = Eigen::Matrix4d;
using Vector = Eigen::Vector4d;

Matrix positiveDefinite(int seed, double scale) {
  std::srand(static_cast<unsigned>(seed));  // the generator of Eigen's Random
  const Matrix root = Matrix::Random();
  const Vector units(1e-3, 1e-2, 1.0, 10.0);  // as angles, rates, accelerations and kappa differ
  return scale * units.asDiagonal() * (root * root.transpose() + 0.1 * Matrix::Identity()) *
         units.asDiagonal();
}

Step<4> someStep() {
  Step<4> step;
  step.F = Matrix::Identity();
  step.F(0, 1) = step.F(1, 2) = 0.3;
  step.F(0, 2) = 0.045;
  step.Q = positiveDefinite(3, 0.2);
  return step;
}

TEST(StepBack, InverseIsThatOfEigenAndRefusesWhatIsNotPositiveDefinite) {
  const Matrix A = positiveDefinite(1, 1.0);
  const Inverse<4> inverse(A);
  ASSERT_TRUE(inverse.exists);
  EXPECT_TRUE((inverse.matrix * A).isApprox(Matrix::Identity(), 1e-9));
  EXPECT_NEAR(inverse.log_root, 0.5 * std::log(A.determinant()), 1e-9);
  Matrix singular = A;
  singular.row(2).setZero();
  singular.col(2).setZero();
  EXPECT_FALSE(Inverse<4>(singular).exists);
  EXPECT_FALSE(Inverse<4>(Matrix(-A)).exists);
}

// Rauch, Tung, Striebel 1965: x + G (x_s - x+), P + G (P_s - P+) G^T with G = P F^T (P+)^-1.
TEST(StepBack, IsTheRecursionOfRauchTungAndStriebel) {
  Normal<4> state{Vector(0.01, 0.02, 0.3, 4.0), positiveDefinite(2, 1.0)};
  Step<4> step = someStep();
  step.mean = step.F * state.mean;
  const Matrix predicted = step.F * state.covariance * step.F.transpose() + step.Q;
  const Normal<4> smoothed{step.mean + Vector(1e-3, -2e-3, 0.1, 1.0), Matrix(0.5 * predicted)};
  const Matrix G = state.covariance * step.F.transpose() * predicted.inverse();
  const Vector mean = state.mean + G * (smoothed.mean - step.mean);
  const Matrix covariance = state.covariance + G * (smoothed.covariance - predicted) * G.transpose();
  Later<4> later;
  ASSERT_TRUE(findLater(step, state.covariance, smoothed, later));
  EXPECT_GT(stepBack(state, step, later, true), kNever);
  EXPECT_TRUE(state.mean.isApprox(mean, 1e-9));
  EXPECT_TRUE(state.covariance.isApprox(covariance, 1e-8));
}

// The density of later sightings, given that the state is N(m, P): a normal one of their mean.
TEST(StepBack, EvidenceOfTwoStatesIsTheRatioOfTheirDensities) {
  const Step<4> step = [] {
    Step<4> one = someStep();
    one.mean.setZero();
    return one;
  }();
  const Normal<4> first{Vector::Zero(), positiveDefinite(2, 1.0)};
  const Matrix of_later = positiveDefinite(5, 0.7);
  const Vector seen(2e-3, 0.0, 0.1, -2.0);  // a sighting of the whole state with that covariance
  Later<4> later;
  later.origin.setZero();
  later.Y = of_later.inverse();
  later.y = later.Y * seen;
  const auto logDensity = [&](const Vector& mean, const Matrix& P) {
    const Matrix S = step.F * P * step.F.transpose() + step.Q + of_later;
    const Vector offset = seen - step.F * mean;
    return -0.5 * offset.dot(S.inverse() * offset) - 0.5 * std::log(S.determinant());
  };
  const auto evidence = [&](const Vector& mean, const Matrix& P) {
    Normal<4> state{mean, P};
    Step<4> one = step;
    one.mean = step.F * mean;
    return stepBack(state, one, later, false);
  };
  const Vector other(1e-3, 1e-2, -0.2, 1.0);
  const Matrix wider = positiveDefinite(7, 3.0);
  EXPECT_NEAR(evidence(other, wider) - evidence(first.mean, first.covariance),
              logDensity(other, wider) - logDensity(first.mean, first.covariance), 1e-8);
}

TEST(StepBack, SaysThatThereIsNoWayBackFromASingularPrediction) {
  Normal<4> state{Vector::Zero(), Matrix::Zero()};
  Step<4> step = someStep();
  step.Q.setZero();
  step.mean.setZero();
  Later<4> later;
  EXPECT_FALSE(findLater(step, state.covariance, Normal<4>{Vector::Zero(), Matrix::Identity()}, later));
  later.Y = Matrix::Identity();
  later.y.setZero();
  later.origin.setZero();
  EXPECT_EQ(stepBack(state, step, later, true), kNever);
}

}  // namespace
}  // namespace sightline::core
