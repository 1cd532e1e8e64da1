#include "sightline/core/sensors/detection_calibration.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include <Eigen/Geometry>

#include "sightline/core/model/sphere.h"

namespace sightline::core {
namespace {

constexpr std::size_t kMostDetectors = 256;
constexpr double kFirstProbability = 0.9;     // before anything is known ...
constexpr double kTrustInProbability = 20.0;  // ... for so many looks
constexpr double kLeastProbability = 0.05, kMostLearned = 0.9, kMostStated = 0.99;
constexpr double kFirstClutter = 1.0;    // false sightings a scan, before anything is known ...
constexpr double kTrustInClutter = 1.0;  // ... for so many scans
constexpr double kLeastClutter = 1e-3;   // of a scan: no sensor is free of it
constexpr double kFirstSpread = 0.3;  // of false sightings in each angle [rad], before anything is known ...
constexpr double kTrustInSpread = 5.0;  // ... for so many of them
constexpr double kSphere = 4.0 * kPi;   // [sr]
constexpr double kLeastSpread = 5.0;    // of false sightings, in standard deviations of a sighting
constexpr double kMostOdds = 1e100;     // of a new target, and the inverse the least
constexpr double kLongest = 300.0;      // for which births add up [units of time]

bool isBefore(const CalibratedDetection& sensor, const std::string& name) {
  return sensor.sensor < name;
}

/// A sensor of which nothing is known.
const CalibratedDetection& unknownSensor() {
  static const CalibratedDetection unknown;
  return unknown;
}

double areaOf(const Eigen::Matrix2d& spread) {
  const double determinant = spread(0, 0) * spread(1, 1) - spread(0, 1) * spread(1, 0);
  return std::min(12.0 * std::sqrt(std::max(determinant, 1e-18)), kSphere);
}

const Sighting& sharpestOf(const Scan& scan) {
  return *std::min_element(
      scan.sightings.begin(), scan.sightings.end(),
      [](const Sighting& a, const Sighting& b) { return a.covariance.trace() < b.covariance.trace(); });
}

/// (S-47): a rectangle whose points have these variances in its two directions has the area 12 sqrt(var var).
double solidAngleOf(const CalibratedDetection& sensor, const Scan& scan) {
  const double first_variance = kFirstSpread * kFirstSpread;
  Eigen::Matrix2d spread = kTrustInSpread * first_variance * Eigen::Matrix2d::Identity();
  const bool has_clutter = sensor.clutter > 0.0 && sensor.direction.norm() > 0.0;
  if (!has_clutter && scan.sightings.empty()) return areaOf(spread / kTrustInSpread);
  const Eigen::Vector3d axis = has_clutter ? sensor.direction.normalized() : scan.sightings.front().direction;
  Eigen::Matrix<double, 3, 2> across;  // of the plane that touches the sphere
  across.col(0) = axis.unitOrthogonal();
  across.col(1) = axis.cross(across.col(0));
  if (has_clutter) {
    const Eigen::Vector2d mean = across.transpose() * sensor.direction / sensor.clutter;
    spread += across.transpose() * sensor.scatter * across - sensor.clutter * mean * mean.transpose();
  }
  spread /= sensor.clutter + kTrustInSpread;
  if (scan.sightings.empty()) return areaOf(spread);
  const Eigen::Matrix2d sharpest = across.transpose() * sharpestOf(scan).covariance * across;
  return std::max(areaOf(spread), areaOf(kLeastSpread * kLeastSpread * sharpest));
}

/// False sightings expected in a scan (S-46). All that the scan shows may be false: it counts as such beside
/// what has been learned, so that the first scans of a sensor in clutter are not taken for clear ones.
double clutterOf(const CalibratedDetection& sensor, const Scan& scan) {
  const double shown = static_cast<double>(scan.sightings.size());
  const double mean =
      (sensor.clutter + shown + kTrustInClutter * kFirstClutter) / (sensor.scans + 1.0 + kTrustInClutter);
  return std::max(mean, kLeastClutter);
}

}  // namespace

DetectionCalibration::DetectionCalibration(const DetectionParams& params) : params_(params) {
  if (!(params.probability >= 0.0 && params.probability <= 1.0) || !std::isfinite(params.clutter_density) ||
      !(params.memory >= 10.0 && std::isfinite(params.memory)) ||
      !(params.births > 0.0 && std::isfinite(params.births)) ||
      !(params.first_targets > 0.0 && std::isfinite(params.first_targets))) {
    throw std::invalid_argument(
        "DetectionParams: probability in [0, 1], a finite clutter_density, memory >= 10, births and "
        "first_targets > 0 are required");
  }
}

const CalibratedDetection* DetectionCalibration::find(const std::string& sensor) const {
  const auto place = std::lower_bound(sensors_.begin(), sensors_.end(), sensor, isBefore);
  return place != sensors_.end() && place->sensor == sensor ? &*place : nullptr;
}

double DetectionCalibration::probability(const Scan& scan) const {
  const double stated = scan.detection_probability > 0.0 ? scan.detection_probability : params_.probability;
  if (stated > 0.0) return std::clamp(stated, kLeastProbability, kMostStated);
  const CalibratedDetection* sensor = find(scan.sensor);
  if (sensor == nullptr) return kFirstProbability;
  const double learned =  // (S-46)
      (sensor->seen + kTrustInProbability * kFirstProbability) / (sensor->looked + kTrustInProbability);
  return std::clamp(learned, kLeastProbability, kMostLearned);
}

double DetectionCalibration::solidAngle(const Scan& scan) const {
  if (scan.view) return scan.view->solidAngle();
  const CalibratedDetection* sensor = find(scan.sensor);
  return solidAngleOf(sensor == nullptr ? unknownSensor() : *sensor, scan);
}

double DetectionCalibration::clutterDensity(const Scan& scan) const {
  return clutterDensity(scan, solidAngle(scan));
}

/// `area`: over which its sensor's false sightings are spread [sr].
double DetectionCalibration::clutterDensity(const Scan& scan, double area) const {
  if (const auto stated = statedDensity(scan)) return std::max(*stated, kLeastClutter / area);
  return learnedClutter(scan) / area;
}

double DetectionCalibration::clutter(const Scan& scan) const {
  if (const auto stated = statedDensity(scan)) return std::max(*stated * solidAngle(scan), kLeastClutter);
  return learnedClutter(scan);
}

/// Of clutter [1/sr], by the scan or else the parameter.
std::optional<double> DetectionCalibration::statedDensity(const Scan& scan) const {
  const double stated = scan.clutter_density >= 0.0 ? scan.clutter_density : params_.clutter_density;
  return stated >= 0.0 ? std::make_optional(stated) : std::nullopt;
}

/// False sightings expected in the scan by what its sensor has shown.
double DetectionCalibration::learnedClutter(const Scan& scan) const {
  const CalibratedDetection* sensor = find(scan.sensor);
  return clutterOf(sensor == nullptr ? unknownSensor() : *sensor, scan);
}

double DetectionCalibration::newTargetOdds(const Scan& scan) const {
  const CalibratedDetection* sensor = find(scan.sensor);
  const double targets = sensor == nullptr ? params_.first_targets : sensor->undiscovered;
  const double odds = targets * probability(scan) / clutter(scan);  // (S-48)
  return odds > 1.0 / kMostOdds ? std::min(odds, kMostOdds)
                                : 1.0 / kMostOdds;  // the last where it is no number
}

double DetectionCalibration::birthDensity(const Scan& scan, double duration) const {
  return params_.births * duration / interval(scan).unit(duration) / solidAngle(scan);  // (S-43)
}

RevisitTime DetectionCalibration::interval(const Scan& scan) const {
  const CalibratedDetection* sensor = find(scan.sensor);
  if (sensor == nullptr) return {};
  RevisitTime interval = sensor->interval;
  interval.note(seconds(scan.time - sensor->last_scan));
  return interval;
}

void DetectionCalibration::take(const Scan& scan, int looked, int seen,
                                const std::vector<double>& falseness) {
  auto sensor = std::lower_bound(sensors_.begin(), sensors_.end(), scan.sensor, isBefore);
  if (sensor == sensors_.end() || sensor->sensor != scan.sensor) {
    if (sensors_.size() >= kMostDetectors) return;
    sensor = sensors_.insert(sensor, CalibratedDetection{});
    sensor->sensor = scan.sensor;
    sensor->undiscovered = params_.first_targets;
  } else {
    const double since = std::max(seconds(scan.time - sensor->last_scan), 0.0);
    const double since_last = std::min(since / sensor->interval.unit(since), kLongest);
    sensor->interval.note(since);
    // (S-48)
    sensor->undiscovered = (1.0 - probability(scan)) * sensor->undiscovered + params_.births * since_last;
  }
  sensor->last_scan = scan.time;

  const double keep = 1.0 - 1.0 / params_.memory;
  if (looked > 0) {
    const double kept = std::pow(keep, looked);
    sensor->looked = kept * sensor->looked + looked;
    sensor->seen = kept * sensor->seen + seen;
  }
  sensor->scans = keep * sensor->scans + 1.0;
  sensor->clutter *= keep;
  sensor->direction *= keep;
  sensor->scatter *= keep;
  for (std::size_t j = 0; j < falseness.size(); ++j) {
    const Eigen::Vector3d& direction = scan.sightings[j].direction;
    sensor->clutter += falseness[j];
    sensor->direction += falseness[j] * direction;
    sensor->scatter += falseness[j] * (direction * direction.transpose() + scan.sightings[j].covariance);
  }
}

}  // namespace sightline::core
