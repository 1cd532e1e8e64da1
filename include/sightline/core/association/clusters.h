#pragma once

#include <vector>

namespace sightline::core {

/// A sighting in the gate of a track.
struct GatedPair {
  int track = 0;           ///< index, >= 0
  int sighting = 0;        ///< index, >= 0
  double log_ratio = 0.0;  ///< ln(P_D N(innovation; 0, S) / clutter density); -infinity = impossible
};

/// The groups of pairs that have nothing to do with one another: the connected components of the graph whose
/// nodes are tracks and sightings. Each group lists the indices of its pairs, ascending; groups come in the
/// order of their first pair. Time and memory are linear in the pairs and the largest index. Throws
/// std::invalid_argument for a negative index.
std::vector<std::vector<int>> clusters(const std::vector<GatedPair>& pairs);

}  // namespace sightline::core
