#include "sightline/core/positions/position_belief.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "sightline/core/model/sphere.h"

namespace sightline::core {
namespace {

using Matrix23d = Eigen::Matrix<double, 2, 3>;
using Columns = Eigen::Matrix<double, Eigen::Dynamic, 2, 0, kMostStates, 2>;
using Rows = Eigen::Matrix<double, 2, Eigen::Dynamic, 0, 2, kMostStates>;
using Matrix9d = Eigen::Matrix<double, kMotionSize, kMotionSize>;

constexpr int kMostIterations = 4;
constexpr double kIterationTolerance = 1e-3;  // of the last step, in standard deviations of the position

/// Two unit vectors across `v` next to those of a basis.
Matrix23d basisNear(const Matrix23d& basis, const Eigen::Vector3d& v) {
  Matrix23d B = basis - basis * v * v.transpose();
  B.row(0).normalize();
  B.row(1) -= B.row(1).dot(B.row(0)) * B.row(0);
  B.row(1).normalize();
  return B;
}

/// P <- (I - K H) P (I - K H)^T + K R K^T (S-7), for any gain K; `HP` = H P.
void joseph(PositionMatrix& P, const Columns& K, const Rows& H, const Rows& HP, const Eigen::Matrix2d& R) {
  PositionMatrix AP = P;
  AP.noalias() -= K * HP;
  const Columns APH = AP * H.transpose();
  AP.noalias() -= APH * K.transpose();
  const Columns KR = K * R;
  AP.noalias() += KR * K.transpose();
  P = 0.5 * (AP + AP.transpose());
}

/// Noise of an innovation that is too far out: enlarged until it is at the limit (P-5).
Eigen::Matrix2d downWeighted(const Eigen::Matrix2d& R, double distance_squared, double outlier_distance) {
  const double limit = outlier_distance * outlier_distance;
  return distance_squared > limit ? (R * (distance_squared / limit)).eval() : R;
}

}  // namespace

void addSlot(PositionBelief& belief, double variance) {
  const Eigen::Index n = belief.mean.size();
  belief.mean.conservativeResize(n + 2);
  belief.mean.tail<2>().setZero();
  belief.covariance.conservativeResize(n + 2, n + 2);
  belief.covariance.rightCols<2>().setZero();
  belief.covariance.bottomRows<2>().setZero();
  belief.covariance(n, n) = belief.covariance(n + 1, n + 1) = variance;
}

void removeSlot(PositionBelief& belief, int slot) {
  const Eigen::Index n = belief.mean.size(), at = kMotionSize + 2 * slot, behind = n - at - 2;
  PositionVector& x = belief.mean;
  PositionMatrix& P = belief.covariance;
  for (Eigen::Index i = at; i < at + behind; ++i) x(i) = x(i + 2);
  for (Eigen::Index i = at; i < at + behind; ++i) P.row(i) = P.row(i + 2).eval();
  for (Eigen::Index i = at; i < at + behind; ++i) P.col(i) = P.col(i + 2).eval();
  x.conservativeResize(n - 2);
  P.conservativeResize(n - 2, n - 2);
}

void predict(PositionBelief& belief, const PositionModel& model, double unit_squared, double h,
             const std::array<SlowError, kMostStations>& slow) {  // (P-4)
  PositionVector& x = belief.mean;
  PositionMatrix& P = belief.covariance;
  const double q = model.ratio * unit_squared, h2 = h * h, h3 = h2 * h;
  const bool is_jerk = model.kind == PositionModel::Kind::white_jerk;

  x.segment<3>(0) += h * x.segment<3>(3);
  P.middleRows<3>(0) += h * P.middleRows<3>(3);
  if (is_jerk) {
    x.segment<3>(0) += 0.5 * h2 * x.segment<3>(6);
    x.segment<3>(3) += h * x.segment<3>(6);
    P.middleRows<3>(0) += 0.5 * h2 * P.middleRows<3>(6);
    P.middleRows<3>(3) += h * P.middleRows<3>(6);
  }
  P.middleCols<3>(0) += h * P.middleCols<3>(3);
  if (is_jerk) {
    P.middleCols<3>(0) += 0.5 * h2 * P.middleCols<3>(6);
    P.middleCols<3>(3) += h * P.middleCols<3>(6);
    for (int i = 0; i < 3; ++i) {
      P(i, i) += q * h3 * h2 / 20.0;
      P(i, 3 + i) += q * h2 * h2 / 8.0;
      P(3 + i, i) += q * h2 * h2 / 8.0;
      P(i, 6 + i) += q * h3 / 6.0;
      P(6 + i, i) += q * h3 / 6.0;
      P(3 + i, 3 + i) += q * h3 / 3.0;
      P(3 + i, 6 + i) += q * h2 / 2.0;
      P(6 + i, 3 + i) += q * h2 / 2.0;
      P(6 + i, 6 + i) += q * h;
    }
  } else {
    for (int i = 0; i < 3; ++i) {
      P(i, i) += q * h3 / 3.0;
      P(i, 3 + i) += q * h2 / 2.0;
      P(3 + i, i) += q * h2 / 2.0;
      P(3 + i, 3 + i) += q * h;
    }
    x.segment<3>(6).setZero();  // not of this model; what models that know it may expect after one second
    P.middleRows<3>(6).setZero();
    P.middleCols<3>(6).setZero();
    P.diagonal().segment<3>(6).setConstant(q);
  }
  for (int slot = 0; slot < belief.slots(); ++slot) {
    const SlowError& error = slow[static_cast<std::size_t>(slot)];
    const double phi = std::exp(-h / error.time_constant);
    for (Eigen::Index i = kMotionSize + 2 * slot; i < kMotionSize + 2 * slot + 2; ++i) {
      x(i) *= phi;
      P.row(i) *= phi;
      P.col(i) *= phi;
      P(i, i) += error.variance * (1.0 - phi * phi);
    }
  }
}

UpdateResult update(PositionBelief& belief, const DirectionUpdate& seen, double outlier_distance) {  // (P-5)
  UpdateResult result;
  const Eigen::Index n = belief.mean.size(), at = kMotionSize + 2 * seen.slot;
  const PositionVector prior = belief.mean;
  PositionVector x = prior;
  Rows H = Rows::Zero(2, n), HP;
  Columns K;
  Eigen::Matrix2d R = seen.R;
  for (int iteration = 0; iteration < kMostIterations; ++iteration) {
    const Eigen::Vector3d r =
        x.head<3>() - seen.age * x.segment<3>(3) + 0.5 * seen.age * seen.age * x.segment<3>(6) - seen.origin;
    const double range = r.norm();
    const Eigen::Vector3d v = r / range;
    const double cosine = seen.direction.dot(v);
    if (!(cosine > 0.1)) {
      result.is_behind = iteration == 0;
      if (result.is_behind) return result;
      break;  // the last step went too far; what was there before it stands
    }
    const Matrix23d B = basisNear(seen.basis, v);
    H.leftCols<3>() = B / range;
    H.middleCols<3>(3) = -seen.age / range * B;
    H.middleCols<3>(6) = 0.5 * seen.age * seen.age / range * B;
    Eigen::Vector2d residual = B * seen.direction / cosine;
    if (seen.slot >= 0) {
      H.middleCols<2>(at).setIdentity();
      residual -= x.segment<2>(at);
    }
    residual += H * (x - prior);  // (20I): linearised at x, told from the prior
    HP.noalias() = H * belief.covariance;
    const Eigen::Matrix2d HPH = symmetric(HP * H.transpose());
    Eigen::LLT<Eigen::Matrix2d> S(HPH + R);
    if (iteration == 0) {
      result.distance_squared = residual.dot(S.solve(residual));
      const double root = S.matrixLLT()(0, 0) * S.matrixLLT()(1, 1);
      result.log_determinant = 2.0 * std::log(root);
      R = downWeighted(R, result.distance_squared, outlier_distance);
      if (R != seen.R) S.compute(HPH + R);
    }
    K = S.solve(HP).transpose();
    const PositionVector next = prior + K * residual;
    const double step = (next - x).head<3>().norm();
    x = next;
    if (step * step <
        kIterationTolerance * kIterationTolerance * belief.covariance.diagonal().head<3>().sum())
      break;
  }
  belief.mean = x;
  joseph(belief.covariance, K, H, HP, R);
  return result;
}

UpdateResult updateAlone(PositionBelief& belief, const DirectionUpdate& seen,
                         double outlier_distance) {  // (P-6)
  UpdateResult result;
  const Eigen::Index n = belief.mean.size(), at = kMotionSize + 2 * seen.slot;
  PositionVector& x = belief.mean;
  PositionMatrix& P = belief.covariance;
  const Eigen::Vector3d r = x.head<3>() - seen.origin;
  const double range = r.norm();
  const Eigen::Vector3d v = r / range;
  const double half_age_squared = 0.5 * seen.age * seen.age;
  // Where it was, over the range.
  const Eigen::Vector3d old_r =
      v - seen.age / range * x.segment<3>(3) + half_age_squared / range * x.segment<3>(6);
  const Eigen::Vector3d old_v = old_r.normalized();
  const double cosine = seen.direction.dot(old_v);
  if (!(cosine > 0.1)) {
    result.is_behind = true;
    return result;
  }
  const Matrix23d B = basisNear(seen.basis, v), old_B = basisNear(seen.basis, old_v) / old_r.norm();

  // To (turn across 2, log range, velocity/range, acceleration/range).
  Matrix9d J = Matrix9d::Zero();
  J.block<2, 3>(0, 0) = B / range;
  J.block<1, 3>(2, 0) = v.transpose() / range;
  J.block<3, 3>(3, 0) = -x.segment<3>(3) * v.transpose() / (range * range);
  J.block<3, 3>(6, 0) = -x.segment<3>(6) * v.transpose() / (range * range);
  J.diagonal().tail<6>().setConstant(1.0 / range);
  P.topRows<kMotionSize>() = (J * P.topRows<kMotionSize>()).eval();
  P.leftCols<kMotionSize>() = (P.leftCols<kMotionSize>() * J.transpose()).eval();

  Rows H = Rows::Zero(2, n);
  H.leftCols<2>() = old_B * B.transpose();
  H.middleCols<3>(3) = -seen.age * old_B;
  H.middleCols<3>(6) = half_age_squared * old_B;
  Eigen::Vector2d residual = old_r.norm() * old_B * seen.direction / cosine;
  if (seen.slot >= 0) {
    H.middleCols<2>(at).setIdentity();
    residual -= x.segment<2>(at);
  }
  Rows HP;
  HP.noalias() = H * P;
  const Eigen::Matrix2d HPH = symmetric(HP * H.transpose());
  Eigen::LLT<Eigen::Matrix2d> S(HPH + seen.R);
  result.distance_squared = residual.dot(S.solve(residual));
  result.log_determinant = 2.0 * std::log(S.matrixLLT()(0, 0) * S.matrixLLT()(1, 1));
  const Eigen::Matrix2d R = downWeighted(seen.R, result.distance_squared, outlier_distance);
  S.compute(HPH + R);
  Columns K = S.solve(HP).transpose();
  const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - v * v.transpose();
  K.row(2).setZero();  // no gain along the ray
  K.middleRows<3>(3) = (across * K.middleRows<3>(3)).eval();
  K.middleRows<3>(6) = (across * K.middleRows<3>(6)).eval();
  joseph(P, K, H, HP, R);

  const PositionVector change = K * residual;
  const Eigen::Vector3d turned = (v + B.transpose() * change.head<2>()).normalized();
  x.tail(n - kMotionSize) += change.tail(n - kMotionSize);
  x.head<3>() = seen.origin + range * turned;
  x.segment<6>(3) += range * change.segment<6>(3);

  // And back, about the new line of sight.
  Matrix9d G = Matrix9d::Zero();
  const Matrix23d turned_basis = basisNear(B, turned);
  G.block<3, 2>(0, 0) = range * turned_basis.transpose();
  G.block<3, 1>(0, 2) = range * turned;
  G.block<6, 1>(3, 2) = x.segment<6>(3);
  G.diagonal().tail<6>().setConstant(range);
  P.topRows<kMotionSize>() = (G * P.topRows<kMotionSize>()).eval();
  P.leftCols<kMotionSize>() = (P.leftCols<kMotionSize>() * G.transpose()).eval();
  P = (0.5 * (P + P.transpose())).eval();
  return result;
}

}  // namespace sightline::core
