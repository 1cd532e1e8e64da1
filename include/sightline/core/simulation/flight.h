#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "sightline/core/model/refusal.h"
#include "sightline/core/simulation/route.h"

/// Motions given in metres, in `world` (x east, y north, z up): seen from the platform with parallax. Time
/// counts from the target's start [s]; every motion goes on for ever.
namespace sightline::core {

/// Position [m] and velocity [m/s] in the world.
struct SpatialMotion {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
};

/// Constant velocity.
struct StraightFlight {
  Eigen::Vector3d position{5000.0, -2000.0, 1000.0};  ///< at the start [m]
  Eigen::Vector3d velocity{-50.0, 150.0, 0.0};        ///< [m/s]
};

/// Level straight flight that passes near the zenith of a point.
struct ZenithPass {
  Eigen::Vector3d below{0.0, 0.0, 0.0};  ///< the point whose zenith is passed [m]
  double altitude = 3000.0;              ///< above that point, > 0 [m]
  double speed = 200.0;                  ///< [m/s]
  double course = 0.5;                   ///< direction of flight, counter-clockwise from east [rad]
  double zenith_distance = 0.02;  ///< smallest, in (-pi/2, pi/2); positive: the zenith is right of it [rad]
  double closest_time = 15.0;     ///< when it is reached [s]
};

/// Powered flight followed by a coast. The thrust's acceleration is constant in size; its elevation turns
/// evenly from the start to the end of the burn, in the vertical plane of the course.
struct BoostStage {
  double acceleration = 40.0;    ///< of the thrust, >= 0 [m/s^2]
  double burn = 10.0;            ///< duration, > 0 [s]
  double coast = 2.0;            ///< after the burn, >= 0 [s]
  double elevation_start = 1.5;  ///< of the thrust at ignition [rad]
  double elevation_end = 1.2;    ///< of the thrust at burnout [rad]
};

/// A rocket launched at the target's start, over a flat Earth without air. After the last stage it falls;
/// where it comes down to the height of the launch site, it rests.
struct Boost {
  Eigen::Vector3d site{20000.0, 0.0, 0.0};  ///< launch site [m]
  double course = 2.0;                      ///< direction of flight, counter-clockwise from east [rad]
  std::vector<BoostStage> stages{BoostStage{}};
};

/// A level circle at constant speed.
struct SpatialOrbit {
  Eigen::Vector3d centre{0.0, 0.0, 100.0};  ///< in the world, at the height of the orbit [m]
  double radius = 50.0;                     ///< > 0 [m]
  double angular_rate = 0.2;                ///< positive is counter-clockwise [rad/s]
  double phase = 0.0;                       ///< where it is at the start, counter-clockwise from east [rad]
};

/// White-noise acceleration (S-87) along x, y and z: a path drawn once by its seed.
struct SpatialWhiteAcceleration {
  std::uint64_t seed = 0;
  double density = 0.3;                       ///< of the acceleration, each axis [m^2/s^3]
  Eigen::Vector3d position{0.0, 0.0, 100.0};  ///< at the start [m]
  Eigen::Vector3d velocity{0.0, 0.0, 0.0};    ///< at the start [m/s]
};

/// Acceleration of gravity, downwards [m/s^2].
inline constexpr double kGravity = 9.80665;

/// Positions passed at given times.
using SpatialRoute = Route<3>;

SpatialMotion motionAt(const StraightFlight& flight, double time);
SpatialMotion motionAt(const ZenithPass& pass, double time);
SpatialMotion motionAt(const Boost& boost, double time);
SpatialMotion motionAt(const SpatialRoute& route, double time);
SpatialMotion motionAt(const SpatialOrbit& orbit, double time);
SpatialMotion motionAt(const SpatialWhiteAcceleration& path, double time);

/// What is wrong with a motion's parameters; nullopt when nothing is.
std::optional<Refusal> refusalOf(const StraightFlight& flight);
std::optional<Refusal> refusalOf(const ZenithPass& pass);
std::optional<Refusal> refusalOf(const Boost& boost);
std::optional<Refusal> refusalOf(const SpatialOrbit& orbit);
std::optional<Refusal> refusalOf(const SpatialWhiteAcceleration& path);

}  // namespace sightline::core
