#include "sightline/core/evaluation/track_lives.h"

#include <algorithm>
#include <limits>

namespace sightline::core {

void TrackLives::observe(std::uint32_t track, std::optional<std::uint32_t> target) {
  Life& life = lives_[{run_, track}];
  ++life.reports;
  if (target) ++life.on_target[*target];
}

std::size_t TrackLives::falseTracks() const {
  return static_cast<std::size_t>(std::count_if(lives_.begin(), lives_.end(), [](const auto& entry) {
    std::uint64_t on_any = 0;
    for (const auto& [target, reports] : entry.second.on_target) on_any += reports;
    return 2 * on_any < entry.second.reports;
  }));
}

double TrackLives::purity() const {
  std::uint64_t all = 0, pure = 0;
  for (const auto& [id, life] : lives_) {
    std::uint64_t most = 0;
    for (const auto& [target, reports] : life.on_target) most = std::max(most, reports);
    all += life.reports;
    pure += most;
  }
  if (all == 0) return std::numeric_limits<double>::quiet_NaN();
  return static_cast<double>(pure) / static_cast<double>(all);
}

}  // namespace sightline::core
