#include "sightline/core/ordering/scan_order.h"

#include <algorithm>

namespace sightline::core {
namespace {

/// Directions of sightings one after the other in memory.
struct Directions {
  const Sighting* begin;
  const Sighting* end;
};

bool operator<(const Directions& a, const Directions& b) {
  return std::lexicographical_compare(a.begin, a.end, b.begin, b.end,
                                      [](const Sighting& x, const Sighting& y) {
                                        const Eigen::Vector3d &u = x.direction, &v = y.direction;
                                        return std::tie(u.x(), u.y(), u.z()) < std::tie(v.x(), v.y(), v.z());
                                      });
}

Directions directionsOf(const Scan& scan) {
  return {scan.sightings.data(), scan.sightings.data() + scan.sightings.size()};
}

Directions directionsOf(const Tracklet& tracklet) {
  return {&tracklet.sighting, &tracklet.sighting + 1};
}

}  // namespace

bool precedes(const Scan& a, const Scan& b) {
  return precedes(a.time, a.sensor, directionsOf(a), b.time, b.sensor, directionsOf(b));
}

bool precedes(const Tracklet& a, const Tracklet& b) {
  return precedes(a.time, a.sensor, directionsOf(a), b.time, b.sensor, directionsOf(b));
}

}  // namespace sightline::core
