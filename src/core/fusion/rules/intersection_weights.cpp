#include "sightline/core/fusion/rules/intersection_weights.h"

#include <cmath>
#include <limits>

#include <Eigen/Cholesky>
#include <Eigen/LU>

namespace sightline::core {
namespace {

/// From one to the next the minimum moves little; n times the last is the distance from the optimum.
constexpr double kBarriers[] = {1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9};
constexpr int kHalvings = 40;
constexpr int kNewtonSteps = 50;       // for each barrier; three are usual
constexpr double kSteepEnough = 1e-4;  // of the decrease that the slope promises (Armijo)

/// -log det(sum w_i Y_i) - barrier sum log w_i on the simplex.
template <int N>
class BarrierProblem {
 public:
  using Matrix = Eigen::Matrix<double, N, N>;

  BarrierProblem(const std::vector<Matrix>& informations, double barrier)
      : informations_(informations), barrier_(barrier) {}

  /// Infinite where it is not determined.
  double valueAt(const Eigen::VectorXd& w) const {
    const Eigen::LLT<Matrix> factor(informationAt(w));
    if (factor.info() != Eigen::Success || !(w.minCoeff() > 0.0))
      return std::numeric_limits<double>::infinity();
    const Matrix L = factor.matrixL();
    const double value = -2.0 * L.diagonal().array().log().sum() - barrier_ * w.array().log().sum();
    return std::isfinite(value) ? value : std::numeric_limits<double>::infinity();
  }

  /// With P = (sum w_i Y_i)^-1: d/dw_i = -tr(P Y_i) - barrier/w_i, d2/dw_i dw_j = tr(P Y_i P Y_j) +
  /// barrier/w_i^2 (i = j).
  void derivativesAt(const Eigen::VectorXd& w, Eigen::VectorXd& gradient, Eigen::MatrixXd& hessian) const {
    const Eigen::LLT<Matrix> factor(informationAt(w));
    std::vector<Matrix> PY;
    for (const Matrix& Y : informations_) PY.push_back(factor.solve(Y));
    for (Eigen::Index i = 0; i < w.size(); ++i) {
      const Matrix& PY_i = PY[static_cast<std::size_t>(i)];
      gradient(i) = -PY_i.trace() - barrier_ / w(i);
      for (Eigen::Index j = 0; j <= i; ++j) {
        hessian(i, j) = PY_i.cwiseProduct(PY[static_cast<std::size_t>(j)].transpose()).sum();
        hessian(j, i) = hessian(i, j);
      }
      hessian(i, i) += barrier_ / (w(i) * w(i));
    }
  }

 private:
  Matrix informationAt(const Eigen::VectorXd& w) const {
    Matrix Y = Matrix::Zero();
    for (Eigen::Index i = 0; i < w.size(); ++i) Y += w(i) * informations_[static_cast<std::size_t>(i)];
    return Y;
  }

  const std::vector<Matrix>& informations_;
  double barrier_;
};

/// Newton's step within the plane of constant sum, from the first-order conditions
/// [H 1; 1^T 0] [step; multiplier] = [-gradient; 0], in the coordinates step_i / w_i in which H is well
/// scaled.
Eigen::VectorXd newtonStep(const Eigen::VectorXd& w, const Eigen::VectorXd& gradient,
                           const Eigen::MatrixXd& hessian) {
  const Eigen::Index n = w.size();
  Eigen::MatrixXd conditions = Eigen::MatrixXd::Zero(n + 1, n + 1);
  conditions.topLeftCorner(n, n) = w.asDiagonal() * hessian * w.asDiagonal();
  conditions.topRightCorner(n, 1) = w;
  conditions.bottomLeftCorner(1, n) = w.transpose();
  Eigen::VectorXd right = Eigen::VectorXd::Zero(n + 1);
  right.head(n) = -w.cwiseProduct(gradient);
  return w.cwiseProduct(conditions.partialPivLu().solve(right).head(n));
}

/// The first of the lengths 1, 1/2, 1/4, ... that lowers the value enough; 0 where rounding leaves no better
/// point.
template <int N>
double stepLength(const BarrierProblem<N>& problem, const Eigen::VectorXd& w, const Eigen::VectorXd& step,
                  double slope) {
  const double value = problem.valueAt(w);
  double length = 1.0;
  for (int halving = 0; halving < kHalvings; ++halving) {
    const double there = problem.valueAt(w + length * step);
    if (std::isfinite(there) && there <= value + kSteepEnough * length * slope) return length;
    length *= 0.5;
  }
  return 0.0;
}

/// Goes to the minimum for one barrier by damped Newton steps; stays inside the simplex.
template <int N>
void descend(const BarrierProblem<N>& problem, double tolerance, Eigen::VectorXd& w) {
  Eigen::VectorXd gradient(w.size());
  Eigen::MatrixXd hessian(w.size(), w.size());
  for (int step_number = 0; step_number < kNewtonSteps; ++step_number) {
    problem.derivativesAt(w, gradient, hessian);
    const Eigen::VectorXd step = newtonStep(w, gradient, hessian);
    const double slope = gradient.dot(step);
    if (!(slope < -tolerance)) return;
    const double length = stepLength(problem, w, step, slope);
    if (length == 0.0) return;
    w += length * step;
    w /= w.sum();
  }
}

}  // namespace

template <int N>
Eigen::VectorXd determinantWeights(const std::vector<Eigen::Matrix<double, N, N>>& informations) {
  const auto n = static_cast<Eigen::Index>(informations.size());
  Eigen::VectorXd w = Eigen::VectorXd::Constant(n, 1.0 / static_cast<double>(n));
  if (n < 2) return w;
  for (const double barrier : kBarriers) descend(BarrierProblem<N>(informations, barrier), 1e-3 * barrier, w);
  return w;
}

template Eigen::VectorXd determinantWeights<2>(const std::vector<Eigen::Matrix2d>&);
template Eigen::VectorXd determinantWeights<4>(const std::vector<Eigen::Matrix4d>&);

}  // namespace sightline::core
