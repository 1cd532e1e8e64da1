#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sightline/core/model/sighting.h"
#include "sightline/core/model/time.h"
#include "sightline/core/simulation/random_stream.h"
#include "sightline/core/simulation/scenario.h"
#include "sightline/core/simulation/sighting_sequence.h"

namespace sightline::core {

/// A scan, when it leaves the sensor, and what only a simulator knows of it.
struct SimulatedScan {
  Scan scan;            ///< sightings (in ascending azimuth) and view are in the sensor's frame
  Time publish_time{};  ///< exposure and latency; never before that of the scan before
  std::vector<std::uint32_t> origins;  ///< the target of each sighting, 0 = clutter
};

/// The scans of one sensor of a scenario, one after the other in the order of exposure.
///
/// Reproducible: what comes depends on the scenario's seed, its targets and platform, and the sensor itself,
/// not on other sensors. Timing, latency, clutter, and noise and detection of each target draw from streams
/// of their own, so that a change of one leaves the others as they were.
///
/// Noise is added to azimuth and elevation in the sensor's frame, as the paper has it; it may carry a
/// sighting across the rim of the field of view, and the elevation over the pole. The covariance is the one
/// that the sensor states: from its parameters at the measured angles, knowing nothing of bias and
/// degradation.
///
/// The stamps of a sensor on a station are those of the station's clock; what it sees is turned by the
/// station's misorientation, and hidden by obstacles.
///
/// A scan never overtakes the one before it: jitter longer than the interval delays the followers.
class SensorSimulator {
 public:
  /// `start` is the stamp of the scenario's time zero. Throws std::invalid_argument for a faulty scenario, or
  /// one without that sensor.
  SensorSimulator(const Scenario& scenario, const std::string& sensor, Time start);

  /// The next scan; nullopt when the scenario is over, or the sensor out for the rest of it.
  std::optional<SimulatedScan> next();

 private:
  struct TargetStreams {
    RandomStream noise;
    RandomStream detection;
  };

  std::optional<Duration> nextExposure();
  SimulatedScan scanAt(Duration since_start);
  void addTargets(SimulatedScan& simulated, double time);
  void addClutter(SimulatedScan& simulated);
  void publishAfterLatency(SimulatedScan& simulated, Time exposure);

  Scenario scenario_;
  SimulatedSensor sensor_;
  Time start_;
  Time last_publish_time_;
  SightingSequence exposures_;
  RandomStream latency_;
  RandomStream clutter_;
  std::vector<TargetStreams> target_streams_;  // as scenario_.targets
};

}  // namespace sightline::core
