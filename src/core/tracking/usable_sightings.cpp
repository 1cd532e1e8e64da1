#include "sightline/core/tracking/usable_sightings.h"

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>

#include "sightline/core/model/sphere.h"
#include "sightline/core/model/usable_sighting.h"

namespace sightline::core {

namespace {

constexpr double kSmallestIfov = 1e-12;  // [rad]

/// What a scan states of its sensor; what cannot be is not known.
void leaveOutWhatCannotBe(Scan& scan) {
  constexpr double kNotKnown = std::numeric_limits<double>::quiet_NaN();
  if (!(scan.ifov >= kSmallestIfov && scan.ifov <= 2.0 * kPi)) scan.ifov = kNotKnown;
  if (!(scan.detection_probability > 0.0 && scan.detection_probability <= 1.0))
    scan.detection_probability = kNotKnown;
  if (!(scan.clutter_density >= 0.0) || !std::isfinite(scan.clutter_density))
    scan.clutter_density = kNotKnown;
  if (!(scan.noise_scale > 0.0) || !std::isfinite(scan.noise_scale)) scan.noise_scale = 1.0;
  if (!scan.view) return;
  const bool is_view = scan.view->R_sensor_tracking.allFinite() && scan.view->half_widths.allFinite() &&
                       scan.view->solidAngle() > 0.0;
  if (!is_view) scan.view.reset();
}

}  // namespace

UsableSightings usableSightings(const Scan& scan, std::size_t most) {
  UsableSightings usable;
  usable.scan = scan;
  usable.scan.sightings.clear();
  leaveOutWhatCannotBe(usable.scan);
  usable.decisions.resize(scan.sightings.size());
  for (std::size_t j = 0; j < scan.sightings.size(); ++j) {
    Association& decision = usable.decisions[j];
    decision.sighting = static_cast<std::uint32_t>(j);
    decision.decision = Decision::rejected_input;
    if (!isUsable(scan.sightings[j])) {
      decision.reason =
          "direction is no finite unit vector, or its covariance is none: not finite, indefinite, or of a "
          "sigma outside [1e-12, pi] rad";
    } else if (usable.scan.sightings.size() >= most) {
      decision.reason = "scan has " + std::to_string(scan.sightings.size()) +
                        " sightings, more than max_sightings " + std::to_string(most) +
                        ": raise it, or the sensor's threshold";
    } else {
      usable.place.push_back(j);
      usable.scan.sightings.push_back(scan.sightings[j]);
      usable.scan.sightings.back().covariance = symmetric(scan.sightings[j].covariance);
    }
  }
  return usable;
}

Scan withNoise(const Scan& scan, double noise_scale) {
  Scan scaled = scan;
  scaled.noise_scale *= noise_scale;
  for (Sighting& sighting : scaled.sightings) sighting.covariance *= noise_scale;
  return scaled;
}

std::optional<Refusal> whyNotWeighable(const Scan& scan, const EstimatorParams& params) {
  const bool weighs_by_ifov = params.kind == EstimatorKind::twbls &&
                              params.twbls_form == EstimatorForm::paper &&
                              params.twbls.sensor_weight == SensorWeight::ifov;
  if (!weighs_by_ifov || scan.ifov > 0.0) return std::nullopt;
  return invalid("sensor_weight is ifov, and scans of " + scan.sensor + " have ifov " +
                 std::to_string(scan.ifov) + ": set the sensor's ifov, or sensor_weight: variance");
}

void UsableSightings::enter(std::vector<Association> made) {
  for (std::size_t k = 0; k < made.size(); ++k) {
    made[k].sighting = static_cast<std::uint32_t>(place[k]);
    decisions[place[k]] = std::move(made[k]);
  }
}

void UsableSightings::rejectAll(const std::string& reason) {
  for (const std::size_t j : place) decisions[j].reason = reason;
}

}  // namespace sightline::core
