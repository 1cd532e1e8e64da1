#pragma once

#include <string>
#include <tuple>

#include "sightline/core/model/sighting.h"
#include "sightline/core/model/time.h"
#include "sightline/core/model/tracklet.h"

namespace sightline::core {

/// The order in which what sensors report is processed: by time, at one instant by sensor, then by content,
/// so that it never depends on the order of arrival. `Content` tells reports of one sensor and instant apart.
template <typename Content>
bool precedes(Time time_a, const std::string& sensor_a, const Content& a, Time time_b,
              const std::string& sensor_b, const Content& b) {
  return std::tie(time_a, sensor_a, a) < std::tie(time_b, sensor_b, b);
}

/// The place of a report in that order, where its content is known as text or bytes.
struct ScanOrder {
  Time time{};
  std::string sensor;
  std::string content;

  bool operator<(const ScanOrder& other) const {
    return precedes(time, sensor, content, other.time, other.sensor, other.content);
  }
};

/// Content: the directions of the sightings, in the order of the scan.
bool precedes(const Scan& a, const Scan& b);

/// Content: the direction of the tracklet's sighting.
bool precedes(const Tracklet& a, const Tracklet& b);

/// When an item of a Timeline was sighted; every item type has such a function.
inline Time timeOf(const Scan& scan) {
  return scan.time;
}

}  // namespace sightline::core
