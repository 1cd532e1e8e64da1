#include "sightline/core/sensors/sensor_changes.h"

#include <algorithm>
#include <cstddef>

namespace sightline::core {
namespace {

constexpr std::ptrdiff_t kMostRemembered = 64;
constexpr std::ptrdiff_t kMostReported = 128;  // more than are remembered

bool isSame(const SensorChange& a, const SensorChange& b) {
  return a.sensor == b.sensor && a.change.time == b.change.time && a.change.verdict == b.change.verdict;
}

void keepTheLast(std::vector<SensorChange>& changes, std::ptrdiff_t most) {
  if (static_cast<std::ptrdiff_t>(changes.size()) > most)
    changes.erase(changes.begin(), changes.end() - most);
}

}  // namespace

void remember(std::vector<SensorChange>& changes, const SensorChange& change) {
  changes.push_back(change);
  keepTheLast(changes, kMostRemembered);
}

std::vector<SensorChange> SensorChangeReporter::unreported(const std::vector<SensorChange>& changes) {
  std::vector<SensorChange> fresh;
  for (const SensorChange& change : changes) {
    const auto isIt = [&](const SensorChange& reported) { return isSame(reported, change); };
    if (std::none_of(reported_.begin(), reported_.end(), isIt)) fresh.push_back(change);
  }
  reported_.insert(reported_.end(), fresh.begin(), fresh.end());
  keepTheLast(reported_, kMostReported);
  return fresh;
}

}  // namespace sightline::core
