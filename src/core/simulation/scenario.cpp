#include "sightline/core/simulation/scenario.h"

#include <algorithm>
#include <map>
#include <set>
#include <sstream>

namespace sightline::core {
namespace {

bool isThere(const Target& target, double time) {
  return target.start <= time && time < target.end;
}

std::optional<Refusal> refusalOf(const Target& target) {
  std::ostringstream why;
  if (target.id == 0) return Refusal{"target", "its id must be above 0"};
  if (!(target.start >= 0.0 && target.end > target.start)) {
    why << "it must start at or after 0 s and end after its start, got [" << target.start << ", "
        << target.end << ") s";
    return Refusal{"target", why.str()};
  }
  for (const Interval& interval : target.invisible) {
    if (auto refusal = refusalOf(interval, "a time in which it is invisible")) return refusal;
  }
  return refusalOf(target.trajectory);
}

std::optional<Refusal> refusalOfTargets(const std::vector<Target>& targets) {
  std::set<std::uint32_t> ids;
  for (const Target& target : targets) {
    const std::string name = "target " + std::to_string(target.id);
    if (const auto refusal = refusalOf(target)) return Refusal{name, refusal->detail};
    if (!ids.insert(target.id).second) return Refusal{name, "its id is given twice"};
  }
  return std::nullopt;
}

std::optional<Refusal> refusalOfStations(const std::vector<Station>& stations) {
  std::set<std::string> names{"world", "platform", "platform_enu"};
  for (const Station& station : stations) {
    const std::string name = "station " + station.name;
    if (const auto refusal = refusalOf(station)) return Refusal{name, refusal->detail};
    if (!names.insert(station.name).second)
      return Refusal{name, "its name is that of another station or frame"};
  }
  return std::nullopt;
}

std::optional<Refusal> refusalOfSensors(const std::vector<SimulatedSensor>& sensors,
                                        const std::vector<Station>& stations) {
  std::set<std::string> names;
  std::map<std::string, const SimulatedSensor*> sequences;
  for (const SimulatedSensor& sensor : sensors) {
    const std::string name = "sensor " + sensor.name;
    if (const auto refusal = refusalOf(sensor)) return Refusal{name, refusal->detail};
    if (!names.insert(sensor.name).second) return Refusal{name, "its name is given twice"};
    const bool has_place = sensor.station.empty() ||
                           std::any_of(stations.begin(), stations.end(), [&sensor](const Station& station) {
                             return station.name == sensor.station;
                           });
    if (!has_place)
      return Refusal{name, "it is on the station \"" + sensor.station + "\", and there is no such station"};
    if (sensor.sequence.empty()) continue;
    const SimulatedSensor* first = sequences.emplace(sensor.sequence, &sensor).first->second;
    if (!(sensor.timing == first->timing)) {
      return Refusal{name, "it shares the sequence " + sensor.sequence + " with " + first->name +
                               " and must have the same timing"};
    }
  }
  return std::nullopt;
}

}  // namespace

bool isVisible(const Target& target, double time) {
  return std::none_of(target.invisible.begin(), target.invisible.end(),
                      [time](const Interval& interval) { return interval.holds(time); });
}

std::optional<AngularState> truthAt(const Scenario& scenario, const Target& target, double time) {
  if (!isThere(target, time)) return std::nullopt;
  return stateSeenFrom(platformAt(scenario.platform, time), target.trajectory, time - target.start);
}

std::optional<SpatialMotion> positionTruthAt(const Target& target, double time) {
  if (!isThere(target, time)) return std::nullopt;
  return positionAt(target.trajectory, time - target.start);
}

const Station* stationOf(const Scenario& scenario, const SimulatedSensor& sensor) {
  const auto found =
      std::find_if(scenario.stations.begin(), scenario.stations.end(),
                   [&sensor](const Station& station) { return station.name == sensor.station; });
  return sensor.station.empty() || found == scenario.stations.end() ? nullptr : &*found;
}

PlatformState carrierAt(const Scenario& scenario, const SimulatedSensor& sensor, double time) {
  const Station* station = stationOf(scenario, sensor);
  return platformAt(station != nullptr ? station->motion : scenario.platform, time);
}

bool isHidden(const Scenario& scenario, const SimulatedSensor& sensor, const Target& target, double time) {
  if (scenario.obstacles.empty()) return false;
  const auto motion = positionTruthAt(target, time);
  if (!motion) return false;
  const PlatformState carrier = carrierAt(scenario, sensor, time);
  const Eigen::Vector3d eye = carrier.position + carrier.R_world_platform * sensor.mount_position;
  return std::any_of(scenario.obstacles.begin(), scenario.obstacles.end(), [&](const Obstacle& obstacle) {
    return standsBetween(obstacle, eye, motion->position);
  });
}

std::optional<Eigen::Vector3d> directionFromSensor(const SimulatedSensor& sensor,
                                                   const PlatformState& platform, const Target& target,
                                                   double time) {
  if (!isThere(target, time)) return std::nullopt;
  const Eigen::Vector3d eye = platform.position + platform.R_world_platform * sensor.mount_position;
  const auto direction_world = directionSeenFrom(eye, target.trajectory, time - target.start);
  if (!direction_world) return std::nullopt;
  return R_platform_sensor(sensor).transpose() * platform.R_world_platform.transpose() * *direction_world;
}

std::optional<Refusal> refusalOf(const Scenario& scenario) {
  if (!(scenario.duration > 0.0))
    return Refusal{"duration", "it must be above 0 s, got " + std::to_string(scenario.duration)};
  if (const auto refusal = refusalOf(scenario.platform)) return Refusal{"platform", refusal->detail};
  if (auto refusal = refusalOfTargets(scenario.targets)) return refusal;
  if (auto refusal = refusalOfStations(scenario.stations)) return refusal;
  for (const Obstacle& obstacle : scenario.obstacles) {
    if (auto refusal = refusalOf(obstacle)) return refusal;
  }
  return refusalOfSensors(scenario.sensors, scenario.stations);
}

}  // namespace sightline::core
