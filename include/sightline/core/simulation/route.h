#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "sightline/core/model/refusal.h"

namespace sightline::core {

/// A place on a route and when it is passed.
template <int N>
struct Waypoint {
  double time = 0.0;  ///< since the start of the target [s], ascending along the route
  Eigen::Matrix<double, N, 1> place = Eigen::Matrix<double, N, 1>::Zero();
};

/// A smooth way (continuous place and velocity, cubic between waypoints) through places at given times.
/// Before the first and beyond the last waypoint it goes straight on; with `loop`, the last waypoint must be
/// the first again and the way repeats for ever. N = 2: (azimuth, elevation) [rad], the azimuth going the
/// short way round from each waypoint to the next. N = 3: position in the world [m].
template <int N>
struct Route {
  std::vector<Waypoint<N>> points;
  bool loop = false;
};

/// Place and its rate of change [unit of place, unit of place/s].
template <int N>
struct Passage {
  Eigen::Matrix<double, N, 1> place;
  Eigen::Matrix<double, N, 1> rate;
};

/// Where the route is at `time` [s]. The azimuth of N = 2 is not wrapped.
template <int N>
Passage<N> passageAt(const Route<N>& route, double time);

/// What is wrong with a route; nullopt when nothing is.
template <int N>
std::optional<Refusal> refusalOf(const Route<N>& route);

extern template Passage<2> passageAt(const Route<2>&, double);
extern template Passage<3> passageAt(const Route<3>&, double);
extern template std::optional<Refusal> refusalOf(const Route<2>&);
extern template std::optional<Refusal> refusalOf(const Route<3>&);

}  // namespace sightline::core
