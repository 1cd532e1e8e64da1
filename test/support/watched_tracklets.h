#pragma once

#include <random>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "sightline/core/estimators/estimators.h"
#include "sightline/core/model/tracklet.h"
#include "sightline/core/sensors/sensor_guard.h"

#include "support/tracklet_platform.h"

/// Tracklets of several sensors of which one is faulty, for tests of the guard.
namespace sightline::test {

/// A target on a straight path, seen by `sensors` sensors every 30 ms each, one after the other; the last one
/// may be faulty from t = 2 s on.
struct Watched {
  int sensors = 3;
  double duration = 5.0;           // [s]
  double bias = 0.0;               // [sigma], in both angles
  double noise = 1.0;              // factor on the last one's sigma
  double from = 2.0, until = 1e9;  // of the harm [s]
  unsigned seed = 1;
};

constexpr double kWatchedSigma = 1e-3;  // [rad]

inline Eigen::Vector2d straight(double t) {
  return {0.01 * t, 0.2 - 0.005 * t};
}

inline std::vector<core::Tracklet> trackletsOf(const Watched& watched) {
  std::mt19937_64 random(watched.seed);
  std::normal_distribution<double> normal;
  std::vector<core::Tracklet> tracklets;
  for (int k = 0; 0.03 * k / watched.sensors < watched.duration; ++k) {
    const double t = 0.03 * k / watched.sensors;
    const bool is_last = k % watched.sensors == watched.sensors - 1;
    const bool harms = is_last && t >= watched.from && t < watched.until;
    const double n1 = normal(random), n2 = normal(random);
    core::Tracklet tracklet;
    tracklet.time = platformTime(t);
    tracklet.sensor = std::string("camera ") + static_cast<char>('a' + k % watched.sensors);
    const Eigen::Vector2d error = (harms ? watched.noise : 1.0) * Eigen::Vector2d(n1, n2) +
                                  (harms ? watched.bias : 0.0) * Eigen::Vector2d::Ones();
    tracklet.sighting = core::sightingOf(straight(t) + kWatchedSigma * error,
                                         kWatchedSigma * kWatchedSigma * Eigen::Matrix2d::Identity());
    tracklets.push_back(tracklet);
  }
  return tracklets;
}

inline core::EstimatorParams kalmanOf(double ratio) {
  core::EstimatorParams estimator;
  estimator.kind = core::EstimatorKind::kalman;
  estimator.kalman.process_noise_ratio = ratio;
  return estimator;
}

inline core::GuardParams noGuard() {
  core::GuardParams guard;
  guard.enabled = false;
  return guard;
}

}  // namespace sightline::test
