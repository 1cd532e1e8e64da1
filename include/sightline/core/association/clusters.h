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

/// One cluster with its tracks and sightings numbered from 0, as the joint probabilities need it.
struct Cluster {
  struct Choice {
    int pair = 0;         ///< index in the caller's list
    int sighting = 0;     ///< within the cluster
    double weight = 0.0;  ///< ln(likelihood ratio / miss weight)
  };
  std::vector<int> tracks;                   ///< the caller's index of each
  std::vector<std::vector<Choice>> choices;  ///< of each track
  std::vector<std::vector<int>> takers;      ///< tracks of each sighting
};

/// `group`: indices of the cluster's pairs; `miss_weight`: 1 - P_D P_G of each of the caller's tracks; those
/// below kLeastMissWeight count as that.
Cluster clusterOf(const std::vector<GatedPair>& pairs, const std::vector<int>& group,
                  const std::vector<double>& miss_weight);

constexpr double kLeastMissWeight = 1e-12;

/// The values that occur, sorted, each once.
std::vector<int> occurring(std::vector<int> values);

/// Position of a value in the sorted list of those that occur.
int indexIn(const std::vector<int>& sorted, int value);

}  // namespace sightline::core
