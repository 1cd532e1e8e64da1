#pragma once

#include <vector>

#include <Eigen/Core>

#include "sightline/core/model/sphere.h"

/// Curves and patches on the unit sphere, as lists of unit vectors. Angles are (azimuth, elevation) [rad] as
/// in core/sphere.h. A tangent vector at a direction is (along growing azimuth, along growing elevation) in
/// arc length [rad], so that wrap and zenith are ordinary places.
namespace sightline_ros {

using Directions = std::vector<Eigen::Vector3d>;

/// Unit vectors along growing azimuth and growing elevation at `angles`, 3x2.
Eigen::Matrix<double, 3, 2> tangentBasis(const Eigen::Vector2d& angles);

/// Where one arrives from `angles` along the great circle that starts as `tangent` [rad].
Eigen::Vector3d walk(const Eigen::Vector2d& angles, const Eigen::Vector2d& tangent);

/// The tangent vector at `angles` whose walk ends at `direction` [rad]; the shortest one.
Eigen::Vector2d tangentTo(const Eigen::Vector2d& angles, const Eigen::Vector3d& direction);

/// Covariance of the tangent vector [rad^2] of a covariance over (azimuth, elevation) at `angles`.
/// At a pole the azimuth's variance is huge and its circle small; their product is taken with the floor that
/// core::anglesJacobian has.
Eigen::Matrix2d tangentCovariance(const Eigen::Vector2d& angles, const Eigen::Matrix2d& covariance);

/// Half axes of the 1-sigma ellipse of a 2x2 covariance, the larger one first [its unit's root].
Eigen::Vector2d semiAxes(const Eigen::Matrix2d& covariance);

/// Closed outline (the first point again at the end) of the `sigmas`-sigma ellipse of a tangent covariance
/// round `angles`; `corners` points.
Directions ellipseOutline(const Eigen::Vector2d& angles, const Eigen::Matrix2d& tangent_covariance,
                          double sigmas, int corners = 48);

/// Closed circle of `radius` [rad] round `angles`.
Directions circleOutline(const Eigen::Vector2d& angles, double radius, int corners = 48);

/// The line of (azimuth, elevation) pairs from `from` to `to`, straight in these two angles (a parallel or a
/// meridian when one of them stays), in steps of at most `step` [rad]. Ends included.
Directions gridLine(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double step);

/// A rectangle in azimuth and elevation: centre and half widths [rad], cut at the poles and at one full turn.
struct AngleRectangle {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  Eigen::Vector2d half_width = Eigen::Vector2d::Zero();
};

/// Its closed outline, in steps of at most `step` [rad].
Directions rectangleOutline(const AngleRectangle& rectangle, double step);

/// Its surface as triangles, three directions each, in steps of at most `step` [rad] and at most 24 steps
/// along each side.
Directions rectanglePatch(const AngleRectangle& rectangle, double step);

}  // namespace sightline_ros
