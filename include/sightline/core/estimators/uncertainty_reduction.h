#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "sightline/core/model/sphere.h"

/// The general uncertainty reduction of NOGA, equations (17)-(23) of the estimator specification: a model
/// with uncertain parameters and an uncertain measurement of its response are made to agree, and both become
/// better known. Dimensions: N parameters, M responses; each may be Eigen::Dynamic.
namespace sightline::core {

/// A model about one point: its response and how that answers to the parameters.
template <typename Scalar, int N, int M>
struct LinearModel {
  Eigen::Matrix<Scalar, N, 1> a;  ///< parameters and inputs
  Eigen::Matrix<Scalar, M, 1> q;  ///< response at `a`, in the units of the measurement
  Eigen::Matrix<Scalar, M, N> S;  ///< sensitivity dq/da at `a`
};

/// Parameters and response after the reduction. C_a, C_r, C_p are the blocks of one joint covariance that is
/// positive semidefinite; it is singular by nature, because the response has become the model's: r = q + S
/// (da).
template <typename Scalar, int N, int M>
struct ReducedUncertainty {
  Eigen::Matrix<Scalar, N, 1> a;       ///< parameters
  Eigen::Matrix<Scalar, M, 1> r;       ///< response
  Eigen::Matrix<Scalar, N, N> C_a;     ///< covariance of `a`
  Eigen::Matrix<Scalar, M, M> C_r;     ///< covariance of `r`
  Eigen::Matrix<Scalar, M, N> C_p;     ///< cov(r, a)
  Eigen::Matrix<Scalar, M, 1> lambda;  ///< Lagrange multipliers
  Scalar chi2{};  ///< lambda^T e, chi-square of M degrees when the covariances are honest
};

/// What the iteration of a nonlinear model came to.
template <typename Scalar, int N, int M>
struct IteratedReduction {
  ReducedUncertainty<Scalar, N, M> reduced;
  int iterations = 0;      ///< steps taken
  bool converged = false;  ///< the last step was shorter than the tolerance
};

/// When the iteration stops.
struct IterationLimits {
  double tolerance = 1e-10;  ///< length of a step that counts as none, in the units of the parameters
  int max_iterations = 10;
};

namespace reduction {

constexpr int sumOf(int n, int m) {
  return n == Eigen::Dynamic || m == Eigen::Dynamic ? Eigen::Dynamic : n + m;
}

/// The matrices of one reduction. As members of a class template they take no part in template deduction, so
/// that expressions may be passed for them.
template <typename Scalar, int N, int M>
struct Types {
  static constexpr int kJoint = sumOf(N, M);
  using Parameters = Eigen::Matrix<Scalar, N, 1>;
  using Response = Eigen::Matrix<Scalar, M, 1>;
  using ParameterCovariance = Eigen::Matrix<Scalar, N, N>;
  using ResponseCovariance = Eigen::Matrix<Scalar, M, M>;
  using CrossCovariance = Eigen::Matrix<Scalar, M, N>;
  using JointCovariance = Eigen::Matrix<Scalar, kJoint, kJoint>;
};

/// All of these throw std::invalid_argument.
[[noreturn]] void refuseSizes(Eigen::Index parameters, Eigen::Index responses);
[[noreturn]] void refuseCovariance(const char* name, double least_pivot);
[[noreturn]] void refuseJoint(double least_pivot);
[[noreturn]] void refuseSingularDifference();
[[noreturn]] void refuseSingularJoint();

/// Smallest pivot of the matrix scaled to a unit diagonal: not below -rounding when it is positive
/// semidefinite. NaN for a matrix that is not finite, not symmetric or has a negative diagonal.
template <typename Matrix>
double leastPivot(const Matrix& covariance) {
  using Scalar = typename Matrix::Scalar;
  const auto nan = std::numeric_limits<double>::quiet_NaN();
  const auto diagonal = covariance.diagonal();
  if (!covariance.allFinite() || !(diagonal.minCoeff() >= Scalar(0))) return nan;
  const Scalar unevenness = (covariance - covariance.transpose()).cwiseAbs().maxCoeff();
  if (unevenness > Scalar(1e3) * std::numeric_limits<Scalar>::epsilon() * diagonal.maxCoeff()) return nan;

  // A zero variance keeps its row as it is: anything but zeros in it then shows as a negative pivot.
  Eigen::Matrix<Scalar, Matrix::RowsAtCompileTime, 1> scale = diagonal.cwiseSqrt();
  scale = (scale.array() > Scalar(0)).select(scale.cwiseInverse(), Scalar(1));
  const typename Matrix::PlainObject scaled = scale.asDiagonal() * covariance * scale.asDiagonal();
  const Eigen::LDLT<typename Matrix::PlainObject> ldlt(scaled);
  return static_cast<double>(ldlt.vectorD().minCoeff());
}

template <typename Scalar>
double pivotTolerance(Eigen::Index size) {
  return -64.0 * static_cast<double>(size) * static_cast<double>(std::numeric_limits<Scalar>::epsilon());
}

/// [[C_r, C_p], [C_p^T, C_a]].
template <typename Scalar, int N, int M>
typename Types<Scalar, N, M>::JointCovariance jointOf(
    const typename Types<Scalar, N, M>::ParameterCovariance& C_a,
    const typename Types<Scalar, N, M>::ResponseCovariance& C_r,
    const typename Types<Scalar, N, M>::CrossCovariance& C_p) {
  const Eigen::Index m = C_r.rows(), n = C_a.rows();
  typename Types<Scalar, N, M>::JointCovariance C(m + n, m + n);
  C.template topLeftCorner<M, M>(m, m) = C_r;
  C.template topRightCorner<M, N>(m, n) = C_p;
  C.template bottomLeftCorner<N, M>(n, m) = C_p.transpose();
  C.template bottomRightCorner<N, N>(n, n) = C_a;
  return C;
}

/// Refuses what is no covariance, naming the block that is to blame.
template <typename Scalar, int N, int M>
void checkJoint(const typename Types<Scalar, N, M>::JointCovariance& C, Eigen::Index m, Eigen::Index n) {
  const double least = leastPivot(C);
  if (least >= pivotTolerance<Scalar>(m + n)) return;
  const double least_r = leastPivot(C.template topLeftCorner<M, M>(m, m).eval());
  if (!(least_r >= pivotTolerance<Scalar>(m))) refuseCovariance("C_r (of the measurement)", least_r);
  const double least_a = leastPivot(C.template bottomRightCorner<N, N>(n, n).eval());
  if (!(least_a >= pivotTolerance<Scalar>(n))) refuseCovariance("C_a (of the parameters)", least_a);
  refuseJoint(least);
}

}  // namespace reduction

/// (20)-(23) for a model that is linear, or linearised at model.a.
///
/// `C_a` covariance of the parameters (N x N), `r` measured response (M), `C_r` its covariance (M x M), `C_p`
/// cov(r, a) (M x N): not zero when the measurement has already served to find the parameters, for a datum
/// counted twice makes the covariances too small. The covariances come out in Joseph form (S-7): the printed
/// subtractive form loses positive definiteness for a wide prior.
///
/// Throws std::invalid_argument when [[C_r, C_p], [C_p^T, C_a]] is not positive semidefinite, when the sizes
/// do not fit, or when neither model nor measurement leaves any doubt about q - r (D not positive definite).
template <typename Scalar, int N, int M>
ReducedUncertainty<Scalar, N, M> reduceUncertainty(
    const LinearModel<Scalar, N, M>& model,
    const typename reduction::Types<Scalar, N, M>::ParameterCovariance& C_a,
    const typename reduction::Types<Scalar, N, M>::Response& r,
    const typename reduction::Types<Scalar, N, M>::ResponseCovariance& C_r,
    const typename reduction::Types<Scalar, N, M>::CrossCovariance& C_p) {
  const Eigen::Index n = model.a.size(), m = model.q.size();
  if (model.S.rows() != m || model.S.cols() != n || C_a.rows() != n || C_a.cols() != n || r.size() != m ||
      C_r.rows() != m || C_r.cols() != m || C_p.rows() != m || C_p.cols() != n) {
    reduction::refuseSizes(n, m);
  }
  constexpr int kJoint = reduction::sumOf(N, M);
  const Eigen::Matrix<Scalar, kJoint, kJoint> C = reduction::jointOf<Scalar, N, M>(C_a, C_r, C_p);
  reduction::checkJoint<Scalar, N, M>(C, m, n);

  Eigen::Matrix<Scalar, M, kJoint> G(m, m + n);  // e = q - r answers to (r, a) with G
  G.template leftCols<M>(m).setIdentity();
  G.template leftCols<M>(m) *= Scalar(-1);
  G.template rightCols<N>(n) = model.S;
  const Eigen::Matrix<Scalar, M, kJoint> GC = G * C;
  const Eigen::Matrix<Scalar, M, M> D = symmetric(GC * G.transpose());
  const Eigen::LLT<Eigen::Matrix<Scalar, M, M>> llt(D);
  if (llt.info() != Eigen::Success || !(D.diagonal().minCoeff() > Scalar(0)))
    reduction::refuseSingularDifference();

  ReducedUncertainty<Scalar, N, M> reduced;
  const Eigen::Matrix<Scalar, M, 1> e = model.q - r;
  reduced.lambda = llt.solve(e);
  reduced.chi2 = reduced.lambda.dot(e);
  const Eigen::Matrix<Scalar, kJoint, M> K = -llt.solve(GC).transpose();
  const Eigen::Matrix<Scalar, kJoint, 1> correction = K * e;  // (20)
  reduced.r = r + correction.template segment<M>(0, m);
  reduced.a = model.a + correction.template segment<N>(m, n);

  Eigen::Matrix<Scalar, kJoint, kJoint> J = K * G;  // (S-7), for (21)-(23) at once
  J.diagonal().array() += Scalar(1);
  const Eigen::Matrix<Scalar, kJoint, kJoint> C_hat = symmetric(J * C * J.transpose());
  reduced.C_r = C_hat.template topLeftCorner<M, M>(m, m);
  reduced.C_p = C_hat.template topRightCorner<M, N>(m, n);
  reduced.C_a = C_hat.template bottomRightCorner<N, N>(n, n);
  return reduced;
}

/// The same for a measurement that is independent of the parameters, C_p = 0.
template <typename Scalar, int N, int M>
ReducedUncertainty<Scalar, N, M> reduceUncertainty(
    const LinearModel<Scalar, N, M>& model,
    const typename reduction::Types<Scalar, N, M>::ParameterCovariance& C_a,
    const typename reduction::Types<Scalar, N, M>::Response& r,
    const typename reduction::Types<Scalar, N, M>::ResponseCovariance& C_r) {
  using CrossCovariance = typename reduction::Types<Scalar, N, M>::CrossCovariance;
  return reduceUncertainty(model, C_a, r, C_r, CrossCovariance::Zero(model.q.size(), model.a.size()).eval());
}

/// (20I): the reduction of a model that is not linear. `model` is called with parameters (N) and returns the
/// LinearModel there; the iteration starts at `a`, their value before the reduction.
///
/// Each step reduces about the last point; it is halved, ten times at the most, while it raises the loss
/// Q(q(a), a) = z^T C^-1 z with z = (q(a) - r, a - a_0). At convergence r = q(a).
/// Throws as reduceUncertainty does, and when [[C_r, C_p], [C_p^T, C_a]] is singular (the loss needs its
/// inverse). A model that has not converged is returned as far as it came, and says so.
template <typename Scalar, int N, int M, typename Model>
IteratedReduction<Scalar, N, M> reduceUncertaintyIterated(
    const Model& model, const Eigen::Matrix<Scalar, N, 1>& a,
    const typename reduction::Types<Scalar, N, M>::ParameterCovariance& C_a,
    const Eigen::Matrix<Scalar, M, 1>& r,
    const typename reduction::Types<Scalar, N, M>::ResponseCovariance& C_r,
    const typename reduction::Types<Scalar, N, M>::CrossCovariance& C_p, const IterationLimits& limits = {}) {
  using Joint = typename reduction::Types<Scalar, N, M>::JointCovariance;
  const Eigen::Index n = a.size(), m = r.size();
  const Eigen::LLT<Joint> joint(reduction::jointOf<Scalar, N, M>(C_a, C_r, C_p));
  if (joint.info() != Eigen::Success) reduction::refuseSingularJoint();
  const auto lossOf = [&](const LinearModel<Scalar, N, M>& at) {
    Eigen::Matrix<Scalar, reduction::sumOf(N, M), 1> z(m + n);
    z.template segment<M>(0, m) = at.q - r;
    z.template segment<N>(m, n) = at.a - a;
    return z.dot(joint.solve(z));
  };

  IteratedReduction<Scalar, N, M> result;
  LinearModel<Scalar, N, M> point = model(a);
  Scalar loss = lossOf(point);
  for (result.iterations = 1;; ++result.iterations) {
    const LinearModel<Scalar, N, M> about_prior{a, point.q + point.S * (a - point.a), point.S};
    result.reduced = reduceUncertainty(about_prior, C_a, r, C_r, C_p);

    const Scalar slack = std::abs(loss) * Scalar(16) * std::numeric_limits<Scalar>::epsilon();
    Eigen::Matrix<Scalar, N, 1> step = result.reduced.a - point.a;
    LinearModel<Scalar, N, M> next = model((point.a + step).eval());
    for (int halvings = 0; !(lossOf(next) <= loss + slack) && halvings < 10; ++halvings) {
      step *= Scalar(0.5);
      next = model((point.a + step).eval());
    }
    point = next;
    loss = lossOf(point);
    result.reduced.a = point.a;
    result.converged = static_cast<double>(step.norm()) < limits.tolerance;
    if (result.converged || result.iterations >= limits.max_iterations) return result;
  }
}

}  // namespace sightline::core
