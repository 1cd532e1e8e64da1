#include "sightline/core/positions/position_bound.h"

#include <stdexcept>

#include <Eigen/Cholesky>

#include "sightline/core/model/sphere.h"
#include "sightline/core/positions/rays.h"

namespace sightline::core {
namespace {

using Matrix6d = Eigen::Matrix<double, 6, 6>;

Matrix6d inverse(const Matrix6d& P) {
  // Scaled to a unit diagonal: metres and metres per second differ by orders.
  const Eigen::Matrix<double, 6, 1> scale = P.diagonal().cwiseSqrt().cwiseInverse();
  const Matrix6d scaled = scale.asDiagonal() * P * scale.asDiagonal();
  return symmetric(scale.asDiagonal() * scaled.llt().solve(Matrix6d::Identity()) * scale.asDiagonal());
}

}  // namespace

PositionBound::PositionBound(double position_sigma, double velocity_sigma) {
  if (!(position_sigma > 0.0 && velocity_sigma > 0.0))
    throw std::invalid_argument("PositionBound: standard deviations > 0 are required");
  information_.setZero();
  information_.diagonal().head<3>().setConstant(1.0 / (position_sigma * position_sigma));
  information_.diagonal().tail<3>().setConstant(1.0 / (velocity_sigma * velocity_sigma));
}

void PositionBound::predict(double h, double q) {  // (P-12)
  Matrix6d F = Matrix6d::Identity(), P = inverse(information_);
  F.topRightCorner<3, 3>().diagonal().setConstant(h);
  P = (F * P * F.transpose()).eval();
  for (int i = 0; i < 3; ++i) {
    P(i, i) += q * h * h * h / 3.0;
    P(i, 3 + i) += q * h * h / 2.0;
    P(3 + i, i) += q * h * h / 2.0;
    P(3 + i, 3 + i) += q * h;
  }
  information_ = inverse(P);
}

void PositionBound::see(const Eigen::Vector3d& origin, const Eigen::Vector3d& target, double variance) {
  const Eigen::Vector3d r = target - origin;
  const Eigen::Matrix<double, 2, 3> H = acrossBasis(r.normalized()) / r.norm();
  information_.topLeftCorner<3, 3>() += H.transpose() * H / variance;
}

Matrix6d PositionBound::covariance() const {
  return inverse(information_);
}

}  // namespace sightline::core
