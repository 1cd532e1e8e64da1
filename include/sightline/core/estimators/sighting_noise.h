#pragma once

#include <tuple>

#include <Eigen/Core>

namespace sightline::core {

/// The noise of the sightings of one track, as the yardstick of settings that are free of scale: a process
/// noise of `ratio` times this makes a filter of the same gain at a sigma of 10 microradian and of 0.1 rad.
///
/// It is the harmonic mean of the sightings' covariances, smoothed over the last of them: the covariance of a
/// sighting that tells as much as those do on average. A coarse sensor that joins a fine one hardly changes
/// it, and a fine one that joins coarse ones does at once.
class SightingNoise {
 public:
  /// `R` covariance of a sighting's chart coordinates [rad^2], positive definite; or of the mean of so many
  /// `sightings`, > 0, which then count one by one.
  void add(const Eigen::Matrix2d& R, double sightings = 1.0);

  /// The mean [rad^2]; before the first sighting zero.
  const Eigen::Matrix2d& covariance() const { return covariance_; }

  /// Goes over to coordinates that answer to the old ones with `J`.
  void transform(const Eigen::Matrix2d& J);

 private:
  Eigen::Matrix2d information_ = Eigen::Matrix2d::Zero();
  Eigen::Matrix2d covariance_ = Eigen::Matrix2d::Zero();
  double sightings_ = 0.0;  // of those that count in the mean
};

/// White process noise, absolute or in proportion to the sightings' noise. What is in proportion is per unit
/// of time, which is a second for sensors of more than three sightings a second (RevisitTime).
struct ProcessNoise {
  double density =
      0.0;             ///< spectral density [rad^2/s^3] (acceleration) or [rad^2/s^5] (jerk); 0 = by `ratio`
  double ratio = 0.0;  ///< density / sigma^2 of the sightings [1/unit^3] or [1/unit^5], where `density` is 0

  /// Spectral density of white acceleration in both channels, 2x2 [rad^2/s^3]; `sighting_noise` is that of a
  /// typical sighting [rad^2], `unit` the unit of time [s].
  Eigen::Matrix2d accelerationFor(const Eigen::Matrix2d& sighting_noise, double unit) const {
    return densityFor(sighting_noise, unit * unit * unit);
  }

  /// The same of white jerk [rad^2/s^5].
  Eigen::Matrix2d jerkFor(const Eigen::Matrix2d& sighting_noise, double unit) const {
    return densityFor(sighting_noise, unit * unit * unit * unit * unit);
  }

 private:
  Eigen::Matrix2d densityFor(const Eigen::Matrix2d& sighting_noise, double per) const {
    if (density > 0.0) return density * Eigen::Matrix2d::Identity();
    return ratio / per * sighting_noise;
  }

  friend bool operator==(const ProcessNoise& a, const ProcessNoise& b) {
    return std::tie(a.density, a.ratio) == std::tie(b.density, b.ratio);
  }
};

/// Spectral density of white acceleration in both channels, 2x2 [rad^2/s^3], of a target that passes by in
/// space, however steadily: its angular rates change by a share of the rates themselves for every radian that
/// it moves on. What a look every 30 ms follows as it comes is far beyond the sightings' noise in ten
/// seconds: it counts for sensors whose unit of time (RevisitTime) is above one second. `rates` [rad/s],
/// `unit` [s].
Eigen::Matrix2d passingAcceleration(const Eigen::Vector2d& rates, double unit);

}  // namespace sightline::core
