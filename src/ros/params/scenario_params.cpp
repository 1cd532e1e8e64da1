#include "sightline/ros/params/scenario_params.h"

#include <algorithm>
#include <limits>

#include "sightline/core/model/sphere.h"
#include "sightline/core/simulation/random_stream.h"
#include "sightline/ros/params/trajectory_params.h"

namespace sightline_ros {
namespace {

namespace core = sightline::core;

constexpr int kLargest = std::numeric_limits<int>::max();

/// Time at which something ends [s]; not set or 0 = never.
double loadEnd(const ParamReader& reader, const std::string& key) {
  const double end = reader.number(key, 0.0, atLeast(0.0), "s");
  return end > 0.0 ? end : std::numeric_limits<double>::infinity();
}

/// Keys of a sensor, as given for the sensor itself, else for its group, else the default.
class SensorReader {
 public:
  SensorReader(ParamReader sensor, ParamReader group)
      : sensor_(std::move(sensor)), group_(std::move(group)) {}

  SensorReader sub(const std::string& key) const { return {sensor_.sub(key), group_.sub(key)}; }

  double number(const std::string& key, double fallback, const Range& range,
                const std::string& unit = "") const {
    return sensor_.number(key, group_.number(key, fallback, range, unit), range, unit);
  }

  Eigen::Vector2d pair(const std::string& key, const Eigen::Vector2d& fallback, const Range& each) const {
    return loadPair(sensor_, key, loadPair(group_, key, fallback, each, "rad"), each, "rad");
  }

  Eigen::Vector3d triple(const std::string& key, const Eigen::Vector3d& fallback,
                         const std::string& unit) const {
    return loadTriple(sensor_, key, loadTriple(group_, key, fallback, anyNumber(), unit), anyNumber(), unit);
  }

  std::string text(const std::string& key, const std::string& fallback) const {
    return sensor_.text(key, group_.text(key, fallback));
  }

  std::string choice(const std::string& key, const std::string& fallback,
                     const std::vector<std::string>& choices) const {
    return sensor_.choice(key, group_.choice(key, fallback, choices), choices);
  }

  std::vector<ParamReader> list(const std::string& key) const {
    const std::vector<ParamReader> of_group = group_.list(key);
    return sensor_.has(key) ? sensor_.list(key) : of_group;
  }

 private:
  ParamReader sensor_;
  ParamReader group_;
};

core::SightingTiming loadTiming(const SensorReader& reader) {
  core::SightingTiming timing;
  const bool random = reader.choice("kind", "random", {"random", "fixed"}) == "random";
  timing.kind = random ? core::SightingTiming::Kind::random : core::SightingTiming::Kind::fixed;
  timing.shortest = reader.number("shortest", timing.shortest, atLeast(1e-6), "s");
  timing.spread = reader.number("spread", timing.spread, atLeast(1e-6), "s");
  timing.rate = reader.number("rate", timing.rate, Range{0.0, 1e6, true, false}, "Hz");
  timing.first = reader.number("first", timing.first, atLeast(0.0), "s");
  return timing;
}

core::Interval loadInterval(const ParamReader& reader) {
  return {reader.requiredNumber("from", atLeast(0.0), "s"), loadEnd(reader, "to")};
}

std::vector<core::Interval> loadIntervals(const std::vector<ParamReader>& entries) {
  std::vector<core::Interval> intervals;
  for (const ParamReader& entry : entries) intervals.push_back(loadInterval(entry));
  return intervals;
}

std::vector<core::Degradation> loadDegradations(const SensorReader& reader) {
  std::vector<core::Degradation> degradations;
  for (const ParamReader& entry : reader.list("degradations")) {
    core::Degradation degradation;
    degradation.interval = loadInterval(entry);
    degradation.sigma_scale = entry.number("sigma_scale", degradation.sigma_scale, atLeast(0.0));
    degradation.bias = loadPair(entry, "bias", degradation.bias, between(-core::kPi, core::kPi), "rad");
    degradations.push_back(degradation);
  }
  return degradations;
}

/// Everything but name and sequence.
core::SimulatedSensor loadSensor(const SensorReader& reader) {
  core::SimulatedSensor sensor;
  sensor.mount_position = reader.triple("mount_position", sensor.mount_position, "m");
  sensor.mount_attitude = reader.triple("mount_attitude", sensor.mount_attitude, "rad");
  sensor.field_of_view =
      reader.pair("field_of_view", sensor.field_of_view, Range{0.0, core::kPi, true, false});
  sensor.ifov = reader.number("ifov", sensor.ifov, Range{0.0, core::kPi, true, false}, "rad");
  sensor.sigma = reader.pair("sigma", sensor.sigma, between(1e-9, core::kPi / 2.0));
  sensor.relative_sigma = reader.number("relative_sigma", sensor.relative_sigma, between(0.0, 1.0));
  sensor.bias = reader.pair("bias", sensor.bias, between(-core::kPi, core::kPi));
  sensor.detection_probability =
      reader.number("detection_probability", sensor.detection_probability, Range{0.0, 1.0, true, false});
  sensor.clutter_density = reader.number("clutter_density", sensor.clutter_density, atLeast(0.0), "1/sr");
  sensor.timing = loadTiming(reader.sub("timing"));
  sensor.latency = reader.number("latency", sensor.latency, atLeast(0.0), "s");
  sensor.latency_jitter = reader.number("latency_jitter", sensor.latency_jitter, atLeast(0.0), "s");
  sensor.outages = loadIntervals(reader.list("outages"));
  sensor.degradations = loadDegradations(reader);
  return sensor;
}

/// The name of a sensor or station is also that of its frame, and a sensor's part of its topics.
void checkName(const ParamReader& parent, const std::string& name, const std::string& whose) {
  const std::string letters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ";
  const bool fits = letters.find(name[0]) != std::string::npos &&
                    name.find_first_not_of(letters + "0123456789_") == std::string::npos;
  if (!fits) throw parent.error(name, whose + " name must consist of letters, digits and _, a letter first");
}

std::vector<core::SimulatedSensor> loadSensors(const ParamReader& reader) {
  const bool synchronous_groups = reader.flag("synchronous_groups", false);
  const ParamReader sensors = reader.sub("sensors"), groups = reader.sub("groups");
  std::vector<core::SimulatedSensor> loaded;
  for (const std::string& name : sensors.keys()) {
    checkName(sensors, name, "a sensor's");
    const ParamReader own = sensors.sub(name);
    const std::string group = own.text("group", "");
    const ParamReader shared =
        group.empty() ? ParamReader(XmlRpc::XmlRpcValue(), own.name()) : groups.sub(group);
    const SensorReader both(own, shared);
    core::SimulatedSensor sensor = loadSensor(both);
    sensor.name = name;
    sensor.station = both.text("station", "");
    sensor.sequence = both.text("sequence", synchronous_groups ? group : "");
    loaded.push_back(sensor);
  }
  return loaded;
}

std::vector<core::Station> loadStations(const ParamReader& stations) {
  std::vector<core::Station> loaded;
  for (const std::string& name : stations.keys()) {
    checkName(stations, name, "a station's");
    const ParamReader reader = stations.sub(name);
    core::Station station;
    station.name = name;
    station.motion = loadPlatformMotion(reader);
    station.misorientation =
        loadTriple(reader, "misorientation", station.misorientation, between(-core::kPi, core::kPi), "rad");
    station.clock_behind = reader.number("clock_behind", station.clock_behind, anyNumber(), "s");
    station.clock_drift = reader.number("clock_drift", station.clock_drift, between(-0.01, 0.01));
    loaded.push_back(station);
  }
  return loaded;
}

std::vector<core::Obstacle> loadObstacles(const ParamReader& reader) {
  std::vector<core::Obstacle> obstacles;
  for (const ParamReader& entry : reader.list("obstacles")) {
    core::Obstacle obstacle;
    entry.requiredNumbers("low", anyNumber(), "m");
    entry.requiredNumbers("high", anyNumber(), "m");
    obstacle.low = loadTriple(entry, "low", obstacle.low, anyNumber(), "m");
    obstacle.high = loadTriple(entry, "high", obstacle.high, anyNumber(), "m");
    if (const auto refusal = core::refusalOf(obstacle)) throw entry.error("high", refusal->detail);
    obstacles.push_back(obstacle);
  }
  return obstacles;
}

/// `place` in the list, from 1, is the id unless another is given.
core::Target loadTarget(const ParamReader& reader, int place, std::uint64_t scenario_seed) {
  core::Target target;
  target.id = static_cast<std::uint32_t>(reader.integer("id", place, 1, kLargest));
  target.start = reader.number("start", target.start, atLeast(0.0), "s");
  target.end = loadEnd(reader, "end");
  target.invisible = loadIntervals(reader.list("invisible"));
  target.trajectory =
      loadTrajectory(reader, core::seedOf(scenario_seed, "trajectory of " + std::to_string(target.id)));
  return target;
}

std::vector<core::Target> loadTargets(const ParamReader& reader, std::uint64_t scenario_seed) {
  if (!reader.has("targets")) {
    throw reader.error(
        "targets", "expected a list of targets, but it is not set (load a file of config/scenarios here)");
  }
  std::vector<core::Target> targets;
  for (const ParamReader& entry : reader.list("targets")) {
    targets.push_back(loadTarget(entry, static_cast<int>(targets.size()) + 1, scenario_seed));
  }
  std::sort(targets.begin(), targets.end(),
            [](const core::Target& a, const core::Target& b) { return a.id < b.id; });
  return targets;
}

}  // namespace

core::Scenario loadScenario(const ParamReader& reader) {
  core::Scenario scenario;
  scenario.seed = static_cast<std::uint64_t>(reader.integer("seed", 1, 0, kLargest));
  scenario.duration = loadEnd(reader, "duration");
  scenario.platform = loadPlatformMotion(reader.sub("platform"));
  scenario.stations = loadStations(reader.sub("stations"));
  scenario.obstacles = loadObstacles(reader);
  scenario.targets = loadTargets(reader, scenario.seed);
  scenario.sensors = loadSensors(reader);
  reader.finish();
  if (const auto refusal = core::refusalOf(scenario))
    throw ParamError(reader.name() + ": " + core::textOf(*refusal));
  return scenario;
}

std::optional<ros::Time> loadStartTime(const ParamReader& reader) {
  if (!reader.has("start_time")) return std::nullopt;
  return ros::Time(reader.requiredNumber("start_time", between(0.0, 4e9), "s"));
}

}  // namespace sightline_ros
