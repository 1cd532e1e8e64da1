#include "sightline/core/tracking/track_sensors.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "sightline/core/sensors/corroboration.h"

namespace sightline::core {
namespace {

constexpr double kSourceMemory = 0.3;       // share of the newest innovation of a sensor in the running mean
constexpr double kInformationMemory = 1.0;  // over which a sensor's share in a track is weighed [s]
constexpr double kFirstVisibility = 0.5;    // that a sensor could see the target, before it has or has not
constexpr double kLeastVisibility = 0.01;   // after all: it may have been hidden

}  // namespace

void TrackSensors::noteSighting(const std::string& sensor, Time time, const Eigen::Vector2d& innovation,
                                const Eigen::Matrix2d& R, const Eigen::Vector2d& slow_error) {
  auto source = std::find_if(sources_.begin(), sources_.end(),
                             [&](const Source& known) { return known.sensor == sensor; });
  if (source == sources_.end()) {
    if (sources_.size() >= kMostSources) return;
    source = sources_.insert(source, Source{});
    source->sensor = sensor;
    source->last_sighting = time;
    source->innovation = innovation;
  }
  source->innovation += kSourceMemory * (innovation - source->innovation);
  source->information *= std::exp(-seconds(time - source->last_sighting) / kInformationMemory);
  source->information += 1.0 / R.trace();
  source->last_sighting = time;
  source->slow_error = slow_error;
}

// (S-40)
void TrackSensors::noteMiss(const std::string& sensor, double visibility, double detection_probability) {
  const double missed = 1.0 - detection_probability;
  setVisibility(sensor, visibility * missed / (1.0 - visibility + visibility * missed));
}

void TrackSensors::noteVisible(const std::string& sensor) {
  setVisibility(sensor, kFirstVisibility);
}

void TrackSensors::setVisibility(const std::string& sensor, double visibility) {
  for (NonDetectingSensor& known : non_detecting_) {
    if (known.sensor != sensor) continue;
    known.visibility = std::max(visibility, kLeastVisibility);
    return;
  }
  if (non_detecting_.size() < kMostSources) non_detecting_.push_back({sensor, visibility});
}

void TrackSensors::noteInterval(const std::string& sensor, const RevisitTime& interval) {
  for (Source& source : sources_)
    if (source.sensor == sensor) source.interval = interval;
}

double TrackSensors::unitOf(const Source& source) {
  if (!source.interval.isKnown()) return std::numeric_limits<double>::infinity();
  return source.interval.unit(0.0);
}

bool TrackSensors::isRecent(const Source& source, Time time, double units, double least) {
  return seconds(time - source.last_sighting) <= std::max(units * unitOf(source), least);
}

// (S-91)
double TrackSensors::unit(Time time, double units, double least) const {
  const bool is_known = std::any_of(sources_.begin(), sources_.end(),
                                    [](const Source& source) { return source.interval.isKnown(); });
  if (!is_known) return std::numeric_limits<double>::infinity();
  double unit = 0.0;
  for (const Source& source : sources_) {
    if (source.interval.isKnown() && isRecent(source, time, units, least))
      unit = std::max(unit, unitOf(source));
  }
  return unit;
}

bool TrackSensors::hasSeen(const std::string& sensor, Time time, double units, double least) const {
  return std::any_of(sources_.begin(), sources_.end(), [&](const Source& source) {
    return source.sensor == sensor && isRecent(source, time, units, least);
  });
}

double TrackSensors::visibility(const std::string& sensor) const {
  for (const NonDetectingSensor& known : non_detecting_) {
    if (known.sensor == sensor) return known.visibility;
  }
  return kFirstVisibility;
}

Corroboration TrackSensors::corroborationOf(const std::string& sensor, Time time, const SensorGuard& guard,
                                            bool is_mature) const {
  return corroborationBy(sources_, sensor, time, guard, is_mature);
}

// (S-42)
Eigen::Vector2d TrackSensors::slowErrorVariance(Time time) const {
  double sum = 0.0;
  Eigen::Vector2d variance = Eigen::Vector2d::Zero();
  for (const Source& source : sources_) {
    const double information =
        source.information * std::exp(-seconds(time - source.last_sighting) / kInformationMemory);
    sum += information;
    variance += information * information * source.slow_error;
  }
  return sum > 0.0 ? Eigen::Vector2d(variance / (sum * sum)) : variance;
}

std::vector<std::string> TrackSensors::names(Time time, double units, double least) const {
  std::vector<std::string> names;
  for (const Source& source : sources_) {
    if (isRecent(source, time, units, least)) names.push_back(source.sensor);
  }
  std::sort(names.begin(), names.end());
  return names;
}

void TrackSensors::rotate(const Eigen::Matrix2d& J) {
  for (Source& source : sources_) source.innovation = J * source.innovation;
}

}  // namespace sightline::core
