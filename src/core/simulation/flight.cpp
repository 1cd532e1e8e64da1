#include "sightline/core/simulation/flight.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "sightline/core/model/sphere.h"
#include "sightline/core/simulation/angular_trajectory.h"
#include "sightline/core/simulation/random_stream.h"
#include "sightline/core/simulation/turning_integrals.h"

namespace sightline::core {
namespace {

/// Flight in the vertical plane of the course: downrange and height above the site [m], their rates [m/s].
struct PlaneMotion {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();
  Eigen::Vector2d velocity = Eigen::Vector2d::Zero();
};

/// A stretch of flight under one law: thrust (zero on a coast) and gravity.
struct Phase {
  double duration;      // [s]
  double acceleration;  // of the thrust [m/s^2]
  double elevation;     // of the thrust at its start [rad]
  double turn_rate;     // of the thrust's elevation [rad/s]
};

std::vector<Phase> phasesOf(const Boost& boost) {
  std::vector<Phase> phases;
  phases.reserve(2 * boost.stages.size());
  for (const BoostStage& stage : boost.stages) {
    const double turn_rate = (stage.elevation_end - stage.elevation_start) / stage.burn;
    phases.push_back({stage.burn, stage.acceleration, stage.elevation_start, turn_rate});
    phases.push_back({stage.coast, 0.0, 0.0, 0.0});
  }
  phases.back().duration = std::numeric_limits<double>::infinity();
  return phases;
}

PlaneMotion fly(const PlaneMotion& start, const Phase& phase, double t) {
  const TurningIntegrals integrals = turningIntegrals(phase.turn_rate * t);  // (S-86)
  const std::complex<double> thrust = std::polar(phase.acceleration, phase.elevation);
  const std::complex<double> once = thrust * integrals.once, twice = thrust * integrals.twice;
  PlaneMotion end;
  end.velocity = start.velocity + t * Eigen::Vector2d(once.real(), once.imag() - kGravity);
  end.position = start.position + t * start.velocity +
                 t * t * Eigen::Vector2d(twice.real(), twice.imag() - 0.5 * kGravity);
  return end;
}

/// When a body at `start` on a coast is back at the height of the site [s].
double fallTime(const PlaneMotion& start) {
  const double climb = start.velocity.y(), height = std::max(0.0, start.position.y());
  return (climb + std::sqrt(climb * climb + 2.0 * kGravity * height)) / kGravity;
}

/// When, within a burn that starts in the air and ends under the ground, the ground is reached [s].
double strikeTime(const PlaneMotion& start, const Phase& phase) {
  double above = 0.0, under = phase.duration;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (above + under);
    (fly(start, phase, middle).position.y() >= 0.0 ? above : under) = middle;
  }
  return above;
}

/// How long a phase can last before the ground ends it [s]; infinite when it does not.
double groundTime(const PlaneMotion& start, const Phase& phase) {
  if (phase.acceleration == 0.0) return fallTime(start);
  const bool strikes = fly(start, phase, phase.duration).position.y() < 0.0;
  return strikes ? strikeTime(start, phase) : std::numeric_limits<double>::infinity();
}

PlaneMotion atRest(PlaneMotion motion) {
  motion.position.y() = 0.0;
  motion.velocity.setZero();
  return motion;
}

PlaneMotion planeMotionAt(const Boost& boost, double time) {
  PlaneMotion motion;
  if (time <= 0.0) return motion;
  for (const Phase& phase : phasesOf(boost)) {
    const double ground = groundTime(motion, phase);
    if (ground <= std::min(time, phase.duration)) return atRest(fly(motion, phase, ground));
    if (time <= phase.duration) return fly(motion, phase, time);
    motion = fly(motion, phase, phase.duration);
    time -= phase.duration;
  }
  return motion;
}

std::optional<Refusal> refusalOf(const BoostStage& stage) {
  std::ostringstream why;
  if (!(stage.acceleration >= 0.0) || !(stage.burn > 0.0) || !(stage.coast >= 0.0) ||
      !std::isfinite(stage.burn) || !std::isfinite(stage.coast)) {
    why << "a stage needs an acceleration >= 0 m/s^2, a burn > 0 s and a coast >= 0 s, got "
        << stage.acceleration << " m/s^2, " << stage.burn << " s and " << stage.coast << " s";
    return Refusal{"boost", why.str()};
  }
  return std::nullopt;
}

}  // namespace

SpatialMotion motionAt(const StraightFlight& flight, double time) {
  return {flight.position + time * flight.velocity, flight.velocity};
}

SpatialMotion motionAt(const ZenithPass& pass, double time) {
  const Eigen::Vector3d forward(std::cos(pass.course), std::sin(pass.course), 0.0);
  const Eigen::Vector3d left(-forward.y(), forward.x(), 0.0);
  const double offset = pass.altitude * std::tan(pass.zenith_distance);
  SpatialMotion motion;
  motion.velocity = pass.speed * forward;
  motion.position = pass.below + pass.altitude * Eigen::Vector3d::UnitZ() + offset * left +
                    (time - pass.closest_time) * motion.velocity;
  return motion;
}

SpatialMotion motionAt(const Boost& boost, double time) {
  const PlaneMotion plane = planeMotionAt(boost, time);
  const Eigen::Vector3d downrange(std::cos(boost.course), std::sin(boost.course), 0.0);
  SpatialMotion motion;
  motion.position =
      boost.site + plane.position.x() * downrange + plane.position.y() * Eigen::Vector3d::UnitZ();
  motion.velocity = plane.velocity.x() * downrange + plane.velocity.y() * Eigen::Vector3d::UnitZ();
  return motion;
}

SpatialMotion motionAt(const SpatialRoute& route, double time) {
  const Passage<3> passage = passageAt(route, time);
  return {passage.place, passage.rate};
}

SpatialMotion motionAt(const SpatialOrbit& orbit, double time) {
  const double angle = orbit.phase + orbit.angular_rate * time;
  const Eigen::Vector3d outward(std::cos(angle), std::sin(angle), 0.0),
      tangent(-outward.y(), outward.x(), 0.0);
  return {orbit.centre + orbit.radius * outward, orbit.radius * orbit.angular_rate * tangent};
}

SpatialMotion motionAt(const SpatialWhiteAcceleration& path, double time) {
  // A white acceleration has two channels: x and y are those of one, z is the first of another.
  const AngularMotion level = motionAt(WhiteAcceleration{seedOf(path.seed, "level"), path.density,
                                                         path.position.head<2>(), path.velocity.head<2>()},
                                       time);
  const AngularMotion up = motionAt(
      WhiteAcceleration{
          seedOf(path.seed, "up"), path.density, {path.position.z(), 0.0}, {path.velocity.z(), 0.0}},
      time);
  return {{level.angles.x(), level.angles.y(), up.angles.x()},
          {level.rates.x(), level.rates.y(), up.rates.x()}};
}

std::optional<Refusal> refusalOf(const StraightFlight& flight) {
  if (!flight.position.allFinite() || !flight.velocity.allFinite()) {
    return Refusal{"flight", "position and velocity of a straight flight must be finite"};
  }
  return std::nullopt;
}

std::optional<Refusal> refusalOf(const ZenithPass& pass) {
  std::ostringstream why;
  if (!(pass.altitude > 0.0)) {
    why << "the altitude of a zenith pass must be above 0 m, got " << pass.altitude;
    return Refusal{"zenith pass", why.str()};
  }
  if (!(std::abs(pass.zenith_distance) < kPi / 2.0)) {
    why << "the zenith distance must be within +-pi/2 rad, got " << pass.zenith_distance
        << "; are these degrees?";
    return Refusal{"zenith pass", why.str()};
  }
  return std::nullopt;
}

std::optional<Refusal> refusalOf(const Boost& boost) {
  if (boost.stages.empty()) return Refusal{"boost", "a boost needs at least one stage"};
  for (const BoostStage& stage : boost.stages) {
    if (auto refusal = refusalOf(stage)) return refusal;
  }
  const double lift = boost.stages.front().acceleration * std::sin(boost.stages.front().elevation_start);
  if (lift > kGravity) return std::nullopt;
  std::ostringstream why;
  why << "the first stage does not lift off: its thrust pushes up with " << lift
      << " m/s^2 against gravity's " << kGravity << " m/s^2; raise its acceleration or its elevation_start";
  return Refusal{"boost", why.str()};
}

std::optional<Refusal> refusalOf(const SpatialOrbit& orbit) {
  const bool is_finite =
      orbit.centre.allFinite() && std::isfinite(orbit.angular_rate) && std::isfinite(orbit.phase);
  if (orbit.radius > 0.0 && is_finite) return std::nullopt;
  std::ostringstream why;
  why << "an orbit needs a radius above 0 m and a finite centre, angular rate and phase, got a radius of "
      << orbit.radius << " m";
  return Refusal{"orbit", why.str()};
}

std::optional<Refusal> refusalOf(const SpatialWhiteAcceleration& path) {
  std::ostringstream why;
  if (!(path.density >= 0.0 && std::isfinite(path.density))) {
    why << "the density of a white acceleration must be at least 0 m^2/s^3, got " << path.density;
    return Refusal{"white acceleration", why.str()};
  }
  if (path.position.allFinite() && path.velocity.allFinite()) return std::nullopt;
  return Refusal{"white acceleration", "position and velocity of a white acceleration must be finite"};
}

}  // namespace sightline::core
