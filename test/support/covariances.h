#pragma once

#include <Eigen/Core>
#include <gtest/gtest.h>

/// What makes a matrix a covariance. Not inline: Eigen's solver is compiled once, not in every test that
/// asks.
namespace sightline::test {

/// Of a symmetric matrix, of which the lower half is read; in ascending order.
Eigen::VectorXd eigenvaluesOf(const Eigen::MatrixXd& symmetric);

inline double leastEigenvalue(const Eigen::MatrixXd& symmetric) {
  return eigenvaluesOf(symmetric)(0);
}

/// Finite, symmetric, and positive definite by more than rounding once the variances are scaled to one.
testing::AssertionResult isCovariance(const Eigen::MatrixXd& P);

}  // namespace sightline::test
