#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "sightline/core/model/sphere.h"

#include "recordings.h"

/// The recordings of the accuracy table: one target's sightings, stretch by stretch.
namespace sightline::bench {

/// One line of the table.
struct Recorded {
  std::string name;
  bool in_section_8 = false;
  double reference_best = std::nan("");  ///< of the best single filter, section 8 [degree]
  std::vector<Stretch> stretches;        ///< the first six of at least 40 sightings
};

/// Reads them from the folder of the recordings: the seven of section 8, the drone's other cameras, thermal
/// clips, the boats of the harbour and targets of `crossing`. Throws std::runtime_error naming a file that
/// cannot be read.
std::vector<Recorded> recordedTargets(const std::string& folder);

}  // namespace sightline::bench
