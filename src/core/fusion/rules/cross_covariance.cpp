#include "sightline/core/fusion/rules/cross_covariance.h"

#include <algorithm>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "sightline/core/model/kinematics.h"

namespace sightline::core {
namespace {

Eigen::Index at(std::size_t source) {
  return 4 * static_cast<Eigen::Index>(source);
}

/// A = P+ (P-)^-1 as an operator that never enlarges an error. With P- = L L^T it is L M L^-1,
/// M = L^-1 P+ L^-T, and M's eigenvalues are at most 1 where sightings made the track surer.
Eigen::Matrix4d contraction(const Eigen::Matrix4d& before, const Eigen::Matrix4d& after) {
  const Eigen::LLT<Eigen::Matrix4d> factor(before);
  if (factor.info() != Eigen::Success) return Eigen::Matrix4d::Identity();
  const Eigen::Matrix4d L = factor.matrixL();
  const Eigen::Matrix4d half = factor.matrixL().solve(after);
  const Eigen::Matrix4d M = symmetric(factor.matrixL().solve(half.transpose()));
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> solver(M);
  const Eigen::Matrix4d& V = solver.eigenvectors();
  const Eigen::Matrix4d clipped =
      V * solver.eigenvalues().cwiseMin(1.0).cwiseMax(0.0).asDiagonal() * V.transpose();
  const Eigen::Matrix4d LM = L * clipped;
  return factor.matrixU().solve(LM.transpose()).transpose();
}

}  // namespace

void CrossCovariance::add() {
  const Eigen::Index n = blocks_.rows();
  blocks_.conservativeResizeLike(Eigen::MatrixXd::Zero(n + 4, n + 4));
}

void CrossCovariance::remove(std::size_t source) {
  const Eigen::Index n = blocks_.rows() - 4, first = at(source), after = n - first;
  Eigen::MatrixXd rest(n, n);
  rest << blocks_.topLeftCorner(first, first), blocks_.topRightCorner(first, after),
      blocks_.bottomLeftCorner(after, first), blocks_.bottomRightCorner(after, after);
  blocks_ = rest;
}

void CrossCovariance::predict(double h, const std::vector<Eigen::Vector2d>& densities) {
  for (std::size_t j = 1; j < size(); ++j) {
    for (std::size_t i = 0; i < j; ++i) {
      Motion<4> motion{Eigen::Vector4d::Zero(), between(i, j)};
      moveOn(motion, h);
      const Eigen::Vector2d shared = densities[i].cwiseProduct(densities[j]).cwiseSqrt();
      addWhiteAcceleration(motion, shared.asDiagonal(), h);
      if (!motion.covariance.allFinite()) motion.covariance.setZero();
      blocks_.block<4, 4>(at(i), at(j)) = motion.covariance;
      blocks_.block<4, 4>(at(j), at(i)) = motion.covariance.transpose();
    }
  }
}

void CrossCovariance::update(std::size_t source, const Eigen::Matrix4d& covariance_before,
                             const Eigen::Matrix4d& covariance_after) {
  const Eigen::Matrix4d A = contraction(covariance_before, covariance_after);
  Eigen::MatrixXd rows = A * blocks_.middleRows<4>(at(source));
  if (!rows.allFinite()) rows.setZero();
  blocks_.middleRows<4>(at(source)) = rows;
  blocks_.middleCols<4>(at(source)) = rows.transpose();
}

void CrossCovariance::transform(const std::vector<Eigen::Matrix4d>& jacobians) {
  for (std::size_t i = 0; i < size(); ++i) {
    for (std::size_t j = 0; j < size(); ++j) {
      blocks_.block<4, 4>(at(i), at(j)) = (jacobians[i] * between(i, j) * jacobians[j].transpose()).eval();
    }
  }
}

Eigen::Matrix4d CrossCovariance::between(std::size_t i, std::size_t j) const {
  return blocks_.block<4, 4>(at(i), at(j));
}

Eigen::MatrixXd CrossCovariance::joint(const std::vector<Estimate<4>>& sources,
                                       const std::vector<std::size_t>& which) const {
  const std::size_t n = sources.size();
  std::vector<Eigen::LLT<Eigen::Matrix4d>> roots;  // P_i = L_i L_i^T
  roots.reserve(n);
  for (const Estimate<4>& source : sources) roots.emplace_back(source.covariance);

  // C_ij = L_i^-1 P_ij L_j^-T: the cross-covariances in units of the sources' own.
  Eigen::MatrixXd joint = Eigen::MatrixXd::Zero(at(n), at(n)), C = joint;
  for (std::size_t i = 0; i < n; ++i) {
    joint.block<4, 4>(at(i), at(i)) = sources[i].covariance;
    for (std::size_t j = 0; j < n; ++j) {
      if (i == j) continue;
      joint.block<4, 4>(at(i), at(j)) = between(which[i], which[j]);
      const Eigen::Matrix4d half = roots[i].matrixL().solve(between(which[i], which[j]));
      C.block<4, 4>(at(i), at(j)) = roots[j].matrixL().solve(half.transpose()).transpose();
    }
  }
  const Eigen::MatrixXd own = (1.0 - kLeastOwnError) * Eigen::MatrixXd::Identity(at(n), at(n));
  if (Eigen::LLT<Eigen::MatrixXd>(own + C).info() == Eigen::Success) return joint;

  const double least =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(C, Eigen::EigenvaluesOnly).eigenvalues()(0);
  const double shrink = (1.0 - kLeastOwnError) / -least;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) {
      if (i != j) joint.block<4, 4>(at(i), at(j)) *= shrink;
    }
  }
  return joint;
}

}  // namespace sightline::core
