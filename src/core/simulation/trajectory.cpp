#include "sightline/core/simulation/trajectory.h"

namespace sightline::core {
namespace {

constexpr double kSmallestRange = 1e-3;  // [m]: closer, a target has no direction

std::optional<AngularState> seenFrom(const PlatformState& /*platform*/, const AngularMotion& motion) {
  return onSphere(motion);
}

std::optional<AngularState> seenFrom(const PlatformState& platform, const SpatialMotion& motion) {
  const Eigen::Vector3d line_of_sight = motion.position - platform.position;
  const double range = line_of_sight.norm();
  if (range < kSmallestRange) return std::nullopt;
  const Eigen::Vector3d direction = line_of_sight / range;
  AngularState state;
  // (S-85). The velocity along the line of sight does not turn it: the Jacobian's rows are normal to it.
  state.mean << anglesOf(direction),
      anglesJacobian(direction) * (motion.velocity - platform.velocity) / range;
  return state;
}

std::optional<Eigen::Vector3d> directionFrom(const Eigen::Vector3d& /*point*/, const AngularMotion& motion) {
  return directionOf(motion.angles);
}

std::optional<Eigen::Vector3d> directionFrom(const Eigen::Vector3d& point, const SpatialMotion& motion) {
  const Eigen::Vector3d line_of_sight = motion.position - point;
  if (line_of_sight.norm() < kSmallestRange) return std::nullopt;
  return line_of_sight.normalized();
}

std::optional<SpatialMotion> inSpace(const AngularMotion& /*motion*/) {
  return std::nullopt;
}

std::optional<SpatialMotion> inSpace(const SpatialMotion& motion) {
  return motion;
}

}  // namespace

std::optional<AngularState> stateSeenFrom(const PlatformState& platform, const Trajectory& trajectory,
                                          double time) {
  return std::visit([&](const auto& kind) { return seenFrom(platform, motionAt(kind, time)); }, trajectory);
}

std::optional<Eigen::Vector3d> directionSeenFrom(const Eigen::Vector3d& point, const Trajectory& trajectory,
                                                 double time) {
  return std::visit([&](const auto& kind) { return directionFrom(point, motionAt(kind, time)); }, trajectory);
}

std::optional<SpatialMotion> positionAt(const Trajectory& trajectory, double time) {
  return std::visit([&](const auto& kind) { return inSpace(motionAt(kind, time)); }, trajectory);
}

std::optional<Refusal> refusalOf(const Trajectory& trajectory) {
  return std::visit([](const auto& kind) { return refusalOf(kind); }, trajectory);
}

}  // namespace sightline::core
