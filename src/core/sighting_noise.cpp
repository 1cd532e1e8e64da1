#include "sightline/core/sighting_noise.h"

#include <algorithm>

#include <Eigen/LU>

#include "sightline/core/sphere.h"

namespace sightline::core {
namespace {

constexpr int kMemory = 32;  // sightings over which the mean is smoothed

Eigen::Matrix2d inverse(const Eigen::Matrix2d& positive_definite) {
  return symmetric(positive_definite.inverse());  // 2x2: exact but for the cancellation in the determinant
}

}  // namespace

void SightingNoise::add(const Eigen::Matrix2d& R) {
  sightings_ = std::min(sightings_ + 1, kMemory);
  information_ += (inverse(R) - information_) / sightings_;
  covariance_ = inverse(information_);
}

void SightingNoise::transform(const Eigen::Matrix2d& J) {
  if (sightings_ == 0) return;
  covariance_ = symmetric(J * covariance_ * J.transpose());
  information_ = inverse(covariance_);
}

}  // namespace sightline::core
