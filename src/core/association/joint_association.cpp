#include "sightline/core/association/joint_association.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "sightline/core/association/belief_propagation.h"
#include "sightline/core/association/exact_marginals.h"
#include "sightline/core/association/log_sum.h"

namespace sightline::core {
namespace {

/// A track that has its sightings for itself: the ratio of each to the sum.
void sumAlone(const std::vector<GatedPair>& pairs, const std::vector<int>& group, double miss_weight,
              JointProbabilities& probabilities) {
  const double miss = std::log(std::max(miss_weight, kLeastMissWeight));
  LogSum sum;
  sum.add(miss);
  for (const int k : group) sum.add(pairs[k].log_ratio);
  probabilities.missed[pairs[group.front()].track] = std::exp(miss - sum.value());
  for (const int k : group) probabilities.paired[k] = std::exp(pairs[k].log_ratio - sum.value());
}

bool haveOneTrack(const std::vector<GatedPair>& pairs, const std::vector<int>& group) {
  return std::all_of(group.begin(), group.end(),
                     [&](int k) { return pairs[k].track == pairs[group.front()].track; });
}

void check(bool holds, const std::string& rule) {
  if (!holds) throw std::invalid_argument("jointProbabilities: " + rule);
}

void check(const std::vector<GatedPair>& pairs, const std::vector<double>& miss_weight,
           const JointAssociationParams& params) {
  check(params.max_iterations >= 1 && params.tolerance > 0.0,
        "max_iterations >= 1 and tolerance > 0 are required");
  for (const double weight : miss_weight) {
    check(weight >= 0.0 && weight <= 1.0,
          "a miss weight in [0, 1] is required (1 - P_D P_G), got " + std::to_string(weight));
  }
  for (const GatedPair& pair : pairs) {
    check(pair.track >= 0 && static_cast<std::size_t>(pair.track) < miss_weight.size(),
          "track " + std::to_string(pair.track) + " of a pair is none of the " +
              std::to_string(miss_weight.size()) + " that have a miss weight");
    check(pair.log_ratio < std::numeric_limits<double>::infinity(),  // false for NaN too
          "a log ratio below infinity is required, got " + std::to_string(pair.log_ratio));
  }
}

}  // namespace

JointProbabilities jointProbabilities(const std::vector<GatedPair>& pairs,
                                      const std::vector<double>& miss_weight,
                                      const JointAssociationParams& params) {
  check(pairs, miss_weight, params);
  JointProbabilities probabilities;
  probabilities.missed.assign(miss_weight.size(), 1.0);
  probabilities.paired.assign(pairs.size(), 0.0);
  for (const std::vector<int>& group : clusters(pairs)) {
    if (haveOneTrack(pairs, group)) {
      sumAlone(pairs, group, miss_weight[pairs[group.front()].track], probabilities);
      continue;
    }
    const Cluster cluster = clusterOf(pairs, group, miss_weight);
    if (!sumExactly(cluster, params.max_terms, probabilities))
      propagateBelief(cluster, params, probabilities);
  }
  return probabilities;
}

}  // namespace sightline::core
