#pragma once

#include <optional>

#include <Eigen/Core>

#include "sightline/core/model/sighting.h"

/// Sightings from what sensors measure: points, rays, directions. All in one frame.
namespace sightline::core {

/// The direction in which a point is seen from the origin, with the part of its covariance across the line of
/// sight: C_d = T C T' / r^2, T = I - d d'. A ray of any length with the covariance of its tip is such a
/// point. `point` and `covariance` in the same unit of length and its square. nullopt when the point has no
/// direction (not finite, or zero), or when the covariance does not say how well it is known across the line
/// of sight (not finite, or not positive definite there; 0 and negative ones among them).
std::optional<Sighting> sightingOfPoint(const Eigen::Vector3d& point, const Eigen::Matrix3d& covariance);

/// A direction of any length with stated standard deviations `sigma` [rad] across the line of sight: along
/// the azimuth and along the elevation, both as arcs on the sphere. nullopt when the vector has no direction.
std::optional<Sighting> sightingAlong(const Eigen::Vector3d& direction, const Eigen::Vector2d& sigma);

/// Whether a vector says where something is: finite and not zero.
bool hasDirection(const Eigen::Vector3d& vector);

/// Maps a camera's optical frame (x right, y down, z forward) to its boresight frame (x forward, y left, z
/// up), whose azimuth and elevation are far from the pole where the camera looks.
Eigen::Matrix3d R_boresight_optical();

}  // namespace sightline::core
