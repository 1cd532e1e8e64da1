#include "sightline/core/sensors/noise_calibration.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace sightline::core {
namespace {

constexpr std::size_t kMostCalibrated = 256;
constexpr double kMostOff = 1e12;  // factor on the stated variance that is believed: a million sigmas
constexpr double kLargestSurprise =
    9.0;  // squared innovation over the expected that one sighting may count for

bool byName(const CalibratedSensor& sensor, const std::string& name) {
  return sensor.sensor < name;
}

}  // namespace

NoiseCalibration::NoiseCalibration(const NoiseCalibrationParams& params) : params_(params) {
  if (!(params.trust > 0.0) || !(params.settled >= params.trust) || !std::isfinite(params.settled) ||
      !(params.min_scale > 0.0 && params.min_scale <= 1.0) ||
      !(params.max_scale >= 1.0 && std::isfinite(params.max_scale))) {
    throw std::invalid_argument(
        "NoiseCalibrationParams: trust > 0, settled >= trust, min_scale in (0, 1] and max_scale >= 1 are "
        "required");
  }
}

void NoiseCalibration::enable(bool enabled) {
  params_.enabled = enabled;
  if (!enabled) sensors_.clear();
}

/// Null when nothing is known of it.
const CalibratedSensor* NoiseCalibration::find(const std::string& sensor) const {
  const auto place = std::lower_bound(sensors_.begin(), sensors_.end(), sensor, byName);
  return place != sensors_.end() && place->sensor == sensor ? &*place : nullptr;
}

double NoiseCalibration::scale(const std::string& sensor) const {
  const CalibratedSensor* known = find(sensor);
  return known ? known->scale : 1.0;
}

double NoiseCalibration::suspectedScale(const std::string& sensor) const {
  const CalibratedSensor* known = find(sensor);
  return known ? std::max(known->scale, std::min(known->lone.suspicion().value_or(1.0), kMostOff)) : 1.0;
}

/// The sensor's, made where there is none yet; null when there are too many.
CalibratedSensor* NoiseCalibration::entry(const std::string& sensor) {
  auto place = std::lower_bound(sensors_.begin(), sensors_.end(), sensor, byName);
  if (place == sensors_.end() || place->sensor != sensor) {
    if (sensors_.size() >= kMostCalibrated) return nullptr;
    place = sensors_.insert(place, CalibratedSensor{});
    place->sensor = sensor;
  }
  return &*place;
}

// (S-96)
bool NoiseCalibration::takeUntracked(const Scan& scan) {
  if (!params_.enabled) return false;
  CalibratedSensor* known = entry(scan.sensor);
  if (known == nullptr) return false;
  const auto factor = known->lone.take(scan);
  if (factor) known->scale = known->start = std::min(*factor, kMostOff);
  return factor.has_value();
}

void NoiseCalibration::take(const std::string& sensor, const Eigen::Vector2d& innovation_squared,
                            const Eigen::Vector2d& expected, const Eigen::Vector2d& track_scale) {
  if (!params_.enabled) return;
  CalibratedSensor* place = entry(sensor);
  if (place == nullptr) return;
  const Eigen::Vector2d surprise =
      innovation_squared.cwiseQuotient(expected).cwiseMin(kLargestSurprise).cwiseProduct(track_scale);
  place->sightings = std::min(place->sightings + 1.0, params_.settled);
  const double share = 1.0 / std::min(params_.trust + place->sightings, params_.settled);
  const double learned = place->scale * (1.0 + share * (surprise.mean() - 1.0));  // (S-45)
  place->scale = std::clamp(learned, params_.min_scale * place->start, params_.max_scale * place->start);
}

}  // namespace sightline::core
