#pragma once

#include <Eigen/Core>

namespace sightline::core {

/// Posterior Cramer-Rao bound of a target's position and velocity (P-12): what no estimator can be better
/// than in the mean, for white acceleration and directions of white noise (Tichavsky, Muravchik and Nehorai
/// 1998). The measurements are taken where the target truly is.
class PositionBound {
 public:
  /// Nothing is known at first but to these standard deviations [m, m/s], > 0.
  PositionBound(double position_sigma, double velocity_sigma);

  /// `h` >= 0 seconds on, with white acceleration of density `q` [m^2/s^3] along each axis.
  void predict(double h, double q);

  /// A direction from `origin` to the target, each angle with this variance [rad^2], > 0.
  void see(const Eigen::Vector3d& origin, const Eigen::Vector3d& target, double variance);

  /// Least covariance over (position [m], velocity [m/s]).
  Eigen::Matrix<double, 6, 6> covariance() const;

 private:
  Eigen::Matrix<double, 6, 6> information_;
};

}  // namespace sightline::core
