#include "sightline/core/simulation/station.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "sightline/core/model/sphere.h"

namespace sightline::core {
namespace {

constexpr double kLargestDrift = 0.01;  // [1]

}  // namespace

Duration clockAt(const Station& station, Duration since_start) {
  return since_start - durationOf(station.clock_behind + station.clock_drift * seconds(since_start));
}

std::optional<Refusal> refusalOf(const Station& station) {
  if (station.name.empty()) return Refusal{"station", "a station needs a name"};
  if (auto refusal = refusalOf(station.motion)) return refusal;
  if (!(station.misorientation.cwiseAbs().maxCoeff() <= kPi))
    return Refusal{"station", "the misorientation must be within +-pi rad; are these degrees?"};
  std::ostringstream why;
  if (!std::isfinite(station.clock_behind)) {
    why << "clock_behind must be finite, got " << station.clock_behind << " s";
    return Refusal{"station", why.str()};
  }
  if (!(std::abs(station.clock_drift) <= kLargestDrift)) {
    why << "clock_drift must be within +-" << kLargestDrift << " s a second, got " << station.clock_drift;
    return Refusal{"station", why.str()};
  }
  return std::nullopt;
}

bool standsBetween(const Obstacle& obstacle, const Eigen::Vector3d& eye, const Eigen::Vector3d& target) {
  // The part of the line, from 0 at the eye to 1 at the target, that lies between both planes of each axis.
  const Eigen::Vector3d step = target - eye;
  double enters = 0.0, leaves = 1.0;
  for (int axis = 0; axis < 3; ++axis) {
    if (step(axis) == 0.0) {
      if (eye(axis) < obstacle.low(axis) || eye(axis) > obstacle.high(axis)) return false;
      continue;
    }
    const double a = (obstacle.low(axis) - eye(axis)) / step(axis);
    const double b = (obstacle.high(axis) - eye(axis)) / step(axis);
    enters = std::max(enters, std::min(a, b));
    leaves = std::min(leaves, std::max(a, b));
  }
  return enters < leaves;
}

std::optional<Refusal> refusalOf(const Obstacle& obstacle) {
  const bool is_box = obstacle.low.allFinite() && obstacle.high.allFinite() &&
                      (obstacle.high - obstacle.low).minCoeff() > 0.0;
  if (is_box) return std::nullopt;
  return Refusal{"obstacle", "its corner `high` must be above its corner `low` [m] along x, y and z"};
}

}  // namespace sightline::core
