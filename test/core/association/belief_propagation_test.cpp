#include "sightline/core/association/belief_propagation.h"

#include <cmath>

#include <gtest/gtest.h>

#include "sightline/core/association/exact_marginals.h"

namespace sightline::core {
namespace {

JointProbabilities emptyFor(const std::vector<GatedPair>& pairs, std::size_t tracks) {
  JointProbabilities probabilities;
  probabilities.missed.assign(tracks, 1.0);
  probabilities.paired.assign(pairs.size(), 0.0);
  return probabilities;
}

// On a tree (no two tracks share two sightings) belief propagation is exact.
TEST(BeliefPropagation, IsExactOnAChainOfTracks) {
  const std::vector<GatedPair> pairs{{0, 0, 1.0}, {0, 1, 2.0}, {1, 1, 0.5}, {1, 2, 1.5}, {2, 2, 0.3}};
  const std::vector<double> miss_weight{0.1, 0.2, 0.3};
  const Cluster cluster = clusterOf(pairs, clusters(pairs).front(), miss_weight);
  JointProbabilities by_messages = emptyFor(pairs, 3), exact = emptyFor(pairs, 3);
  propagateBelief(cluster, {}, by_messages);
  ASSERT_TRUE(sumExactly(cluster, 1000, exact));
  for (std::size_t k = 0; k < pairs.size(); ++k)
    EXPECT_NEAR(by_messages.paired[k], exact.paired[k], 1e-4) << k;
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(by_messages.missed[i], exact.missed[i], 1e-4) << i;
  EXPECT_FALSE(by_messages.is_exact);
  EXPECT_TRUE(by_messages.has_converged);
}

TEST(BeliefPropagation, TooFewRoundsAreSaid) {
  std::vector<GatedPair> pairs;
  for (int track = 0; track < 4; ++track)
    for (int sighting = 0; sighting < 4; ++sighting)
      pairs.push_back({track, sighting, 3.0 + 0.1 * track * sighting});
  const std::vector<double> miss_weight(4, 0.01);
  const Cluster cluster = clusterOf(pairs, clusters(pairs).front(), miss_weight);
  JointAssociationParams params;
  params.max_iterations = 1;
  JointProbabilities probabilities = emptyFor(pairs, 4);
  propagateBelief(cluster, params, probabilities);
  EXPECT_FALSE(probabilities.has_converged);
  for (std::size_t i = 0; i < 4; ++i) {
    double sum = probabilities.missed[i];
    for (std::size_t k = 0; k < 4; ++k) sum += probabilities.paired[4 * i + k];
    EXPECT_NEAR(sum, 1.0, 1e-12) << "probabilities of a track have the sum 1 all the same";
  }
}

}  // namespace
}  // namespace sightline::core
