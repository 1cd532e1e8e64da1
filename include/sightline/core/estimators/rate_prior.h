#pragma once

#include <Eigen/Core>

#include "sightline/core/model/sphere.h"

namespace sightline::core {

/// What is known of the rates of a target that has been seen once: nothing, not even their size. A mixture of
/// normal distributions with zero mean, their standard deviations evenly on the scale of logarithms, from
/// what the noise of two looks hides, or a star's 1e-7 rad/s, to 30 rad/s of what flies by (S-92).
///
/// `logDensity...` are densities in the coordinates of a chart; each angle's rate has the same prior.
namespace rate_prior {

/// ln of the density with which a target at a position of covariance `R` [rad^2] is seen, `h` seconds
/// earlier or later, `offset` [rad] from it; R holds the noise of both sightings [1/rad^2].
double logDensityOfOffset(const Eigen::Vector2d& offset, const Eigen::Matrix2d& R, double h);

/// A distance [rad] beyond which that density is surely less than `log_density`, for every R that is `least`
/// and something more of at most this `trace` [rad^2]; 0 where it is nowhere as large.
double reach(double log_density, const Eigen::Matrix2d& least, double trace, double h);

/// ln of the density of rates [rad/s] that are known with covariance `P` [1/(rad/s)^2].
double logDensityOfRates(const Eigen::Vector2d& rates, const Eigen::Matrix2d& P);

/// Root mean square of each rate before anything is known [rad/s].
double sigma();

/// The same after two sightings `offset` [rad] and `h` > 0 seconds apart: the root of the mean square of the
/// rates by all components, as these are probable now. `R`: the sum of both sightings' covariances [rad^2].
double sigma(const Eigen::Vector2d& offset, const Eigen::Matrix2d& R, double h);

}  // namespace rate_prior

/// Standard deviation of each rate of a new target, as an estimator uses it: as it was given, or by the
/// evidence of the first two sightings. Plain state.
class InitialRate {
 public:
  /// `sigma`: of each rate [rad/s], >= 0; 0 = not known.
  explicit InitialRate(double sigma) : sigma_(sigma), is_open_(sigma == 0.0) {
    if (is_open_) sigma_ = rate_prior::sigma();
  }

  double sigma() const { return sigma_; }
  double variance() const { return sigma_ * sigma_; }

  /// The sightings that come `h` seconds after the first tell; `offset` and `R` as in rate_prior::sigma.
  /// Sightings of one instant tell nothing.
  void learn(const Eigen::Vector2d& offset, const Eigen::Matrix2d& R, double h);

  /// Whether the second sighting is waited for.
  bool isOpen() const { return is_open_; }

  /// What is known, while it is waited for, `h` seconds after a sighting at `position` of covariance `R`: no
  /// more than that the target is on the sphere, one radian from there.
  AngularState stateAfter(double h, const Eigen::Vector2d& position, const Eigen::Matrix2d& R) const;

 private:
  double sigma_;
  bool is_open_;
};

}  // namespace sightline::core
