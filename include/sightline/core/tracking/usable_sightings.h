#pragma once

#include <cstddef>
#include <string>
#include <vector>

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

/// Usable is a finite unit vector with a finite covariance that is not zero, of the first `most` in the scan.
UsableSightings usableSightings(const Scan& scan, std::size_t most);

}  // namespace sightline::core
