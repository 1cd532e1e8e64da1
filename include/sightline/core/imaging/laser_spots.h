#pragma once

#include <cstddef>
#include <vector>

namespace sightline::core {

/// What of a laser scanner's sweep is a small target.
struct LaserSpotParams {
  double gap = 0.5;  ///< neighbouring returns whose ranges differ by more belong to different things [m], > 0
  double max_size = 1.0;  ///< things wider than this are walls and ground, not targets [m], > 0
  int min_beams = 1;      ///< a target that fewer neighbouring beams hit is left out, >= 1
};

/// One sweep in a plane: range [m] of beam k at angle first + k * step [rad].
struct LaserSweep {
  double first_angle = 0.0;  ///< [rad]
  double step = 0.0;         ///< between neighbouring beams [rad], not 0
  double min_range = 0.0;    ///< nearer returns do not count [m]
  double max_range = 0.0;    ///< nor do farther ones, or those that are not finite [m]
  bool is_closed = false;    ///< the last beam is the neighbour of the first: a full circle
};

/// Neighbouring beams that hit one small thing.
struct LaserSpot {
  double angle = 0.0;  ///< of the middle [rad]
  double width = 0.0;  ///< beams times step [rad]
  double range = 0.0;  ///< mean [m]
};

/// The small things of a sweep, in the order of the beams.
std::vector<LaserSpot> laserSpots(const LaserSweep& sweep, const std::vector<float>& ranges,
                                  const LaserSpotParams& params);

}  // namespace sightline::core
