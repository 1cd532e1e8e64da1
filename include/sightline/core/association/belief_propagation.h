#pragma once

#include "sightline/core/association/clusters.h"
#include "sightline/core/association/joint_association.h"

namespace sightline::core {

/// Writes the marginals of a cluster by loopy belief propagation (S-34) into `probabilities`, which is no
/// longer exact; `has_converged` becomes false if the messages still change after `max_iterations` rounds.
void propagateBelief(const Cluster& cluster, const JointAssociationParams& params,
                     JointProbabilities& probabilities);

}  // namespace sightline::core
