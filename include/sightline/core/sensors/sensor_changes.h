#pragma once

#include <vector>

#include "sightline/core/sensors/sensor_guard.h"

namespace sightline::core {

/// Adds a change to the last ones of a tracker, of which so many are remembered that a roll-back does not
/// lose one.
void remember(std::vector<SensorChange>& changes, const SensorChange& change);

/// Reports each change of a sensor's verdict once, though rolling back shows some of them again.
class SensorChangeReporter {
 public:
  /// The changes among a tracker's last ones that have not been reported yet, oldest first.
  std::vector<SensorChange> unreported(const std::vector<SensorChange>& changes);

 private:
  std::vector<SensorChange> reported_;  // the last ones
};

}  // namespace sightline::core
