#include "sightline/core/simulation/sensor_simulator.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "sightline/core/model/sphere.h"

namespace sightline::core {
namespace {

const Scenario& checked(const Scenario& scenario) {
  if (const auto refusal = refusalOf(scenario)) throw std::invalid_argument(textOf(*refusal));
  return scenario;
}

const SimulatedSensor& sensorNamed(const Scenario& scenario, const std::string& name) {
  std::string known;
  for (const SimulatedSensor& sensor : scenario.sensors) {
    if (sensor.name == name) return sensor;
    known += (known.empty() ? "" : ", ") + sensor.name;
  }
  throw std::invalid_argument("the scenario has no sensor \"" + name + "\", it has: " + known);
}

std::uint64_t timingSeed(const Scenario& scenario, const SimulatedSensor& sensor) {
  return sensor.sequence.empty() ? seedOf(scenario.seed, "timing of sensor " + sensor.name)
                                 : seedOf(scenario.seed, "timing of sequence " + sensor.sequence);
}

/// What the sensor is off by at `time`: true sigma over stated sigma, and bias [rad].
Degradation errorsAt(const SimulatedSensor& sensor, double time) {
  Degradation errors;
  errors.bias = sensor.bias;
  for (const Degradation& degradation : sensor.degradations) {
    if (!degradation.interval.holds(time)) continue;
    errors.sigma_scale *= degradation.sigma_scale;
    errors.bias += degradation.bias;
  }
  return errors;
}

bool isOut(const SimulatedSensor& sensor, double time) {
  return std::any_of(sensor.outages.begin(), sensor.outages.end(),
                     [time](const Interval& outage) { return outage.holds(time); });
}

/// Whether the sensor stays silent from `time` to the end of the scenario.
bool isOutForGood(const SimulatedSensor& sensor, double time, double scenario_duration) {
  return std::any_of(sensor.outages.begin(), sensor.outages.end(), [&](const Interval& outage) {
    return outage.holds(time) && outage.to >= scenario_duration;
  });
}

Sighting measured(const SimulatedSensor& sensor, const Eigen::Vector2d& angles) {
  const Eigen::Vector2d on_sphere = anglesOf(directionOf(angles));
  const Eigen::Matrix2d covariance = statedSigma(sensor, on_sphere).cwiseAbs2().asDiagonal();
  return sightingOf(on_sphere, covariance);
}

/// By which what the sensor sees is turned in its own frame: its station's misorientation.
Eigen::Matrix3d turnOf(const Scenario& scenario, const SimulatedSensor& sensor,
                       const PlatformState& carrier) {
  const Station* station = stationOf(scenario, sensor);
  if (station == nullptr || station->misorientation.isZero(0.0)) return Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d R_world_sensor = carrier.R_world_platform * R_platform_sensor(sensor);
  return R_world_sensor.transpose() * rotationOf(station->misorientation) * R_world_sensor;
}

/// Ascending azimuth: the order of the sightings does not give their origin away.
void sortByAzimuth(SimulatedScan& simulated) {
  const std::vector<Sighting> sightings = simulated.scan.sightings;
  const std::vector<std::uint32_t> origins = simulated.origins;
  std::vector<std::size_t> order(sightings.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return anglesOf(sightings[a].direction).x() < anglesOf(sightings[b].direction).x();
  });
  for (std::size_t i = 0; i < order.size(); ++i) {
    simulated.scan.sightings[i] = sightings[order[i]];
    simulated.origins[i] = origins[order[i]];
  }
}

}  // namespace

SensorSimulator::SensorSimulator(const Scenario& scenario, const std::string& sensor, Time start)
    : scenario_(checked(scenario)),
      sensor_(sensorNamed(scenario_, sensor)),
      start_(start),
      last_publish_time_(start),
      exposures_(sensor_.timing, timingSeed(scenario_, sensor_)),
      latency_(seedOf(scenario_.seed, "latency of " + sensor_.name)),
      clutter_(seedOf(scenario_.seed, "clutter of " + sensor_.name)) {
  target_streams_.reserve(scenario_.targets.size());
  for (const Target& target : scenario_.targets) {
    const std::string whose = std::to_string(target.id) + " by " + sensor_.name;
    target_streams_.push_back({RandomStream(seedOf(scenario_.seed, "noise of " + whose)),
                               RandomStream(seedOf(scenario_.seed, "detection of " + whose))});
  }
}

std::optional<SimulatedScan> SensorSimulator::next() {
  while (const auto exposure = nextExposure()) {
    SimulatedScan simulated = scanAt(*exposure);
    if (!isOut(sensor_, seconds(*exposure))) return simulated;
  }
  return std::nullopt;
}

std::optional<Duration> SensorSimulator::nextExposure() {
  const Duration exposure = exposures_.next();
  const double time = seconds(exposure);
  const bool over = time >= scenario_.duration || isOutForGood(sensor_, time, scenario_.duration);
  return over ? std::nullopt : std::optional<Duration>(exposure);
}

// Drawn for exposures in an outage, too: the sightings after it are those that would have come without it.
SimulatedScan SensorSimulator::scanAt(Duration since_start) {
  SimulatedScan simulated;
  Scan& scan = simulated.scan;
  const Station* station = stationOf(scenario_, sensor_);
  scan.time = start_ + (station != nullptr ? clockAt(*station, since_start) : since_start);
  scan.sensor = sensor_.name;
  scan.ifov = sensor_.ifov;
  scan.detection_probability = sensor_.detection_probability;
  scan.clutter_density = sensor_.clutter_density;
  scan.view = viewOf(sensor_);
  addTargets(simulated, seconds(since_start));
  addClutter(simulated);
  sortByAzimuth(simulated);
  publishAfterLatency(simulated, start_ + since_start);
  return simulated;
}

void SensorSimulator::addTargets(SimulatedScan& simulated, double time) {
  const PlatformState platform = carrierAt(scenario_, sensor_, time);
  const Eigen::Matrix3d turn = turnOf(scenario_, sensor_, platform);
  const Degradation errors = errorsAt(sensor_, time);
  for (std::size_t i = 0; i < scenario_.targets.size(); ++i) {
    // Drawn at each exposure, seen or not, so that the n-th exposure has the same draws whatever else
    // changes.
    const Eigen::Vector2d draw = target_streams_[i].noise.normalPair();
    const bool detected = target_streams_[i].detection.uniform() < sensor_.detection_probability;  // (S-84)
    const Target& target = scenario_.targets[i];
    const auto direction = directionFromSensor(sensor_, platform, target, time);
    if (!detected || !direction || !isVisible(target, time)) continue;
    const Eigen::Vector3d seen = turn * *direction;
    if (!inView(sensor_, seen) || isHidden(scenario_, sensor_, target, time)) continue;
    const Eigen::Vector2d angles = anglesOf(seen);
    const Eigen::Vector2d sigma = errors.sigma_scale * statedSigma(sensor_, angles);
    simulated.scan.sightings.push_back(measured(sensor_, angles + errors.bias + sigma.cwiseProduct(draw)));
    simulated.origins.push_back(target.id);
  }
}

void SensorSimulator::addClutter(SimulatedScan& simulated) {
  const double half_azimuth = sensor_.field_of_view.x(), top = std::sin(sensor_.field_of_view.y());
  const unsigned count = clutter_.poisson(sensor_.clutter_density * solidAngle(sensor_));  // (S-84)
  for (unsigned i = 0; i < count; ++i) {
    const double azimuth = half_azimuth * (2.0 * clutter_.uniform() - 1.0);
    const double elevation = std::asin(top * (2.0 * clutter_.uniform() - 1.0));  // uniform in solid angle
    simulated.scan.sightings.push_back(measured(sensor_, {azimuth, elevation}));
    simulated.origins.push_back(0);
  }
}

void SensorSimulator::publishAfterLatency(SimulatedScan& simulated, Time exposure) {
  const double delay = sensor_.latency + sensor_.latency_jitter * latency_.uniform();
  last_publish_time_ = std::max(last_publish_time_, exposure + durationOf(delay));
  simulated.publish_time = last_publish_time_;
}

}  // namespace sightline::core
