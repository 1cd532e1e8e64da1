#include "sightline/core/estimators/sighting_noise.h"

#include <algorithm>

#include <Eigen/LU>

#include "sightline/core/model/sphere.h"

namespace sightline::core {
namespace {

constexpr double kMemory = 32.0;  // sightings over which the mean is smoothed

Eigen::Matrix2d inverse(const Eigen::Matrix2d& positive_definite) {
  return symmetric(positive_definite.inverse());  // 2x2: exact but for the cancellation in the determinant
}

}  // namespace

void SightingNoise::add(const Eigen::Matrix2d& R, double sightings) {  // (S-24)
  sightings_ = std::min(sightings_ + sightings, kMemory);
  information_ += std::min(sightings / sightings_, 1.0) * (inverse(sightings * R) - information_);
  covariance_ = inverse(information_);
}

void SightingNoise::transform(const Eigen::Matrix2d& J) {
  if (sightings_ == 0.0) return;
  covariance_ = symmetric(J * covariance_ * J.transpose());
  information_ = inverse(covariance_);
}

Eigen::Matrix2d passingAcceleration(const Eigen::Vector2d& rates, double unit) {  // (S-97)
  const double rate = rates.norm();
  return (1.0 - 1.0 / unit) * rate * rate * rate * Eigen::Matrix2d::Identity();
}

}  // namespace sightline::core
