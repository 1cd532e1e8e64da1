#pragma once

#include <cmath>
#include <functional>
#include <vector>

#include <Eigen/Core>

#include "sightline/core/positions/position_estimator.h"
#include "sightline/core/simulation/random_stream.h"

/// Stations round a field that see one target, for tests.
namespace sightline::test {

struct SimulatedTarget {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
};

/// Path of white acceleration of density q [m^2/s^3], exact at multiples of `step`.
class WanderingTarget {
 public:
  WanderingTarget(const SimulatedTarget& start, double q, std::uint64_t seed)
      : target_(start), q_(q), random_(seed) {}

  const SimulatedTarget& advance(double h) {
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::Vector2d n = random_.normalPair();
      target_.position(axis) +=
          h * target_.velocity(axis) + std::sqrt(q_ * h * h * h) * (0.5 * n.x() + n.y() / std::sqrt(12.0));
      target_.velocity(axis) += std::sqrt(q_ * h) * n.x();
    }
    return target_;
  }

 private:
  SimulatedTarget target_;
  double q_;
  core::RandomStream random_;
};

/// What a station gets wrong: white noise and a Gauss-Markov error of each angle.
class SimulatedStation {
 public:
  SimulatedStation(int number, const Eigen::Vector3d& origin, double white, const core::SlowError& slow,
                   std::uint64_t seed)
      : number_(number), origin_(origin), white_(white), slow_(slow), random_(seed) {
    error_ = std::sqrt(slow.variance) * random_.normalPair();
  }

  core::StationMeasurement see(double time, const Eigen::Vector3d& target) {
    const double phi = std::exp(-(time - last_) / slow_.time_constant);
    error_ = phi * error_ + std::sqrt(slow_.variance * (1.0 - phi * phi)) * random_.normalPair();
    last_ = time;
    core::StationMeasurement m;
    m.time = core::Time(core::durationOf(time));
    m.station = number_;
    m.ray.origin = origin_;
    const Eigen::Vector3d u = (target - origin_).normalized();
    m.ray.direction =
        (u + core::acrossBasis(u).transpose() * (error_ + white_ * random_.normalPair())).normalized();
    m.ray.covariance =
        white_ * white_ * (Eigen::Matrix3d::Identity() - m.ray.direction * m.ray.direction.transpose());
    m.slow = slow_;
    return m;
  }

  const Eigen::Vector3d& origin() const { return origin_; }

 private:
  int number_;
  Eigen::Vector3d origin_;
  double white_;
  core::SlowError slow_;
  core::RandomStream random_;
  Eigen::Vector2d error_ = Eigen::Vector2d::Zero();
  double last_ = 0.0;
};

}  // namespace sightline::test
