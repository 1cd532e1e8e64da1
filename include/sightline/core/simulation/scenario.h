#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "sightline/core/model/refusal.h"
#include "sightline/core/simulation/simulated_sensor.h"
#include "sightline/core/simulation/station.h"
#include "sightline/core/simulation/trajectory.h"

/// What the simulators simulate. Scenario time is in seconds since the scenario's time zero.
namespace sightline::core {

struct Target {
  std::uint32_t id = 1;                                  ///< > 0, unique
  double start = 0.0;                                    ///< appears; time zero of its trajectory [s]
  double end = std::numeric_limits<double>::infinity();  ///< disappears [s]
  Trajectory trajectory;
  std::vector<Interval> invisible = {};  ///< of scenario time, in which no sensor sees it though it is there
};

struct Scenario {
  std::uint64_t seed = 1;
  double duration = std::numeric_limits<double>::infinity();  ///< no exposures at or after it [s]
  PlatformMotion platform;
  std::vector<Station> stations;  ///< of sensors that are not on the platform
  std::vector<Obstacle> obstacles;
  std::vector<Target> targets;
  std::vector<SimulatedSensor> sensors;
};

/// Whether sensors can see the target, where it is there at all.
bool isVisible(const Target& target, double time);

/// Azimuth, elevation and their rates in platform_enu, exact, covariance zero; nullopt when the target is not
/// there (before its start, from its end on) or is at the platform itself. An invisible target has its truth.
std::optional<AngularState> truthAt(const Scenario& scenario, const Target& target, double time);

/// Where the target is in the world; nullopt when it is not there, or given in angles only.
std::optional<SpatialMotion> positionTruthAt(const Target& target, double time);

/// The station on which the sensor is mounted; null: on the platform.
const Station* stationOf(const Scenario& scenario, const SimulatedSensor& sensor);

/// What the sensor is mounted on: its station or the platform.
PlatformState carrierAt(const Scenario& scenario, const SimulatedSensor& sensor, double time);

/// Whether an obstacle stands between the sensor and the target. What is given in angles is never hidden.
bool isHidden(const Scenario& scenario, const SimulatedSensor& sensor, const Target& target, double time);

/// Unit vector to the target in the sensor's frame, where the sensor's station or platform is `platform`;
/// nullopt as for truthAt. Whether it is in view is another question.
std::optional<Eigen::Vector3d> directionFromSensor(const SimulatedSensor& sensor,
                                                   const PlatformState& platform, const Target& target,
                                                   double time);

/// The first thing that is wrong with a scenario; its kind names the part ("target 1", "sensor left").
/// nullopt when nothing is.
std::optional<Refusal> refusalOf(const Scenario& scenario);

}  // namespace sightline::core
