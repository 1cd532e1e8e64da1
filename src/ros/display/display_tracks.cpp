#include "sightline/ros/display/display_tracks.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sightline/ros/display/sphere_shapes.h"
#include "sightline/ros/messages/conversions.h"

namespace sightline_ros {
namespace {

namespace core = sightline::core;

constexpr double kHardlyMoving = 0.01;  // [rad/s]

}  // namespace

bool isEstablished(const sightline::Track& track) {
  return track.status != sightline::Track::TENTATIVE;
}

std::size_t establishedIn(const sightline::TrackArray& report) {
  return static_cast<std::size_t>(std::count_if(report.tracks.begin(), report.tracks.end(), isEstablished));
}

double sigmaOf(const sightline::Track& track) {
  const core::AngularState state = toCore(track).state;
  return std::max(semiAxes(tangentCovariance(state.angles(), state.anglesCovariance())).x(), 1e-9);
}

const sightline::Track* nearestTo(const Eigen::Vector2d& angles, const sightline::TrackArray& report) {
  const sightline::Track* nearest = nullptr;
  double distance = std::numeric_limits<double>::infinity();
  for (const sightline::Track& track : report.tracks) {
    const double arc =
        core::angleBetween(core::directionOf(angles), core::directionOf({track.azimuth, track.elevation}));
    if (arc < distance) nearest = &track, distance = arc;
  }
  return nearest;
}

Eigen::Vector2d sideOf(const core::AngularState& state, const Eigen::Vector2d& view) {
  const Eigen::Vector2d motion(std::cos(state.angles().y()) * state.rates().x(), state.rates().y());
  if (motion.norm() < kHardlyMoving) return {0.0, -1.0};
  const Eigen::Vector2d side = Eigen::Vector2d(-motion.y(), motion.x()).normalized();
  return side.dot(tangentTo(state.angles(), core::directionOf(view))) >= 0.0 ? side : Eigen::Vector2d(-side);
}

bool isNearGate(const sightline::Gate& gate, const Eigen::Vector3d& direction) {
  const double reach = 1.5 * std::hypot(gate.azimuth_half_width, gate.elevation_half_width);
  return core::angleBetween(core::directionOf({gate.azimuth, gate.elevation}), direction) <= reach;
}

}  // namespace sightline_ros
