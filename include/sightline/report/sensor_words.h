#pragma once

#include <string>

#include "sightline/core/sensors/detection_calibration.h"
#include "sightline/core/sensors/noise_calibration.h"
#include "sightline/core/sensors/sensor_guard.h"

namespace sightline_ros {

/// What happened to a sensor, for the log: name, what, how much, since when, and what is done about it.
std::string wordsOf(const sightline::core::SensorChange& change);

/// What has been learnt of a sensor's noise: "0.12 times the stated sigma (from 300 sightings)".
std::string wordsOf(const sightline::core::CalibratedSensor& sensor);

/// "83 % of settled targets seen, 5.1 false sightings a scan".
std::string wordsOf(const sightline::core::CalibratedDetection& sensor);

/// That the sensor's clock is wrong, by how much and what is done about it; empty when nothing is known of
/// it.
std::string clockWordsOf(const sightline::core::WatchedSensor& sensor);

/// How a sensor is doing, for /diagnostics.
std::string wordsOf(const sightline::core::WatchedSensor& sensor);

}  // namespace sightline_ros
