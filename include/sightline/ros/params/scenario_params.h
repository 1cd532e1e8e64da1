#pragma once

#include <optional>

#include <ros/time.h>

#include "sightline/core/simulation/scenario.h"
#include "sightline/ros/params/param_reader.h"

namespace sightline_ros {

/// A scenario from its parameter tree (`/scenario`), strictly: every key is known, in range and of use. The
/// keys, with unit, range and meaning, are described in config/scenarios/six_sensors_paper.yaml (scenario,
/// platform, targets) and config/sensors/six_sensors.yaml (sensors). The targets are in ascending order of
/// id. Throws ParamError.
sightline::core::Scenario loadScenario(const ParamReader& reader);

/// `start_time` [s since the epoch of ROS's clock]: the scenario's time zero; nullopt when it is not set.
std::optional<ros::Time> loadStartTime(const ParamReader& reader);

}  // namespace sightline_ros
