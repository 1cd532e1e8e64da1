#pragma once

#include <cstdint>
#include <tuple>

#include "sightline/core/positions/position_belief.h"
#include "sightline/core/positions/rays.h"

namespace sightline::core {

/// A local track: number of its station, id there.
struct ViewKey {
  int station = 0;
  std::uint32_t track = 0;

  friend bool operator==(const ViewKey& a, const ViewKey& b) {
    return a.station == b.station && a.track == b.track;
  }
  friend bool operator<(const ViewKey& a, const ViewKey& b) {
    return std::tie(a.station, a.track) < std::tie(b.station, b.track);
  }
};

/// What a local track says now: a ray with its rate, slow errors of its sensors in the covariance.
struct LocalView {
  ViewKey key;
  Ray ray;
  SlowError slow;  ///< the part of the ray's covariance that stays for so long
};

}  // namespace sightline::core
