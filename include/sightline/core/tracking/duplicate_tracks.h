#pragma once

#include <cstdint>
#include <vector>

#include "sightline/core/association/association.h"

namespace sightline::core {

/// Finds tracks that follow the same target: two that expect to see the same place, and of which a scan never
/// serves both. Two targets that fly together differ: a scan that shows both ends the suspicion. Plain state,
/// copied with the tracker's.
class DuplicateTracks {
 public:
  /// Takes the predictions of the established tracks for a scan, and its association. Returns the ids of the
  /// tracks that have been so together with another for `scans` scans in which one of them was seen; of each
  /// pair, the younger (higher id), ascending.
  std::vector<std::uint32_t> watch(const std::vector<TrackPrediction>& predictions,
                                   const AssociationResult& result, int scans);

 private:
  struct Pair {
    std::uint32_t older = 0, younger = 0;
    int scans = 0;
  };

  std::vector<Pair> pairs_;  // in ascending order
};

}  // namespace sightline::core
