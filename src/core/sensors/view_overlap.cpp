#include "sightline/core/sensors/view_overlap.h"

#include <algorithm>
#include <limits>

#include "sightline/core/model/sphere.h"

namespace sightline::core {
namespace {

constexpr double kSimultaneous = 0.15;  // [s]
constexpr double kShare = 0.5;  // of the scans, in which one glimpse is of what others see, too (S-58)
constexpr std::size_t kLeast = 10;

}  // namespace

std::optional<double> separation(const std::vector<Glimpse>& mine, const std::vector<Glimpse>& others) {
  const Duration window = durationOf(kSimultaneous);
  std::vector<double> distances;
  std::size_t scans = 0;
  auto first = others.begin();
  for (const Glimpse& glimpse : mine) {
    while (first != others.end() && first->time < glimpse.time - window) ++first;
    const Glimpse* nearest = nullptr;
    double least =
        std::numeric_limits<double>::infinity();  // of the squared chords, which grow with the angles
    for (auto other = first; other != others.end() && other->time <= glimpse.time + window; ++other) {
      const double chord_squared = (glimpse.direction - other->direction).squaredNorm();
      if (chord_squared >= least) continue;
      least = chord_squared;
      nearest = &*other;
    }
    if (nearest == nullptr) continue;
    distances.push_back(angleBetween(glimpse.direction, nearest->direction));
    const bool is_same_scan = &glimpse != &mine.front() && (&glimpse - 1)->time == glimpse.time;
    scans += is_same_scan ? 0 : 1;
  }
  if (distances.size() < kLeast) return std::nullopt;
  // (S-58)
  const auto place = static_cast<std::ptrdiff_t>(kShare * static_cast<double>(scans));
  std::nth_element(distances.begin(), distances.begin() + place, distances.end());
  return distances[static_cast<std::size_t>(place)];
}

}  // namespace sightline::core
