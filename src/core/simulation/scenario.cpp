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

std::optional<Refusal> refusalOfSensors(const std::vector<SimulatedSensor>& sensors) {
  std::set<std::string> names;
  std::map<std::string, const SimulatedSensor*> sequences;
  for (const SimulatedSensor& sensor : sensors) {
    const std::string name = "sensor " + sensor.name;
    if (const auto refusal = refusalOf(sensor)) return Refusal{name, refusal->detail};
    if (!names.insert(sensor.name).second) return Refusal{name, "its name is given twice"};
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
  return refusalOfSensors(scenario.sensors);
}

}  // namespace sightline::core
