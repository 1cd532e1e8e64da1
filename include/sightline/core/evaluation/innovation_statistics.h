#pragma once

#include <array>
#include <cstdint>

#include "sightline/core/evaluation/metrics.h"
#include "sightline/core/model/track.h"

namespace sightline::core {

/// What a tracker did with its sightings, and whether it expected them where they came.
class InnovationStatistics {
 public:
  void add(const Association& association);

  /// Sightings with this decision.
  std::uint64_t count(Decision decision) const { return counts_[static_cast<std::size_t>(decision)]; }

  /// Mean squared innovation of the accepted sightings over S and over its two dimensions: 1 when the
  /// tracker's S is honest (a gate of probability 0.99 takes 0.05 off). NaN without any.
  double nis() const { return nis_.mean(); }

 private:
  std::array<std::uint64_t, 5> counts_{};
  RunningMean nis_;
};

}  // namespace sightline::core
