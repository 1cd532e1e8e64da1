#include "sightline/core/ordering/scan_order.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

namespace sightline::core {
namespace {

/// Below, equal or above: -1, 0, 1. NaN (not known) is above all numbers.
int compared(double a, double b) {
  if (std::isnan(a) || std::isnan(b))
    return static_cast<int>(std::isnan(a)) - static_cast<int>(std::isnan(b));
  return static_cast<int>(b < a) - static_cast<int>(a < b);
}

int compared(const double* a, const double* b, std::ptrdiff_t size) {
  for (std::ptrdiff_t i = 0; i < size; ++i) {
    if (const int difference = compared(a[i], b[i])) return difference;
  }
  return 0;
}

template <typename Matrix>
int compared(const Matrix& a, const Matrix& b) {
  return compared(a.data(), b.data(), a.size());
}

int compared(const std::optional<FieldOfView>& a, const std::optional<FieldOfView>& b) {
  if (!a || !b) return static_cast<int>(a.has_value()) - static_cast<int>(b.has_value());
  if (const int difference = compared(a->half_widths, b->half_widths)) return difference;
  return compared(a->R_sensor_tracking, b->R_sensor_tracking);
}

/// All that is stated beside time and sensor: the sightings, one after the other in memory, and what holds
/// for all of them.
struct Content {
  const Sighting* sightings;
  std::ptrdiff_t size;
  std::array<double, 4> stated;
  const std::optional<FieldOfView>& view;
};

int compared(const Content& a, const Content& b) {
  for (std::ptrdiff_t i = 0; i < std::min(a.size, b.size); ++i) {
    if (const int difference = compared(a.sightings[i].direction, b.sightings[i].direction))
      return difference;
  }
  if (a.size != b.size) return a.size < b.size ? -1 : 1;
  for (std::ptrdiff_t i = 0; i < a.size; ++i) {
    if (const int difference = compared(a.sightings[i].covariance, b.sightings[i].covariance))
      return difference;
    if (const int difference = compared(a.sightings[i].snr, b.sightings[i].snr)) return difference;
  }
  if (const int difference = compared(a.stated.data(), b.stated.data(), 4)) return difference;
  return compared(a.view, b.view);
}

bool operator<(const Content& a, const Content& b) {
  return compared(a, b) < 0;
}

Content contentOf(const Scan& scan) {
  return {scan.sightings.data(),
          static_cast<std::ptrdiff_t>(scan.sightings.size()),
          {scan.ifov, scan.detection_probability, scan.clutter_density, scan.noise_scale},
          scan.view};
}

Content contentOf(const Tracklet& tracklet) {
  static const std::optional<FieldOfView> kNone;
  return {&tracklet.sighting, 1, {tracklet.ifov, tracklet.sightings, 0.0, 0.0}, kNone};
}

}  // namespace

bool precedes(const Scan& a, const Scan& b) {
  return precedes(a.time, a.sensor, contentOf(a), b.time, b.sensor, contentOf(b));
}

bool precedes(const Tracklet& a, const Tracklet& b) {
  return precedes(a.time, a.sensor, contentOf(a), b.time, b.sensor, contentOf(b));
}

}  // namespace sightline::core
