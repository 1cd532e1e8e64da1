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

std::optional<std::string> faultOf(const Target& target) {
  std::ostringstream why;
  if (target.id == 0) return "its id must be above 0";
  if (!(target.start >= 0.0 && target.end > target.start)) {
    why << "it must start at or after 0 s and end after its start, got [" << target.start << ", "
        << target.end << ") s";
    return why.str();
  }
  for (const Interval& interval : target.invisible) {
    if (auto fault = faultOf(interval, "a time in which it is invisible")) return fault;
  }
  return faultOf(target.trajectory);
}

std::optional<std::string> faultOfTargets(const std::vector<Target>& targets) {
  std::set<std::uint32_t> ids;
  for (const Target& target : targets) {
    const std::string name = "target " + std::to_string(target.id) + ": ";
    if (auto fault = faultOf(target)) return name + *fault;
    if (!ids.insert(target.id).second) return name + "its id is given twice";
  }
  return std::nullopt;
}

std::optional<std::string> faultOfSensors(const std::vector<SimulatedSensor>& sensors) {
  std::set<std::string> names;
  std::map<std::string, const SimulatedSensor*> sequences;
  for (const SimulatedSensor& sensor : sensors) {
    const std::string name = "sensor " + sensor.name + ": ";
    if (auto fault = faultOf(sensor)) return name + *fault;
    if (!names.insert(sensor.name).second) return name + "its name is given twice";
    if (sensor.sequence.empty()) continue;
    const SimulatedSensor* first = sequences.emplace(sensor.sequence, &sensor).first->second;
    if (!(sensor.timing == first->timing)) {
      return name + "it shares the sequence " + sensor.sequence + " with " + first->name +
             " and must have the same timing";
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

std::optional<Eigen::Vector3d> directionFromSensor(const SimulatedSensor& sensor,
                                                   const PlatformState& platform, const Target& target,
                                                   double time) {
  if (!isThere(target, time)) return std::nullopt;
  const Eigen::Vector3d eye = platform.position + platform.R_world_platform * sensor.mount_position;
  const auto direction_world = directionSeenFrom(eye, target.trajectory, time - target.start);
  if (!direction_world) return std::nullopt;
  return R_platform_sensor(sensor).transpose() * platform.R_world_platform.transpose() * *direction_world;
}

std::optional<std::string> faultOf(const Scenario& scenario) {
  if (!(scenario.duration > 0.0))
    return "the duration must be above 0 s, got " + std::to_string(scenario.duration);
  if (auto fault = faultOf(scenario.platform)) return "platform: " + *fault;
  if (auto fault = faultOfTargets(scenario.targets)) return fault;
  return faultOfSensors(scenario.sensors);
}

}  // namespace sightline::core
