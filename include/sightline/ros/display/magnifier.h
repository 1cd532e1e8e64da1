#pragma once

#include <Eigen/Core>

#include "sightline/core/model/sphere.h"
#include "sightline/ros/display/markers.h"

/// A magnified inset beside a track, for errors too small to be seen on a sphere at scale 1.
namespace sightline_ros {

class Magnifier {
 public:
  static constexpr double kRadius = 0.25;  ///< of the inset on the sphere [rad]

  /// Whether a 2-sigma half axis [rad] needs magnifying: below 0.01 rad (0.6 degrees).
  static bool isNeededFor(double two_sigma);

  /// A factor 1, 2 or 5 times a power of ten at which `two_sigma` [rad] fills 0.14 to 0.35 of the inset;
  /// `previous` (0 = none) is kept while it fills 0.1 to 0.7, so that the picture does not jump.
  static double factorFor(double two_sigma, double previous);

  /// The inset of the surroundings of `target` (azimuth, elevation) [rad], apart from it towards `side`, a
  /// unit tangent vector.
  Magnifier(const Eigen::Vector2d& target, const Eigen::Vector2d& side, double factor);

  /// Where the inset's centre is on the sphere [rad].
  const Eigen::Vector2d& centre() const { return centre_; }
  double factor() const { return factor_; }

  /// Where (azimuth, elevation) something in `direction` is shown that belongs to the moment at which the
  /// target was at `target_then`.
  Eigen::Vector2d place(const Eigen::Vector3d& direction, const Eigen::Vector2d& target_then) const;

  /// Whether a place is inside the inset.
  bool shows(const Eigen::Vector2d& place) const;

  /// A covariance over (azimuth, elevation) at `angles` as covariance of the tangent vector at its place
  /// [rad^2].
  Eigen::Matrix2d magnified(const Eigen::Vector2d& angles, const Eigen::Matrix2d& covariance) const;

  /// The part within the inset of the 2-sigma ellipse of a magnified covariance.
  void drawEllipse(Marker& lines, const Canvas& canvas, const Eigen::Vector2d& place,
                   const Eigen::Matrix2d& covariance, const Colour& colour) const;

  /// Rim, and the line that ties it to the target.
  void drawRim(Marker& lines, const Canvas& canvas, const Colour& colour) const;

  /// "x 1000, radius 0.25 mrad".
  Marker label(const Canvas& canvas, const Colour& colour) const;

 private:
  Eigen::Vector2d target_;
  Eigen::Vector2d centre_;
  double factor_;
};

}  // namespace sightline_ros
