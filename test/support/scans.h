#pragma once

#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <sightline/SightingArray.h>

/// A scan of that sensor with sightings at (azimuth, elevation) [rad] of that sigma [rad], in platform_enu.
inline sightline::SightingArray scanOf(const std::string& sensor, double stamp,
                                       const std::vector<std::pair<double, double>>& angles,
                                       double sigma = 1e-3) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  sightline::SightingArray scan;
  scan.header.stamp = ros::Time(stamp);
  scan.header.frame_id = "platform_enu";
  scan.sensor = sensor;
  scan.ifov = scan.detection_probability = scan.clutter_density = kNaN;
  for (const auto& [azimuth, elevation] : angles) {
    sightline::Sighting sighting;
    sighting.azimuth = azimuth;
    sighting.elevation = elevation;
    sighting.covariance = {sigma * sigma, 0.0, 0.0, sigma * sigma};
    sighting.snr = kNaN;
    scan.sightings.push_back(sighting);
  }
  return scan;
}

/// A target on its way, seen with a noise of 1 mrad.
class SeenTarget {
 public:
  explicit SeenTarget(unsigned seed) : random_(seed) {}

  std::pair<double, double> at(double time, double noise = 1e-3) {
    return {0.9 + 0.3 * std::sin(0.5 * time) + noise * normal_(random_),
            0.2 * std::cos(0.5 * time) + noise * normal_(random_)};
  }

 private:
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
};
