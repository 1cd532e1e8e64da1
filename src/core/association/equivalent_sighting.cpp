#include "sightline/core/association/equivalent_sighting.h"

#include <algorithm>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "sightline/core/model/sphere.h"

namespace sightline::core {
namespace {

constexpr double kLeastReduction = 0.05;  // share of a variance that a sighting takes away at least
constexpr double kRounding = 1e-9;        // by which probabilities may exceed 1 in sum

bool isPositiveDefinite(const Eigen::Matrix2d& covariance) {
  return covariance.allFinite() && Eigen::LLT<Eigen::Matrix2d>(covariance).info() == Eigen::Success;
}

bool areUsable(const std::vector<PossibleSighting>& sightings) {
  double sum = 0.0;
  for (const PossibleSighting& sighting : sightings) {
    if (!(sighting.probability >= 0.0) || !sighting.innovation.allFinite()) return false;
    if (!isPositiveDefinite(sighting.covariance)) return false;
    sum += sighting.probability;
  }
  return sum <= 1.0 + kRounding;
}

}  // namespace

std::optional<PositionEstimate> positionAfter(const Eigen::Matrix2d& P,
                                              const std::vector<PossibleSighting>& sightings) {  // (S-36)
  if (!isPositiveDefinite(P) || !areUsable(sightings)) return std::nullopt;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero(), gained = Eigen::Matrix2d::Zero();
  for (const PossibleSighting& sighting : sightings) {
    const Eigen::LLT<Eigen::Matrix2d> S(P + sighting.covariance);
    if (S.info() != Eigen::Success) return std::nullopt;
    const Eigen::Vector2d shift = P * S.solve(sighting.innovation);
    mean += sighting.probability * shift;
    spread += sighting.probability * shift * shift.transpose();
    gained += sighting.probability * P * S.solve(P);
  }
  const Eigen::Matrix2d covariance = symmetric((P - gained + spread - mean * mean.transpose()).eval());
  if (!isPositiveDefinite(covariance)) return std::nullopt;
  return PositionEstimate{mean, covariance};
}

// (S-37)
std::optional<EquivalentSighting> equivalentSighting(const Eigen::Matrix2d& P,
                                                     const std::vector<PossibleSighting>& sightings) {
  const std::optional<PositionEstimate> after = positionAfter(P, sightings);
  EquivalentSighting equivalent;
  for (const PossibleSighting& sighting : sightings) equivalent.sightings += sighting.probability;
  if (!after || !(equivalent.sightings > 0.0)) return std::nullopt;

  // In coordinates in which P is the identity and P' is diagonal, each direction is a problem of its own.
  const Eigen::LLT<Eigen::Matrix2d> L(P);
  const Eigen::Matrix2d half = L.matrixL().solve(after->covariance);
  const Eigen::Matrix2d whitened = L.matrixL().solve(half.transpose());
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes;
  axes.computeDirect(symmetric(whitened));
  if (axes.info() != Eigen::Success) return std::nullopt;
  const Eigen::Vector2d variance = axes.eigenvalues().cwiseMin(1.0 - kLeastReduction);
  equivalent.is_exact = variance == axes.eigenvalues();
  const Eigen::Matrix2d outward = L.matrixL() * axes.eigenvectors();  // from those coordinates
  const Eigen::Vector2d shift = axes.eigenvectors().transpose() * L.matrixL().solve(after->shift);

  const Eigen::Vector2d reduction = Eigen::Vector2d::Ones() - variance;
  equivalent.innovation = outward * shift.cwiseQuotient(reduction);
  equivalent.covariance =
      symmetric((outward * variance.cwiseQuotient(reduction).asDiagonal() * outward.transpose()).eval());
  if (!isPositiveDefinite(equivalent.covariance)) return std::nullopt;
  return equivalent;
}

}  // namespace sightline::core
