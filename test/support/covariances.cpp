#include "support/covariances.h"

#include <Eigen/Eigenvalues>

namespace sightline::test {

Eigen::VectorXd eigenvaluesOf(const Eigen::MatrixXd& symmetric) {
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(symmetric, Eigen::EigenvaluesOnly).eigenvalues();
}

testing::AssertionResult isCovariance(const Eigen::MatrixXd& P) {
  if (!P.allFinite()) return testing::AssertionFailure() << "not finite:\n" << P;
  if (P != P.transpose()) return testing::AssertionFailure() << "not symmetric:\n" << P;
  if (!(P.diagonal().minCoeff() > 0.0)) return testing::AssertionFailure() << "no variance:\n" << P;
  const Eigen::VectorXd scale = P.diagonal().cwiseSqrt().cwiseInverse();
  const double least = leastEigenvalue(scale.asDiagonal() * P * scale.asDiagonal());
  if (least > 1e-14) return testing::AssertionSuccess();
  return testing::AssertionFailure() << "least eigenvalue of the correlations " << least << ":\n" << P;
}

}  // namespace sightline::test
