#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "sightline/core/estimators/estimators.h"
#include "sightline/core/model/refusal.h"
#include "sightline/core/model/sighting.h"
#include "sightline/core/model/track.h"

namespace sightline::core {

/// A scan's usable sightings, with their places in it and the verdict on the others.
struct UsableSightings {
  Scan scan;                           ///< with the usable sightings alone
  std::vector<std::size_t> place;      ///< of each of these in the original scan
  std::vector<Association> decisions;  ///< for each sighting of the original: REJECTED_INPUT, those that are
                                       ///< not usable with their reason

  /// Enters the decisions on the usable sightings, in their order.
  void enter(std::vector<Association> made);

  /// Enters one reason for rejecting all of the usable sightings.
  void rejectAll(const std::string& reason);
};

/// Usable is what `isUsable` says (model/usable_sighting.h), of the first `most` in the scan. What the scan
/// states of its sensor and cannot be (a probability of 7, a density that is infinite) is not known.
UsableSightings usableSightings(const Scan& scan, std::size_t most);

/// The scan with its noise taken for `noise_scale` times as large.
Scan withNoise(const Scan& scan, double noise_scale);

/// Why an estimator that weighs sensors by their ifov cannot use a scan; nullopt when it can.
std::optional<Refusal> whyNotWeighable(const Scan& scan, const EstimatorParams& params);

}  // namespace sightline::core
