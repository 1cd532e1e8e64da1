#include "sightline/core/simulation/platform_motion.h"

#include <cmath>
#include <sstream>

#include <Eigen/Geometry>

#include "sightline/core/model/sphere.h"

namespace sightline::core {
namespace {

Eigen::Matrix3d alongCourse(const Eigen::Vector3d& velocity, const Eigen::Vector3d& attitude) {
  const double course = std::atan2(velocity.y(), velocity.x());
  return rotationOf(attitude + Eigen::Vector3d(0.0, 0.0, course));
}

PlatformState stateAt(const FixedPlatform& fixed, double /*time*/) {
  return {fixed.position, Eigen::Vector3d::Zero(), rotationOf(fixed.attitude)};
}

/// What is added to roll, pitch and yaw [rad].
Eigen::Vector3d swingAt(const StraightPlatform& straight, double time) {
  const Eigen::Array3d periods = time / straight.swing_period + Eigen::Array3d(0.0, 1.0 / 3.0, 2.0 / 3.0);
  return straight.swing.array() * (2.0 * kPi * periods).sin();
}

PlatformState stateAt(const StraightPlatform& straight, double time) {
  return {straight.position + time * straight.velocity, straight.velocity,
          alongCourse(straight.velocity, straight.attitude + swingAt(straight, time))};
}

PlatformState stateAt(const OrbitPlatform& orbit, double time) {
  const double angle = orbit.phase + orbit.angular_rate * time;
  const Eigen::Vector3d outward(std::cos(angle), std::sin(angle), 0.0),
      tangent(-outward.y(), outward.x(), 0.0);
  const Eigen::Vector3d velocity = orbit.radius * orbit.angular_rate * tangent;
  return {orbit.centre + orbit.radius * outward, velocity, alongCourse(velocity, orbit.attitude)};
}

std::optional<Refusal> refusalOf(const FixedPlatform& fixed) {
  if (fixed.position.allFinite() && fixed.attitude.allFinite()) return std::nullopt;
  return Refusal{"fixed platform", "position and attitude of a fixed platform must be finite"};
}

std::optional<Refusal> refusalOf(const StraightPlatform& straight) {
  if (!straight.position.allFinite() || !straight.velocity.allFinite() || !straight.attitude.allFinite()) {
    return Refusal{"straight platform",
                   "position, velocity and attitude of a straight platform must be finite"};
  }
  if (straight.swing.allFinite() && straight.swing_period > 0.0) return std::nullopt;
  std::ostringstream why;
  why << "the swing of a straight platform must be finite and its swing_period above 0 s, got "
      << straight.swing_period << " s";
  return Refusal{"straight platform", why.str()};
}

std::optional<Refusal> refusalOf(const OrbitPlatform& orbit) {
  const bool moves = orbit.radius > 0.0 && std::isfinite(orbit.angular_rate) && orbit.angular_rate != 0.0;
  if (moves && orbit.centre.allFinite() && orbit.attitude.allFinite()) return std::nullopt;
  std::ostringstream why;
  why << "an orbit needs a radius > 0 m and an angular rate that is not 0 rad/s, got " << orbit.radius
      << " m and " << orbit.angular_rate << " rad/s; for a platform that stands still use the motion fixed";
  return Refusal{"orbit", why.str()};
}

}  // namespace

Eigen::Matrix3d rotationOf(const Eigen::Vector3d& roll_pitch_yaw) {
  return (Eigen::AngleAxisd(roll_pitch_yaw.z(), Eigen::Vector3d::UnitZ()) *
          Eigen::AngleAxisd(roll_pitch_yaw.y(), Eigen::Vector3d::UnitY()) *
          Eigen::AngleAxisd(roll_pitch_yaw.x(), Eigen::Vector3d::UnitX()))
      .toRotationMatrix();
}

PlatformState platformAt(const PlatformMotion& motion, double time) {
  return std::visit([time](const auto& kind) { return stateAt(kind, time); }, motion);
}

std::optional<Refusal> refusalOf(const PlatformMotion& motion) {
  return std::visit([](const auto& kind) { return refusalOf(kind); }, motion);
}

}  // namespace sightline::core
