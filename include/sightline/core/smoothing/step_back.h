#pragma once

#include <cmath>

#include <Eigen/Core>

#include "sightline/core/model/sphere.h"

/// One step back of a linear(ised) motion of N states by what later sightings say (Rauch, Tung, Striebel
/// 1965), in the form in which that is kept apart from what earlier ones say (Fraser and Potter 1969): so
/// that one and the same message from later goes to every state that may have led there.
namespace sightline::core {

constexpr double kNever = -1e300;  ///< logarithm of the evidence for what cannot be

/// Mean and covariance of a channel's state, or of both one after the other.
template <int N>
struct Normal {
  Eigen::Matrix<double, N, 1> mean;
  Eigen::Matrix<double, N, N> covariance;
};

/// What later sightings say of such a state x: log density -1/2 d^T Y d + y^T d + const of d = x - origin.
template <int N>
struct Later {
  Eigen::Matrix<double, N, 1> origin, y;
  Eigen::Matrix<double, N, N> Y;
};

/// A linearised step of such a state.
template <int N>
struct Step {
  Eigen::Matrix<double, N, 1> mean;  // after
  Eigen::Matrix<double, N, N> F, Q;
};

/// Inverse of a symmetric positive definite matrix by Cholesky's factors, A = L L^T. Written out, as such
/// small matrices take Eigen's general solver several times as long, and smoothing is little else.
template <int N>
struct Inverse {
  Eigen::Matrix<double, N, N> matrix;
  double log_root = 0.0;  // of A's determinant
  bool exists = false;

  explicit Inverse(const Eigen::Matrix<double, N, N>& A) {
    double L[N][N], M[N][N];  // M = L^-1
    for (int j = 0; j < N; ++j) {
      double pivot = A(j, j);
      for (int k = 0; k < j; ++k) pivot -= L[j][k] * L[j][k];
      if (!(pivot > 0.0)) return;
      L[j][j] = std::sqrt(pivot);
      M[j][j] = 1.0 / L[j][j];
      for (int i = j + 1; i < N; ++i) {
        double sum = A(i, j);
        for (int k = 0; k < j; ++k) sum -= L[i][k] * L[j][k];
        L[i][j] = sum * M[j][j];
      }
    }
    double root = 1.0;
    for (int j = 0; j < N; ++j) {
      root *= L[j][j];
      for (int i = j + 1; i < N; ++i) {
        double sum = 0.0;
        for (int k = j; k < i; ++k) sum -= L[i][k] * M[k][j];
        M[i][j] = sum * M[i][i];
      }
    }
    for (int i = 0; i < N; ++i) {
      for (int j = i; j < N; ++j) {
        double sum = 0.0;
        for (int k = j; k < N; ++k) sum += M[k][i] * M[k][j];
        matrix(i, j) = matrix(j, i) = sum;
      }
    }
    log_root = std::log(root);
    exists = true;
  }
};

/// A state's covariance before a step times F^T, and its covariance after.
template <int N>
struct Predicted {
  Eigen::Matrix<double, N, N> FP, covariance;
};

template <int N>
Predicted<N> predictedBy(const Step<N>& step, const Eigen::Matrix<double, N, N>& P) {
  Predicted<N> predicted;
  predicted.FP = step.F * P;
  predicted.covariance = predicted.FP * step.F.transpose() + step.Q;
  return predicted;
}

/// What is known at the end of a step by later sightings alone: the quotient of what is known by all and of
/// what was predicted. Returns whether there is such a thing.
template <int N>
bool findLater(const Step<N>& step, const Eigen::Matrix<double, N, N>& P, const Normal<N>& smoothed,
               Later<N>& later) {  // (S-144)
  const Inverse<N> predicted(predictedBy(step, P).covariance), known(smoothed.covariance);
  if (!predicted.exists || !known.exists) return false;
  later.origin = step.mean;
  later.y = known.matrix * (smoothed.mean - step.mean);
  later.Y = known.matrix - predicted.matrix;
  return true;
}

/// The state before a step, given what later sightings say of the state after: the recursion of Rauch, Tung
/// and Striebel. Returns the logarithm of the evidence, the density of those sightings but for a factor;
/// kNever where the numbers do not allow it. The covariance in a form that stays positive: P - G (P+ - P_s)
/// G^T written as (I - G F) P (I - G F)^T + G (P_s + Q) G^T.
template <int N>
double stepBack(Normal<N>& state, const Step<N>& step, const Later<N>& later, bool want_state) {  // (S-143)
  using Matrix = Eigen::Matrix<double, N, N>;
  using Vector = Eigen::Matrix<double, N, 1>;
  const Predicted<N> after = predictedBy(step, state.covariance);
  const Inverse<N> predicted(after.covariance);
  if (!predicted.exists) return kNever;
  const Inverse<N> both(predicted.matrix + later.Y);
  if (!both.exists) return kNever;
  const Vector offset = step.mean - later.origin;
  const Vector pull = later.y - later.Y * offset;  // gradient at the predicted mean
  const Vector shift = both.matrix * pull;
  const double evidence = 0.5 * pull.dot(shift) + offset.dot(later.y - 0.5 * later.Y * offset) -
                          predicted.log_root - both.log_root;
  if (!want_state) return evidence;
  const Matrix G = after.FP.transpose() * predicted.matrix;
  const Matrix kept = Matrix::Identity() - G * step.F;
  const Matrix kept_P = kept * state.covariance, G_later = G * (both.matrix + step.Q);
  state.mean += G * shift;
  state.covariance = symmetric(Matrix(kept_P * kept.transpose() + G_later * G.transpose()));
  return evidence;
}

}  // namespace sightline::core
