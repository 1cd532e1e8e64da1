#pragma once

#include <cstddef>

#include <Eigen/Core>

#include <sightline/Gate.h>
#include <sightline/Track.h>
#include <sightline/TrackArray.h>

#include "sightline/core/model/sphere.h"

/// What the display asks of a track.
namespace sightline_ros {

/// Confirmed or coasting.
bool isEstablished(const sightline::Track& track);

std::size_t establishedIn(const sightline::TrackArray& report);

/// The largest standard deviation of the direction, as an arc [rad]; at least 1e-9.
double sigmaOf(const sightline::Track& track);

/// The report's track nearest to (azimuth, elevation) [rad]; nullptr when it has none.
const sightline::Track* nearestTo(const Eigen::Vector2d& angles, const sightline::TrackArray& report);

/// Unit tangent vector beside the motion, where neither trail nor prediction is: on the side of the direction
/// (azimuth, elevation) [rad] in which the camera looks. Below a target that hardly moves.
Eigen::Vector2d sideOf(const sightline::core::AngularState& state, const Eigen::Vector2d& view);

/// Whether a sighting may be the track's: in its gate, or hardly beyond as the gate has moved on since.
bool isNearGate(const sightline::Gate& gate, const Eigen::Vector3d& direction);

}  // namespace sightline_ros
