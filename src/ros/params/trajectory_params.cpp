#include "sightline/ros/params/trajectory_params.h"

#include <functional>
#include <map>

#include "sightline/core/model/sphere.h"

namespace sightline_ros {
namespace {

namespace core = sightline::core;

template <int N>
Eigen::Matrix<double, N, 1> loadVector(const ParamReader& reader, const std::string& key,
                                       const Eigen::Matrix<double, N, 1>& fallback, const Range& each,
                                       const std::string& unit) {
  const std::vector<double> values =
      reader.numbers(key, std::vector<double>(fallback.data(), fallback.data() + N), each, unit);
  if (values.size() != N) {
    throw reader.error(key, "expected a list of " + std::to_string(N) + " numbers [" + unit + "], got " +
                                std::to_string(values.size()));
  }
  return Eigen::Map<const Eigen::Matrix<double, N, 1>>(values.data());
}

Eigen::Vector2d pair(const ParamReader& reader, const std::string& key, const Eigen::Vector2d& fallback,
                     const std::string& unit) {
  return loadPair(reader, key, fallback, anyNumber(), unit);
}

Eigen::Vector3d triple(const ParamReader& reader, const std::string& key, const Eigen::Vector3d& fallback,
                       const std::string& unit) {
  return loadTriple(reader, key, fallback, anyNumber(), unit);
}

core::Trajectory sinusoid(const ParamReader& reader) {
  core::Sinusoid sinusoid;
  sinusoid.amplitude = pair(reader, "amplitude", sinusoid.amplitude, "rad");
  sinusoid.frequency = pair(reader, "frequency", sinusoid.frequency, "rad/s");
  sinusoid.phase = pair(reader, "phase", sinusoid.phase, "rad");
  sinusoid.offset = pair(reader, "offset", sinusoid.offset, "rad");
  return sinusoid;
}

core::Trajectory line(const ParamReader& reader) {
  core::AngularLine line;
  line.angles = pair(reader, "angles", line.angles, "rad");
  line.rates = pair(reader, "rates", line.rates, "rad/s");
  return line;
}

std::vector<core::AccelerationPiece> loadPieces(const ParamReader& reader, const std::string& key) {
  std::vector<core::AccelerationPiece> pieces;
  for (const ParamReader& entry : reader.list(key)) {
    core::AccelerationPiece piece;
    piece.from = entry.requiredNumber("from", atLeast(0.0), "s");
    piece.to = entry.requiredNumber("to", above(piece.from), "s");
    piece.constant = entry.number("constant", piece.constant, anyNumber(), "rad/s^2");
    piece.amplitude = entry.number("amplitude", piece.amplitude, anyNumber(), "rad/s^2");
    piece.frequency = entry.number("frequency", piece.frequency, anyNumber(), "rad/s");
    piece.phase = entry.number("phase", piece.phase, anyNumber(), "rad");
    pieces.push_back(piece);
  }
  return pieces;
}

core::Trajectory weave(const ParamReader& reader) {
  core::Weave weave;
  weave.angles = pair(reader, "angles", weave.angles, "rad");
  weave.rates = pair(reader, "rates", weave.rates, "rad/s");
  weave.azimuth = loadPieces(reader, "azimuth");
  weave.elevation = loadPieces(reader, "elevation");
  return weave;
}

/// In metres when a position is given, else in angles.
core::Trajectory whiteAcceleration(const ParamReader& reader, std::uint64_t seed) {
  if (reader.has("position")) {
    core::SpatialWhiteAcceleration path;
    path.seed = seed;
    path.density = reader.number("density", path.density, atLeast(0.0), "m^2/s^3");
    path.position = triple(reader, "position", path.position, "m");
    path.velocity = triple(reader, "velocity", path.velocity, "m/s");
    return path;
  }
  core::WhiteAcceleration path;
  path.seed = seed;
  path.density = reader.number("density", path.density, atLeast(0.0), "rad^2/s^3");
  path.angles = pair(reader, "angles", path.angles, "rad");
  path.rates = pair(reader, "rates", path.rates, "rad/s");
  return path;
}

core::Trajectory flight(const ParamReader& reader) {
  core::StraightFlight flight;
  flight.position = triple(reader, "position", flight.position, "m");
  flight.velocity = triple(reader, "velocity", flight.velocity, "m/s");
  return flight;
}

core::Trajectory circle(const ParamReader& reader) {
  core::SpatialOrbit orbit;
  orbit.centre = triple(reader, "centre", orbit.centre, "m");
  orbit.radius = reader.number("radius", orbit.radius, above(0.0), "m");
  orbit.angular_rate = reader.number("angular_rate", orbit.angular_rate, anyNumber(), "rad/s");
  orbit.phase = reader.number("phase", orbit.phase, anyNumber(), "rad");
  return orbit;
}

core::Trajectory zenithPass(const ParamReader& reader) {
  core::ZenithPass pass;
  pass.below = triple(reader, "below", pass.below, "m");
  pass.altitude = reader.number("altitude", pass.altitude, above(0.0), "m");
  pass.speed = reader.number("speed", pass.speed, anyNumber(), "m/s");
  pass.course = reader.number("course", pass.course, anyNumber(), "rad");
  pass.zenith_distance = reader.number("zenith_distance", pass.zenith_distance,
                                       inside(-core::kPi / 2.0, core::kPi / 2.0), "rad");
  pass.closest_time = reader.number("closest_time", pass.closest_time, anyNumber(), "s");
  return pass;
}

core::BoostStage loadStage(const ParamReader& reader) {
  core::BoostStage stage;
  stage.acceleration = reader.requiredNumber("acceleration", atLeast(0.0), "m/s^2");
  stage.burn = reader.requiredNumber("burn", above(0.0), "s");
  stage.coast = reader.number("coast", 0.0, atLeast(0.0), "s");
  stage.elevation_start = reader.requiredNumber("elevation_start", between(-core::kPi, core::kPi), "rad");
  stage.elevation_end =
      reader.number("elevation_end", stage.elevation_start, between(-core::kPi, core::kPi), "rad");
  return stage;
}

core::Trajectory boost(const ParamReader& reader) {
  core::Boost boost;
  boost.site = triple(reader, "site", boost.site, "m");
  boost.course = reader.number("course", boost.course, anyNumber(), "rad");
  boost.stages.clear();
  for (const ParamReader& stage : reader.list("stages")) boost.stages.push_back(loadStage(stage));
  return boost;
}

template <int N>
core::Trajectory route(const ParamReader& reader, const std::vector<ParamReader>& waypoints,
                       const std::string& place, const std::string& unit) {
  core::Route<N> route;
  route.loop = reader.flag("loop", route.loop);
  for (const ParamReader& entry : waypoints) {
    core::Waypoint<N> point;
    point.time = entry.requiredNumber("time", atLeast(0.0), "s");
    entry.requiredNumbers(place, anyNumber(), unit);
    point.place = loadVector<N>(entry, place, point.place, anyNumber(), unit);
    route.points.push_back(point);
  }
  return route;
}

/// Through angles when the first waypoint gives angles, else through positions.
core::Trajectory waypoints(const ParamReader& reader) {
  const std::vector<ParamReader> waypoints = reader.list("waypoints");
  const bool angular = !waypoints.empty() && waypoints.front().has("angles");
  return angular ? route<2>(reader, waypoints, "angles", "rad")
                 : route<3>(reader, waypoints, "position", "m");
}

core::PlatformMotion fixedPlatform(const ParamReader& reader) {
  core::FixedPlatform fixed;
  fixed.position = triple(reader, "position", fixed.position, "m");
  fixed.attitude = triple(reader, "attitude", fixed.attitude, "rad");
  return fixed;
}

core::PlatformMotion straightPlatform(const ParamReader& reader) {
  core::StraightPlatform straight;
  straight.position = triple(reader, "position", straight.position, "m");
  straight.velocity = triple(reader, "velocity", straight.velocity, "m/s");
  straight.attitude = triple(reader, "attitude", straight.attitude, "rad");
  straight.swing = triple(reader, "swing", straight.swing, "rad");
  straight.swing_period = reader.number("swing_period", straight.swing_period, above(0.0), "s");
  return straight;
}

core::PlatformMotion orbit(const ParamReader& reader) {
  core::OrbitPlatform orbit;
  orbit.centre = triple(reader, "centre", orbit.centre, "m");
  orbit.radius = reader.number("radius", orbit.radius, above(0.0), "m");
  orbit.angular_rate = reader.number("angular_rate", orbit.angular_rate, anyNumber(), "rad/s");
  orbit.phase = reader.number("phase", orbit.phase, anyNumber(), "rad");
  orbit.attitude = triple(reader, "attitude", orbit.attitude, "rad");
  return orbit;
}

template <typename Value>
std::vector<std::string> namesOf(const std::map<std::string, Value>& kinds) {
  std::vector<std::string> names;
  names.reserve(kinds.size());
  for (const auto& kind : kinds) names.push_back(kind.first);
  return names;
}

}  // namespace

core::Trajectory loadTrajectory(const ParamReader& reader, std::uint64_t seed) {
  const std::map<std::string, std::function<core::Trajectory(const ParamReader&)>> kinds{
      {"sinusoid", sinusoid},
      {"line", line},
      {"weave", weave},
      {"white_acceleration", [seed](const ParamReader& r) { return whiteAcceleration(r, seed); }},
      {"waypoints", waypoints},
      {"flight", flight},
      {"orbit", circle},
      {"zenith_pass", zenithPass},
      {"boost", boost}};
  const std::string kind = reader.choice("trajectory", "sinusoid", namesOf(kinds));
  core::Trajectory trajectory = kinds.at(kind)(reader);
  if (const auto refusal = core::refusalOf(trajectory))
    throw reader.error("trajectory", kind + ": " + refusal->detail);
  return trajectory;
}

core::PlatformMotion loadPlatformMotion(const ParamReader& reader) {
  const std::map<std::string, std::function<core::PlatformMotion(const ParamReader&)>> kinds{
      {"fixed", fixedPlatform}, {"straight", straightPlatform}, {"orbit", orbit}};
  const std::string kind = reader.choice("motion", "fixed", namesOf(kinds));
  core::PlatformMotion motion = kinds.at(kind)(reader);
  if (const auto refusal = core::refusalOf(motion))
    throw reader.error("motion", kind + ": " + refusal->detail);
  return motion;
}

Eigen::Vector2d loadPair(const ParamReader& reader, const std::string& key, const Eigen::Vector2d& fallback,
                         const Range& each, const std::string& unit) {
  return loadVector<2>(reader, key, fallback, each, unit);
}

Eigen::Vector3d loadTriple(const ParamReader& reader, const std::string& key, const Eigen::Vector3d& fallback,
                           const Range& each, const std::string& unit) {
  return loadVector<3>(reader, key, fallback, each, unit);
}

}  // namespace sightline_ros
