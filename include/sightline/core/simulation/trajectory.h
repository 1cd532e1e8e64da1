#pragma once

#include <optional>
#include <variant>

#include "sightline/core/model/refusal.h"
#include "sightline/core/simulation/angular_trajectory.h"
#include "sightline/core/simulation/flight.h"
#include "sightline/core/simulation/platform_motion.h"

namespace sightline::core {

/// How a target moves: in angles (far away) or in metres (with parallax).
using Trajectory =
    std::variant<Sinusoid, AngularLine, Weave, WhiteAcceleration, AngularRoute,  //
                 StraightFlight, ZenithPass, Boost, SpatialRoute, SpatialOrbit, SpatialWhiteAcceleration>;

/// Exact azimuth, elevation and their rates in platform_enu (origin on the platform, axes of the world),
/// `time` seconds after the target's start; covariance zero. nullopt when the target is at the platform
/// itself.
std::optional<AngularState> stateSeenFrom(const PlatformState& platform, const Trajectory& trajectory,
                                          double time);

/// Unit vector, in the axes of the world, from a point of the world [m] to the target. Targets given in
/// angles are so far that the point does not matter. nullopt when the target is at the point.
std::optional<Eigen::Vector3d> directionSeenFrom(const Eigen::Vector3d& point, const Trajectory& trajectory,
                                                 double time);

/// Where the target is in the world; nullopt when it is given in angles.
std::optional<SpatialMotion> positionAt(const Trajectory& trajectory, double time);

/// What is wrong with a trajectory's parameters; nullopt when nothing is.
std::optional<Refusal> refusalOf(const Trajectory& trajectory);

}  // namespace sightline::core
