#pragma once

#include <algorithm>
#include <cmath>

#include "sightline/core/model/sphere.h"

/// Which numbers can be the azimuth and the elevation of a direction, by whoever wrote them down.
namespace sightline::core {

/// Half a unit of the third decimal [rad]: float32(pi/2), 1.570796327 and 6.2832 are beyond the ends of their
/// ranges by rounding alone. Degrees taken for radians are out by far more.
inline constexpr double kAngleRounding = 5e-4;

/// Whether an azimuth lies within +-2 pi [rad], but for rounding; not finite ones do not.
inline bool isAzimuth(double azimuth) {
  return std::abs(azimuth) <= 2.0 * kPi + kAngleRounding;
}

/// Whether an elevation lies within +-pi/2 [rad], but for rounding; not finite ones do not.
inline bool isElevation(double elevation) {
  return std::abs(elevation) <= 0.5 * kPi + kAngleRounding;
}

/// An elevation that was rounded beyond a pole, at the pole [rad].
inline double withinPoles(double elevation) {
  return std::clamp(elevation, -0.5 * kPi, 0.5 * kPi);
}

}  // namespace sightline::core
