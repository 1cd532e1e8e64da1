#include "sightline/core/simulation/simulated_sensor.h"

#include <cmath>
#include <sstream>

#include "sightline/core/model/sphere.h"

namespace sightline::core {
namespace {

constexpr double kMostFalseSightings = 1e4;  // in a scan

bool within(double value, double low, double high) {
  return value >= low && value <= high;
}

std::optional<Refusal> refusalOfOptics(const SimulatedSensor& sensor) {
  std::ostringstream why;
  const Eigen::Vector2d& view = sensor.field_of_view;
  if (!(view.x() > 0.0 && view.x() <= kPi && view.y() > 0.0 && view.y() <= kPi / 2.0)) {
    why << "the field of view must have half widths in (0, pi] and (0, pi/2] rad, got " << view.x() << " and "
        << view.y() << "; are these degrees?";
    return Refusal{"sensor", why.str()};
  }
  if (!(sensor.ifov > 0.0 && sensor.ifov <= kPi)) {
    why << "the ifov must be in (0, pi] rad, got " << sensor.ifov;
    return Refusal{"sensor", why.str()};
  }
  if (!sensor.mount_position.allFinite() || !sensor.mount_attitude.allFinite()) {
    return Refusal{"sensor", "the mount's position and attitude must be finite"};
  }
  return std::nullopt;
}

std::optional<Refusal> refusalOfErrors(const SimulatedSensor& sensor) {
  std::ostringstream why;
  if (!(within(sensor.sigma.minCoeff(), 1e-9, kPi / 2.0) &&
        within(sensor.sigma.maxCoeff(), 1e-9, kPi / 2.0))) {
    why << "sigma must be in [1e-9, pi/2] rad, got " << sensor.sigma.x() << " and " << sensor.sigma.y()
        << " (a purely relative noise needs a floor, too)";
  } else if (!within(sensor.relative_sigma, 0.0, 1.0)) {
    why << "relative_sigma must be in [0, 1], got " << sensor.relative_sigma;
  } else if (!(sensor.bias.cwiseAbs().maxCoeff() <= kPi)) {
    why << "the bias must be within +-pi rad, got " << sensor.bias.x() << " and " << sensor.bias.y();
  } else if (!(sensor.detection_probability > 0.0 && sensor.detection_probability <= 1.0)) {
    why << "detection_probability must be in (0, 1], got " << sensor.detection_probability;
  } else if (!within(sensor.clutter_density * solidAngle(sensor), 0.0, kMostFalseSightings)) {
    why << "clutter_density " << sensor.clutter_density << "/sr means "
        << sensor.clutter_density * solidAngle(sensor) << " false sightings a scan, expected 0 to "
        << kMostFalseSightings;
  } else if (!(sensor.latency >= 0.0 && sensor.latency_jitter >= 0.0 &&
               std::isfinite(sensor.latency + sensor.latency_jitter))) {
    why << "latency and latency_jitter must be at least 0 s, got " << sensor.latency << " and "
        << sensor.latency_jitter;
  } else {
    return std::nullopt;
  }
  return Refusal{"sensor", why.str()};
}

}  // namespace

std::optional<Refusal> refusalOf(const Interval& interval, const char* what) {
  if (interval.from >= 0.0 && interval.to > interval.from) return std::nullopt;
  std::ostringstream why;
  why << what << " must start at or after 0 s and end after its start, got [" << interval.from << ", "
      << interval.to << ") s";
  return Refusal{"interval", why.str()};
}

Eigen::Matrix3d R_platform_sensor(const SimulatedSensor& sensor) {
  return rotationOf(sensor.mount_attitude);
}

FieldOfView viewOf(const SimulatedSensor& sensor) {
  return {Eigen::Matrix3d::Identity(), sensor.field_of_view};
}

bool inView(const SimulatedSensor& sensor, const Eigen::Vector3d& direction_sensor) {
  return viewOf(sensor).holds(direction_sensor);
}

double solidAngle(const SimulatedSensor& sensor) {
  return viewOf(sensor).solidAngle();
}

Eigen::Vector2d statedSigma(const SimulatedSensor& sensor, const Eigen::Vector2d& angles_sensor) {
  return (sensor.sigma.array().square() + (sensor.relative_sigma * angles_sensor.array()).square())
      .sqrt()
      .matrix();  // (S-84)
}

std::optional<Refusal> refusalOf(const SimulatedSensor& sensor) {
  if (sensor.name.empty()) return Refusal{"sensor", "a sensor needs a name"};
  if (auto refusal = refusalOfOptics(sensor)) return refusal;
  if (auto refusal = refusalOfErrors(sensor)) return refusal;
  if (auto refusal = refusalOf(sensor.timing)) return refusal;
  for (const Interval& outage : sensor.outages) {
    if (auto refusal = refusalOf(outage, "an outage")) return refusal;
  }
  for (const Degradation& degradation : sensor.degradations) {
    if (auto refusal = refusalOf(degradation.interval, "a degradation")) return refusal;
    if (!(degradation.sigma_scale >= 0.0) || !degradation.bias.allFinite()) {
      return Refusal{"sensor", "a degradation needs a sigma_scale of at least 0 and a finite bias"};
    }
  }
  return std::nullopt;
}

}  // namespace sightline::core
