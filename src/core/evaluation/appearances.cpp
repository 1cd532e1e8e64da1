#include "sightline/core/evaluation/appearances.h"

#include <algorithm>
#include <iterator>

namespace sightline::core {

std::uint64_t Appearances::Appearance::most() const {
  std::uint64_t most = 0;
  for (const auto& [track, reports] : with_track) most = std::max(most, reports);
  return most;
}

void Appearances::observe(std::uint32_t target, double age, std::optional<std::uint32_t> track) {
  Appearance& appearance = now_[target];
  ++appearance.reports;
  if (!track) return;
  if (appearance.with_track.empty()) delays_.push_back(age);
  ++appearance.with_track[*track];
}

void Appearances::endAllBut(const std::vector<std::uint32_t>& present) {
  for (auto entry = now_.begin(); entry != now_.end();) {
    if (std::binary_search(present.begin(), present.end(), entry->first)) {
      ++entry;
      continue;
    }
    reports_ += entry->second.reports;
    most_ += entry->second.most();
    ++ended_;
    entry = now_.erase(entry);
  }
}

double Appearances::medianDelay() const {
  if (delays_.empty()) return kUnknown;
  std::vector<double> sorted = delays_;
  std::sort(sorted.begin(), sorted.end());
  const std::size_t middle = sorted.size() / 2;
  return sorted.size() % 2 == 1 ? sorted[middle] : 0.5 * (sorted[middle - 1] + sorted[middle]);
}

double Appearances::worstDelay() const {
  return delays_.empty() ? kUnknown : *std::max_element(delays_.begin(), delays_.end());
}

double Appearances::completeness() const {
  std::uint64_t all = reports_, most = most_;
  for (const auto& [target, appearance] : now_) {
    all += appearance.reports;
    most += appearance.most();
  }
  return all == 0 ? kUnknown : static_cast<double>(most) / static_cast<double>(all);
}

}  // namespace sightline::core
