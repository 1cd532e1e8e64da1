#include "sightline/core/ordering/scan_memory.h"

#include <algorithm>
#include <tuple>

namespace sightline::core {

bool precedes(const Scan& a, const Scan& b) {
  if (a.time != b.time) return a.time < b.time;
  if (a.sensor != b.sensor) return a.sensor < b.sensor;
  return std::lexicographical_compare(
      a.sightings.begin(), a.sightings.end(), b.sightings.begin(), b.sightings.end(),
      [](const Sighting& x, const Sighting& y) {
        return std::make_tuple(x.direction.x(), x.direction.y(), x.direction.z()) <
               std::make_tuple(y.direction.x(), y.direction.y(), y.direction.z());
      });
}

bool isSameExposure(const Scan& a, const Scan& b) {
  return a.time == b.time && a.sensor == b.sensor && a.sightings.size() == b.sightings.size() &&
         !precedes(a, b) && !precedes(b, a);
}

}  // namespace sightline::core
