#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

/// Probabilistic data association for any estimator: what several sightings, each with a probability to be
/// the target's, say together, as one sighting. Coordinates are those of the track's chart.
namespace sightline::core {

/// A sighting in the gate of a track.
struct PossibleSighting {
  Eigen::Vector2d innovation = Eigen::Vector2d::Zero();      ///< sighting - prediction [rad]
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity();  ///< of the sighting, R [rad^2]
  double probability = 0.0;                                  ///< that it is the target's, beta_j
};

/// A position as a Gaussian.
struct PositionEstimate {
  Eigen::Vector2d shift = Eigen::Vector2d::Zero();           ///< mean - prediction [rad]
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity();  ///< [rad^2]
};

/// The position after a scan in which one of the sightings was the target's, or none: mean and covariance of
/// the mixture of the updates by each (probabilistic data association; Bar-Shalom and Tse 1975), where the
/// target is missed with the probability that is left to 1. `P`: covariance of the predicted position
/// [rad^2]. nullopt if a covariance is not positive definite or the probabilities are not, with a sum of at
/// most 1.
std::optional<PositionEstimate> positionAfter(const Eigen::Matrix2d& P,
                                              const std::vector<PossibleSighting>& sightings);

/// One Gaussian sighting in the place of several possible ones.
struct EquivalentSighting {
  Eigen::Vector2d innovation = Eigen::Vector2d::Zero();      ///< z - prediction [rad]
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity();  ///< R [rad^2]
  double sightings = 0.0;  ///< how many sightings it counts for: the sum of the probabilities
  bool is_exact = true;    ///< an update with it gives `positionAfter` exactly
};

/// The sighting with which the linear update z = position + noise of a prediction with covariance `P` ends at
/// mean and covariance of `positionAfter`; then all of a state that is correlated with the position (rates)
/// ends where probabilistic data association ends, too:
///   R = (P'^-1 - P^-1)^-1,   innovation = (P + R) P^-1 shift.
///
/// No sighting can make a covariance larger, though sightings far apart do. In a direction (an eigenvector of
/// P' in the metric of P) in which less than a twentieth of the variance goes, a twentieth goes: the mean is
/// still exact, and the covariance smaller than that of `positionAfter`; `is_exact` is false.
/// nullopt as `positionAfter`, or if no sighting has a probability.
std::optional<EquivalentSighting> equivalentSighting(const Eigen::Matrix2d& P,
                                                     const std::vector<PossibleSighting>& sightings);

}  // namespace sightline::core
