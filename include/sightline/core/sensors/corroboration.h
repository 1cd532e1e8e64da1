#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "sightline/core/model/time.h"
#include "sightline/core/sensors/sensor_guard.h"

namespace sightline::core {

/// Sensors that one track remembers to have seen its target, at most.
constexpr std::size_t kMostSources = 64;

/// How far a track corroborates a sensor's sightings at `time`. `sources`: the sensors that have seen its
/// target, at most `kMostSources`; a Source has `sensor`, `last_sighting` and `innovation` (mean of the last
/// ones [rad]). `may_corroborate`: whether the track's innovations tell of its sensors yet.
template <typename Source>
Corroboration corroborationBy(const std::vector<Source>& sources, const std::string& sensor, Time time,
                              const SensorGuard& guard, bool may_corroborate = true) {
  Corroboration corroboration;
  std::array<std::array<double, kMostSources>, 2> innovations{};
  for (const Source& source : sources) {
    const double silence = seconds(time - source.last_sighting);
    if (source.sensor == sensor) {
      corroboration.has_sensor = guard.sees(silence);
    } else if (may_corroborate && guard.mayCorroborate(source.sensor, silence)) {
      for (int channel = 0; channel < 2; ++channel)
        innovations[channel][corroboration.others] = source.innovation(channel);
      ++corroboration.others;
    }
  }
  for (int channel = 0; channel < 2; ++channel)
    corroboration.shared(channel) = signedMedian(innovations[channel].data(), corroboration.others);
  return corroboration;
}

}  // namespace sightline::core
