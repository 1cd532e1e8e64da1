#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <rosbag/bag.h>

#include "sightline/core/model/time.h"
#include "sightline/core/simulation/scenario.h"

namespace sightline_ros {

struct SimulatedRecordingParams {
  sightline::core::Time start{std::chrono::seconds(1000)};  ///< stamp of the scenario's time zero
  double rate = 100.0;    ///< of truth and of a moving platform's transforms, > 0 [Hz]
  bool is_stated = true;  ///< whether scans state their probability of detection and density of clutter
};

struct SimulatedRecordingSummary {
  std::size_t scans = 0, sightings = 0, truths = 0;
};

/// Writes what the nodes of a simulation would publish, at the times at which they would:
/// /sensors/<sensor>/sightings, /truth, /tf and /tf_static, with stations also /truth/positions. Throws
/// std::invalid_argument for a scenario that has no end or is faulty.
SimulatedRecordingSummary recordSimulation(const sightline::core::Scenario& scenario,
                                           const SimulatedRecordingParams& params, rosbag::Bag& bag);

/// The file of a scenario: a path (with a slash, or a file here that ends in `.yaml`), or a file of
/// config/scenarios with or without `.yaml`.
/// Throws std::runtime_error that names those that there are.
std::string scenarioFile(const std::string& name);

/// The files of a scenario in the order in which they are loaded: that of its sensors (empty = that of the
/// six sensors, or none for a scenario that has stations, which has their sensors itself) and `scenarioFile`.
std::vector<std::string> scenarioFiles(const std::string& name, const std::string& sensors);

}  // namespace sightline_ros
