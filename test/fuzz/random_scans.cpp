#include "fuzz/random_scans.h"

#include <algorithm>
#include <cmath>

#include "sightline/core/model/sphere.h"

namespace sightline_fuzz {

namespace core = sightline::core;

namespace {

constexpr std::size_t kMostPast = 40;
constexpr double kLatest = 4294967295.0;  // stamp that a message can have [s]

Eigen::Vector2d onTheSphere(Eigen::Vector2d angles) {
  return {core::wrapAngle(angles.x()), std::clamp(angles.y(), -core::kPi / 2.0, core::kPi / 2.0)};
}

core::Time clamped(core::Time time) {
  return std::clamp(time, core::Time{}, core::timeOf(static_cast<std::int64_t>(kLatest * 1e9)));
}

}  // namespace

Hazards randomHazards(RandomInput& input) {
  Hazards hazards;
  if (input.chance(0.4)) hazards.values = input.oneOf({1e-3, 1e-2, 0.2});
  if (input.chance(0.4)) hazards.times = input.oneOf({0.02, 0.2, 0.8});
  if (input.chance(0.05)) hazards.floods = 0.03;
  if (input.chance(0.1)) hazards.newcomers = input.oneOf({0.05, 0.5});
  return hazards;
}

RandomScans::RandomScans(RandomInput& input, const Hazards& hazards) : input_(input), hazards_(hazards) {
  begin_ = now_ =
      core::timeOf(static_cast<std::int64_t>(input.oneOf({0.0, 5.0, 1.7e9, kLatest - 300.0}) * 1e9));
  const double pace = input.oneOf({0.03, 0.03, 0.03, 0.002, 0.5, 4.0, 180.0});  // usual interval [s]
  const double size = input.logBetween(1e-6, 0.2);                              // usual sigma [rad]
  const int targets = input.oneOf({0, 1, 1, 2, 3, 6});
  const double spread = input.oneOf({3.0, 0.3, 20.0 * size});
  const Eigen::Vector2d centre{input.oneOf({0.0, 3.1, -1.0}), input.oneOf({0.0, 0.3, 1.5, -1.57})};
  for (int k = 0; k < targets; ++k) {
    Target target;
    target.angles = centre + spread * Eigen::Vector2d{input.normal(), input.normal()};
    const double speed = input.oneOf({0.0, 1.0, 20.0}) * size / pace;
    target.rates = speed * Eigen::Vector2d{input.normal(), input.normal()};
    if (input.chance(0.3)) target.wave = input.logBetween(size, 1.0);
    target.frequency = input.logBetween(0.01, 1.0) / pace;
    targets_.push_back(target);
  }
  const int sensors = input.oneOf({1, 1, 2, 3, 6});
  for (int i = 0; i < sensors; ++i) {
    Sensor sensor;
    sensor.name = "sensor_" + std::to_string(i);
    sensor.interval = pace * input.oneOf({1.0, 1.0, 0.2, 5.0, 100.0});
    sensor.sigma = std::min(1.0, size * input.oneOf({1.0, 1.0, 10.0, 0.1}));
    sensor.shape = input.oneOf({1.0, 1.0, 1.0, 100.0, 1e-3});
    sensor.states = input.oneOf({1.0, 1.0, 1.0, 0.01, 0.3, 3.0, 100.0});
    sensor.detection = input.oneOf({1.0, 0.9, 0.5});
    sensor.clutter = input.oneOf({0.0, 0.0, 0.3, 5.0});
    sensor.ifov = input.chance(0.5) ? sensor.sigma : std::nan("");
    sensor.has_view = input.chance(0.2);
    sensor.is_biased = input.chance(0.1);
    sensor.next = now_ + core::durationOf(sensor.interval * input.unit());
    sensors_.push_back(sensor);
  }
}

Eigen::Vector2d RandomScans::targetAt(std::size_t k, core::Time time) const {
  if (targets_.empty()) return Eigen::Vector2d::Zero();
  const Target& target = targets_[k % targets_.size()];
  const double t = core::seconds(time - begin_);
  return onTheSphere(target.angles + t * target.rates +
                     Eigen::Vector2d{target.wave * std::sin(target.frequency * t), 0.0});
}

Eigen::Vector2d RandomScans::ratesOf(std::size_t k) const {
  return targets_.empty() ? Eigen::Vector2d::Zero() : targets_[k % targets_.size()].rates;
}

core::Scan RandomScans::next() {
  if (!past_.empty() && input_.chance(hazards_.times)) {
    const std::size_t back = static_cast<std::size_t>(input_.between(0, static_cast<int>(past_.size()) - 1));
    core::Scan scan = past_[back];
    const int kind = input_.between(0, 5);
    if (kind == 0) return scan;                     // again
    if (kind == 1) scan.sensor = sensors_[0].name;  // at another's time
    if (kind == 2) scan.time = clamped(scan.time - core::durationOf(input_.logBetween(1e-9, 5.0)));
    if (kind == 3) scan.time = clamped(scan.time + core::durationOf(input_.logBetween(1e-9, 1.0)));
    if (kind == 4 && input_.chance(0.1)) now_ = clamped(now_ + core::durationOf(input_.logBetween(0.1, 1e8)));
    if (kind == 5 && input_.chance(0.1))
      scan.time = core::timeOf(static_cast<std::int64_t>(input_.between(0.0, kLatest) * 1e9));
    if (kind != 4) return scan;
  }
  Sensor* sensor = &*std::min_element(sensors_.begin(), sensors_.end(),
                                      [](const Sensor& a, const Sensor& b) { return a.next < b.next; });
  now_ = clamped(std::max(now_, sensor->next));
  sensor->next = now_ + core::durationOf(std::max(1e-9, sensor->interval * (1.0 + 0.02 * input_.normal())));
  core::Scan scan = scanOf(*sensor);
  if (input_.chance(hazards_.newcomers)) scan.sensor = "newcomer_" + std::to_string(newcomers_++);
  past_.push_back(scan);
  if (past_.size() > kMostPast) past_.erase(past_.begin());
  return scan;
}

core::Scan RandomScans::scanOf(const Sensor& sensor) {
  core::Scan scan;
  scan.time = now_;
  scan.sensor = sensor.name;
  scan.ifov = sensor.ifov;
  if (sensor.has_view) {
    scan.view.emplace();
    scan.view->half_widths = {1.0, 0.7};
  }
  if (input_.chance(0.1)) scan.detection_probability = input_.unit();
  if (input_.chance(0.1)) scan.clutter_density = input_.logBetween(1e-9, 1e9);
  for (std::size_t k = 0; k < targets_.size(); ++k) {
    if (!input_.chance(sensor.detection)) continue;
    const double bias = sensor.is_biased ? 4.0 * sensor.sigma : 0.0;
    const Eigen::Vector2d noise{input_.normal() + bias, sensor.shape * input_.normal()};
    addSighting(scan, sensor, targetAt(k, now_) + sensor.sigma * noise);
  }
  for (double left = sensor.clutter; left > 0.0; left -= 1.0) {
    if (!input_.chance(std::min(left, 1.0))) continue;
    addSighting(scan, sensor,
                targetAt(0, now_) + input_.oneOf({1.0, 30.0 * sensor.sigma}) *
                                        Eigen::Vector2d{input_.normal(), input_.normal()});
  }
  if (input_.chance(hazards_.floods)) addFlood(scan, sensor);
  if (input_.chance(hazards_.values)) {
    scan.ifov = input_.absurd();
    scan.detection_probability = input_.absurd();
    scan.clutter_density = input_.absurd();
    if (scan.view) scan.view->half_widths.x() = input_.absurd();
  }
  return scan;
}

void RandomScans::addSighting(core::Scan& scan, const Sensor& sensor, const Eigen::Vector2d& angles) {
  const double sigma = sensor.sigma * sensor.states, across = sigma * sensor.shape;
  Eigen::Matrix2d covariance = Eigen::Vector2d{sigma * sigma, across * across}.asDiagonal();
  covariance(0, 1) = covariance(1, 0) = 0.3 * sigma * across;
  const Eigen::Vector2d at = onTheSphere(angles);
  const bool is_absurd = input_.chance(hazards_.values);
  if (!is_absurd && core::rejectionOf(at, covariance)) return;
  core::Sighting sighting = core::sightingOf(at, covariance, input_.chance(0.5) ? 5.0 : std::nan(""));
  if (is_absurd) {
    const int what = input_.between(0, 5);
    if (what == 0) sighting.direction(input_.between(0, 2)) = input_.absurd();
    if (what == 1) sighting.covariance(input_.between(0, 2), input_.between(0, 2)) = input_.absurd();
    if (what == 2) sighting.covariance *= input_.absurd();
    if (what == 3) sighting.snr = input_.absurd();
    if (what == 4) sighting.direction = -sighting.direction;
    if (what == 5) sighting.covariance = input_.absurd() * Eigen::Matrix3d::Identity();
  }
  scan.sightings.push_back(sighting);
}

/// All of the sky, a cluster as small as a sighting's sigma, or a single place.
void RandomScans::addFlood(core::Scan& scan, const Sensor& sensor) {
  const int count = input_.oneOf({300, 1000, 3000});
  const double width = input_.oneOf({1.0, 3.0 * sensor.sigma, 0.0});
  for (int i = 0; i < count; ++i)
    addSighting(scan, sensor, targetAt(0, now_) + width * Eigen::Vector2d{input_.normal(), input_.normal()});
}

}  // namespace sightline_fuzz
