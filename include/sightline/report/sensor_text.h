#pragma once

#include <string>

#include "sightline/core/sensors/detection_calibration.h"
#include "sightline/core/sensors/noise_calibration.h"
#include "sightline/core/sensors/sensor_guard.h"

namespace sightline::report {

/// A change of a sensor's verdict, for the log: name, verdict, size, since when, and the consequence.
std::string textOf(const core::SensorChange& change);

/// The calibrated noise of a sensor: "0.12 times the stated sigma (from 300 sightings)".
std::string textOf(const core::CalibratedSensor& sensor);

/// The calibrated detection of a sensor: "83 % of settled targets seen, 5.1 false sightings a scan".
std::string textOf(const core::CalibratedDetection& sensor);

/// The clock offset of a sensor and its consequence; empty when no offset is found.
std::string clockTextOf(const core::WatchedSensor& sensor);

/// The state of a sensor, for /diagnostics.
std::string textOf(const core::WatchedSensor& sensor);

}  // namespace sightline::report
