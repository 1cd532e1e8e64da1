#pragma once

#include <optional>
#include <variant>

#include <Eigen/Core>

#include "sightline/core/model/refusal.h"

/// How the sensors' platform moves. `world`: x east, y north, z up [m]. `platform`: x forward, y left, z up.
namespace sightline::core {

/// Turn by roll about x, pitch about y (positive looks down), yaw about z, in this order about fixed axes
/// [rad]: maps the turned frame to the frame it was turned in.
Eigen::Matrix3d rotationOf(const Eigen::Vector3d& roll_pitch_yaw);

/// Stands still.
struct FixedPlatform {
  Eigen::Vector3d position{0.0, 0.0, 0.0};  ///< in the world [m]
  Eigen::Vector3d attitude{0.0, 0.0, 0.0};  ///< roll, pitch, yaw; yaw counts from east [rad]
};

/// Goes straight on, and may swing round its attitude: each angle on a sinusoid, pitch a third of a period
/// before roll, yaw a third before pitch.
struct StraightPlatform {
  Eigen::Vector3d position{0.0, 0.0, 0.0};  ///< at time zero, in the world [m]
  Eigen::Vector3d velocity{5.0, 0.0, 0.0};  ///< [m/s]
  Eigen::Vector3d attitude{0.0, 0.0, 0.0};  ///< roll, pitch, yaw; yaw counts from the course [rad]
  Eigen::Vector3d swing{0.0, 0.0,
                        0.0};  ///< amplitude of roll, pitch, yaw; fastest: 2 pi swing / period [rad]
  double swing_period = 2.0;   ///< > 0 [s]
};

/// Goes round in a level circle, and turns with it.
struct OrbitPlatform {
  Eigen::Vector3d centre{0.0, 0.0, 0.0};    ///< in the world, at the height of the orbit [m]
  double radius = 500.0;                    ///< > 0 [m]
  double angular_rate = 0.05;               ///< of the position; positive is counter-clockwise, not 0 [rad/s]
  double phase = 0.0;                       ///< where it is at time zero, counter-clockwise from east [rad]
  Eigen::Vector3d attitude{0.0, 0.0, 0.0};  ///< roll, pitch, yaw; yaw counts from the course [rad]
};

using PlatformMotion = std::variant<FixedPlatform, StraightPlatform, OrbitPlatform>;

/// Where the platform is and how it is turned.
struct PlatformState {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< in the world [m]
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< in the world [m/s]
  Eigen::Matrix3d R_world_platform = Eigen::Matrix3d::Identity();
};

/// The platform `time` seconds after the scenario's time zero.
PlatformState platformAt(const PlatformMotion& motion, double time);

/// What is wrong with a motion's parameters; nullopt when nothing is.
std::optional<Refusal> refusalOf(const PlatformMotion& motion);

}  // namespace sightline::core
