#pragma once

#include "sightline/core/simulation/platform_motion.h"
#include "sightline/core/simulation/trajectory.h"
#include "sightline/ros/params/param_reader.h"

/// Readers of the motions of a scenario: each reads the keys of its own level, which name the kind of motion
/// and its parameters. Defaults, units and meaning are at the core's structs. They throw ParamError.
namespace sightline_ros {

/// `trajectory` (which kind) and its keys. `seed` is that of a random trajectory.
sightline::core::Trajectory loadTrajectory(const ParamReader& reader, std::uint64_t seed);

/// `motion` (which kind) and its keys.
sightline::core::PlatformMotion loadPlatformMotion(const ParamReader& reader);

/// Lists of exactly two or three numbers.
Eigen::Vector2d loadPair(const ParamReader& reader, const std::string& key, const Eigen::Vector2d& fallback,
                         const Range& each, const std::string& unit);
Eigen::Vector3d loadTriple(const ParamReader& reader, const std::string& key, const Eigen::Vector3d& fallback,
                           const Range& each, const std::string& unit);

}  // namespace sightline_ros
