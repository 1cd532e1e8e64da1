#pragma once

#include <array>
#include <cstdint>

#include "sightline/core/evaluation/metrics.h"
#include "sightline/core/model/track.h"

namespace sightline::core {

/// What a tracker decided about its sightings, and whether its innovations agree with their covariance.
class InnovationStatistics {
 public:
  void add(const Association& association);

  /// Sightings with this decision.
  std::uint64_t count(Decision decision) const { return counts_[static_cast<std::size_t>(decision)]; }

  /// Normalised innovation squared (NIS): mean over the accepted sightings, divided by the two dimensions. It
  /// is 1 when the tracker's S is consistent; a gate of probability 0.99 lowers it by 0.05. NaN without any.
  double nis() const { return nis_.mean(); }

 private:
  std::array<std::uint64_t, 5> counts_{};
  RunningMean nis_;
};

}  // namespace sightline::core
