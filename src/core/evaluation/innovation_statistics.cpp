#include "sightline/core/evaluation/innovation_statistics.h"

#include <cmath>

namespace sightline::core {

void InnovationStatistics::add(const Association& association) {
  const auto decision = static_cast<std::size_t>(association.decision);
  if (decision >= counts_.size()) return;  // of a later version
  ++counts_[decision];
  const bool is_accepted = association.decision == Decision::accepted;
  if (is_accepted && std::isfinite(association.distance_squared))
    nis_.add(0.5 * association.distance_squared);
}

}  // namespace sightline::core
