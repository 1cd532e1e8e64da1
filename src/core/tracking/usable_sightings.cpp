#include "sightline/core/tracking/usable_sightings.h"

#include <cmath>
#include <cstdint>
#include <string>
#include <utility>

namespace sightline::core {
namespace {

bool hasUsableNumbers(const Sighting& sighting) {
  return sighting.direction.allFinite() && std::abs(sighting.direction.squaredNorm() - 1.0) < 1e-6 &&
         sighting.covariance.allFinite() && sighting.covariance.trace() > 0.0;
}

}  // namespace

UsableSightings usableSightings(const Scan& scan, std::size_t most) {
  UsableSightings usable;
  usable.scan = scan;
  usable.scan.sightings.clear();
  usable.decisions.resize(scan.sightings.size());
  for (std::size_t j = 0; j < scan.sightings.size(); ++j) {
    Association& decision = usable.decisions[j];
    decision.sighting = static_cast<std::uint32_t>(j);
    decision.decision = Decision::rejected_input;
    if (!hasUsableNumbers(scan.sightings[j])) {
      decision.reason = "direction is no finite unit vector or its covariance is not finite and positive";
    } else if (usable.scan.sightings.size() >= most) {
      decision.reason = "scan has " + std::to_string(scan.sightings.size()) +
                        " sightings, more than max_sightings " + std::to_string(most) +
                        ": raise it, or the sensor's threshold";
    } else {
      usable.place.push_back(j);
      usable.scan.sightings.push_back(scan.sightings[j]);
    }
  }
  return usable;
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
