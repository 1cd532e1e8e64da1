#pragma once

#include <optional>
#include <string>

#include <Eigen/Core>

#include "sightline/core/model/refusal.h"
#include "sightline/core/model/time.h"
#include "sightline/core/simulation/platform_motion.h"

/// Places away from the platform at which sensors stand, and what stands between them and the targets.
namespace sightline::core {

/// A place with a clock of its own. What is wrong with it is not in its transform and not in its stamps.
struct Station {
  std::string name;       ///< unique; also the name of its frame
  PlatformMotion motion;  ///< as that of a platform; a station that stands has the motion fixed

  /// By which what its sensors see is turned: roll, pitch, yaw about x, y, z of the world [rad].
  Eigen::Vector3d misorientation = Eigen::Vector3d::Zero();

  double clock_behind = 0.0;  ///< by how much its clock, which stamps its scans, is behind at time zero [s]
  double clock_drift = 0.0;   ///< by how much it falls further behind in every second, within +-0.01 [1]
};

/// What the station's clock shows at a time since time zero.
Duration clockAt(const Station& station, Duration since_start);

/// What is wrong with a station; nullopt when nothing is.
std::optional<Refusal> refusalOf(const Station& station);

/// A box with sides along the axes of the world, through which nothing is seen.
struct Obstacle {
  Eigen::Vector3d low = Eigen::Vector3d::Zero();   ///< its corner of smallest x, y, z [m]
  Eigen::Vector3d high = Eigen::Vector3d::Zero();  ///< its corner of largest x, y, z [m]
};

/// Whether it stands between two points of the world [m].
bool standsBetween(const Obstacle& obstacle, const Eigen::Vector3d& eye, const Eigen::Vector3d& target);

/// What is wrong with an obstacle; nullopt when nothing is.
std::optional<Refusal> refusalOf(const Obstacle& obstacle);

}  // namespace sightline::core
