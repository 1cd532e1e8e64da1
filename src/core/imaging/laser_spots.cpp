#include "sightline/core/imaging/laser_spots.h"

#include <cmath>

namespace sightline::core {
namespace {

/// Which beams belong together.
class Beams {
 public:
  Beams(const LaserSweep& sweep, const std::vector<float>& ranges, double gap)
      : sweep_(sweep), ranges_(ranges), gap_(gap) {}

  bool isHit(std::size_t k) const {
    const double range = rangeOf(k);
    return std::isfinite(range) && range >= sweep_.min_range && range <= sweep_.max_range;
  }

  /// Whether beam k (from 0, beyond the last one round the circle) hits what the beam before it hits.
  bool continues(std::size_t k) const {
    return isHit(k - 1) && isHit(k) && std::abs(rangeOf(k) - rangeOf(k - 1)) <= gap_;
  }

  double rangeOf(std::size_t k) const { return static_cast<double>(ranges_[k % ranges_.size()]); }

 private:
  const LaserSweep& sweep_;
  const std::vector<float>& ranges_;
  double gap_;
};

}  // namespace

std::vector<LaserSpot> laserSpots(const LaserSweep& sweep, const std::vector<float>& ranges,
                                  const LaserSpotParams& params) {
  std::vector<LaserSpot> spots;
  const Beams beams(sweep, ranges, params.gap);
  const std::size_t count = ranges.size();
  std::size_t start = 0;
  if (sweep.is_closed) {  // begin between two things, not within one
    for (start = 1; start < count && beams.continues(start); ++start) {
    }
  }
  for (std::size_t first = start; first < start + count;) {
    if (!beams.isHit(first)) {
      ++first;
      continue;
    }
    std::size_t next = first + 1;
    double sum = beams.rangeOf(first);
    for (; next < start + count && (sweep.is_closed || next < count) && beams.continues(next); ++next) {
      sum += beams.rangeOf(next);
    }
    const auto size = static_cast<double>(next - first);
    LaserSpot spot;
    spot.angle = sweep.first_angle + sweep.step * (static_cast<double>(first) + 0.5 * (size - 1.0));
    spot.width = size * std::abs(sweep.step);
    spot.range = sum / size;
    if (spot.width * spot.range <= params.max_size && size >= params.min_beams) spots.push_back(spot);
    first = next;
  }
  return spots;
}

}  // namespace sightline::core
