#include "sightline/core/association/clusters.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>

namespace sightline::core {
namespace {

/// Representative of a node, with the way to it halved.
int rootOf(std::vector<int>& parent, int node) {
  while (parent[node] != node) {
    parent[node] = parent[parent[node]];
    node = parent[node];
  }
  return node;
}

}  // namespace

std::vector<std::vector<int>> clusters(const std::vector<GatedPair>& pairs) {
  int tracks = 0, sightings = 0;
  for (const GatedPair& pair : pairs) {
    if (pair.track < 0 || pair.sighting < 0) {
      throw std::invalid_argument("clusters: indices >= 0 are required, got track " +
                                  std::to_string(pair.track) + " and sighting " +
                                  std::to_string(pair.sighting));
    }
    tracks = std::max(tracks, pair.track + 1);
    sightings = std::max(sightings, pair.sighting + 1);
  }
  std::vector<int> parent(static_cast<std::size_t>(tracks));
  std::iota(parent.begin(), parent.end(), 0);
  std::vector<int> first_taker(static_cast<std::size_t>(sightings), -1);
  for (const GatedPair& pair : pairs) {
    int& first = first_taker[pair.sighting];
    if (first < 0) first = pair.track;
    const int a = rootOf(parent, first), b = rootOf(parent, pair.track);
    parent[std::max(a, b)] = std::min(a, b);
  }

  std::vector<std::vector<int>> groups;
  std::vector<int> group_of(static_cast<std::size_t>(tracks), -1);  // of each root
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    int& group = group_of[rootOf(parent, pairs[k].track)];
    if (group < 0) {
      group = static_cast<int>(groups.size());
      groups.emplace_back();
    }
    groups[group].push_back(static_cast<int>(k));
  }
  return groups;
}

int indexIn(const std::vector<int>& sorted, int value) {
  return static_cast<int>(std::lower_bound(sorted.begin(), sorted.end(), value) - sorted.begin());
}

std::vector<int> occurring(std::vector<int> values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
  return values;
}

Cluster clusterOf(const std::vector<GatedPair>& pairs, const std::vector<int>& group,
                  const std::vector<double>& miss_weight) {
  std::vector<int> tracks, sightings;
  for (const int k : group) {
    tracks.push_back(pairs[k].track);
    sightings.push_back(pairs[k].sighting);
  }
  Cluster cluster;
  cluster.tracks = occurring(std::move(tracks));
  sightings = occurring(std::move(sightings));
  cluster.choices.resize(cluster.tracks.size());
  cluster.takers.resize(sightings.size());
  for (const int k : group) {
    const int track = indexIn(cluster.tracks, pairs[k].track);
    const int sighting = indexIn(sightings, pairs[k].sighting);
    const double miss = std::max(miss_weight[pairs[k].track], kLeastMissWeight);
    cluster.choices[track].push_back({k, sighting, pairs[k].log_ratio - std::log(miss)});
    cluster.takers[sighting].push_back(track);
  }
  return cluster;
}

}  // namespace sightline::core
