#include "sightline/core/positions/stations/seen_stations.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sightline/core/model/sphere.h"

namespace sightline::core {
namespace {

constexpr double kLongestInterval = 2.0;  // [s] that a station's interval may count for
constexpr double kMovedSigmas = 3.0;  // of a station's angle, by which its move must be seen to tell a range

}  // namespace

const SeenStation* SeenStations::find(int station) const {
  for (int i = 0; i < count_; ++i)
    if (seen_[static_cast<std::size_t>(i)].station == station) return &seen_[static_cast<std::size_t>(i)];
  return nullptr;
}

SeenStation& SeenStations::note(const StationMeasurement& m) {
  const SeenStation* found = find(m.station);
  std::size_t at = static_cast<std::size_t>(count_);
  if (found) {
    at = static_cast<std::size_t>(found - seen_.data());
  } else if (count_ < kMostSeen) {
    ++count_;
  } else {
    at = static_cast<std::size_t>(
        std::min_element(seen_.begin(), seen_.end(),
                         [](const SeenStation& a, const SeenStation& b) { return a.last < b.last; }) -
        seen_.begin());
  }
  SeenStation& seen = seen_[at];
  if (!found) {
    seen = SeenStation{};
    seen.station = m.station;
    seen.alone_origin = m.ray.origin;
  } else {
    const double h = seconds(m.time - seen.last);
    seen.since = h;
    if (h > 0.0 && h < kLongestInterval)
      seen.interval = seen.interval > 0.0 ? seen.interval + 0.2 * (h - seen.interval) : h;
  }
  seen.last = m.time;
  seen.origin = m.ray.origin;
  seen.variance = 0.5 * m.ray.covariance.trace() + m.slow.variance;
  return seen;
}

bool SeenStations::supports(const SeenStation& seen, Time now) const {
  const double patience = std::max(alone_after_, alone_intervals_ * seen.interval);
  return seconds(now - seen.last) < patience;
}

bool SeenStations::isAlone(const SeenStation& seen, const Eigen::Vector3d& point, Time now) const {
  const double range = (point - seen.origin).norm();
  for (int i = 0; i < count_; ++i) {
    const SeenStation& other = seen_[static_cast<std::size_t>(i)];
    if (other.station == seen.station || !supports(other, now)) continue;
    const double baseline = (other.origin - seen.origin).norm();
    if (baseline > kMovedSigmas * std::sqrt(seen.variance) * range) return false;
  }
  return true;
}

bool SeenStations::isAtRest(const SeenStation& seen, const Eigen::Vector3d& origin,
                            const Eigen::Vector3d& point) {
  const double range = (point - origin).norm();
  return (origin - seen.alone_origin).norm() < kMovedSigmas * std::sqrt(seen.variance) * range;
}

double SeenStations::unitSquared(const Eigen::Vector3d& point, Time now) const {
  double information = 0.0;
  int count = 0;
  for (int pass = 0; pass < 2 && count == 0; ++pass) {
    for (int i = 0; i < count_; ++i) {
      const SeenStation& seen = seen_[static_cast<std::size_t>(i)];
      if (pass == 0 && !supports(seen, now)) continue;
      information += 1.0 / (seen.variance * (point - seen.origin).squaredNorm());
      ++count;
    }
  }
  return count / information;
}

SeenStations::Support SeenStations::supportOf(const Eigen::Vector3d& point, Time now) const {
  Support support;
  support.nearest = std::numeric_limits<double>::infinity();
  for (int i = 0; i < count_; ++i) {
    const SeenStation& a = seen_[static_cast<std::size_t>(i)];
    const Eigen::Vector3d from_a = point - a.origin;
    if (!supports(a, now)) continue;
    support.nearest = std::min(support.nearest, from_a.norm());
    ++support.stations;
    for (int j = 0; j < i; ++j) {
      const SeenStation& b = seen_[static_cast<std::size_t>(j)];
      if (supports(b, now))
        support.parallax = std::max(support.parallax, angleBetween(from_a, point - b.origin));
    }
  }
  if (support.stations > 0) return support;
  for (int i = 0; i < count_; ++i)
    support.nearest = std::min(support.nearest, (point - seen_[static_cast<std::size_t>(i)].origin).norm());
  return support;
}

}  // namespace sightline::core
