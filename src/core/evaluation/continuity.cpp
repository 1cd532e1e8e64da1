#include "sightline/core/evaluation/continuity.h"

#include <algorithm>
#include <iterator>
#include <limits>

namespace sightline::core {

Continuity::Change Continuity::observe(std::uint32_t target, std::optional<std::uint32_t> track) {
  Target& state = targets_[target];
  const Change change{state.covered && !track, track && state.last && *state.last != *track};
  ++observations_;
  if (track) ++covered_;
  if (change.lost) ++breaks_;
  if (change.switched) ++id_switches_;
  state.covered = track.has_value();
  if (track) state.last = track;
  return change;
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
