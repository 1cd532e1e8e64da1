#include "sightline/core/continuity.h"

#include <algorithm>
#include <iterator>
#include <limits>

namespace sightline::core {

void Continuity::observe(std::uint32_t target, std::optional<std::uint32_t> track) {
  Target& state = targets_[target];
  ++observations_;
  if (track) ++covered_;
  if (state.covered && !track) ++breaks_;
  if (track && state.last && *state.last != *track) ++id_switches_;
  state.covered = track.has_value();
  if (track) state.last = track;
}

void Continuity::forgetAllBut(const std::vector<std::uint32_t>& present) {
  for (auto target = targets_.begin(); target != targets_.end();) {
    const bool stays = std::binary_search(present.begin(), present.end(), target->first);
    target = stays ? std::next(target) : targets_.erase(target);
  }
}

std::optional<std::uint32_t> Continuity::trackOf(std::uint32_t target) const {
  const auto found = targets_.find(target);
  if (found == targets_.end() || !found->second.covered) return std::nullopt;
  return found->second.last;
}

double Continuity::coverage() const {
  if (observations_ == 0) return std::numeric_limits<double>::quiet_NaN();
  return static_cast<double>(covered_) / static_cast<double>(observations_);
}

}  // namespace sightline::core
