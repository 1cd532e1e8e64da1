#pragma once

#include <cstddef>

#include "sightline/core/association/clusters.h"
#include "sightline/core/association/joint_association.h"

namespace sightline::core {

/// Writes the exact marginals (S-33) of a cluster's pairs and tracks into `probabilities`: sums over the
/// steps forward and backward, and reads the marginals where they meet. False, and nothing written, if the
/// sums have more than `max_terms` terms.
bool sumExactly(const Cluster& cluster, std::size_t max_terms, JointProbabilities& probabilities);

}  // namespace sightline::core
