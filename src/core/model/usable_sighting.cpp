#include "sightline/core/model/usable_sighting.h"

#include <cmath>

#include <Eigen/Geometry>

#include "sightline/core/model/sphere.h"

namespace sightline::core {
namespace {

constexpr double kUnevenness = 1e-6;         // of the direction's length squared, and of the covariance
constexpr double kLeastUsableSigma = 1e-12;  // [rad]
constexpr double kRounding = 1e-9;           // of the smaller variance, relative to the larger

}  // namespace

bool isUsable(const Sighting& sighting) {
  const Eigen::Vector3d& direction = sighting.direction;
  const Eigen::Matrix3d& C = sighting.covariance;
  if (!direction.allFinite() || !C.allFinite()) return false;
  if (!(std::abs(direction.squaredNorm() - 1.0) < kUnevenness)) return false;
  if (!((C - C.transpose()).cwiseAbs().maxCoeff() <= kUnevenness * C.cwiseAbs().maxCoeff())) return false;
  Eigen::Matrix<double, 3, 2> across;  // of the tangent plane
  across.col(0) = direction.unitOrthogonal();
  across.col(1) = direction.cross(across.col(0));
  const Eigen::Matrix2d plane = across.transpose() * C * across;
  const double half = 0.5 * plane.trace();
  const double root = std::hypot(0.5 * (plane(0, 0) - plane(1, 1)), plane(0, 1));
  const double largest = half + root, smallest = half - root;
  return largest >= kLeastUsableSigma * kLeastUsableSigma &&
         largest <= kLargestDirectionSigma * kLargestDirectionSigma && smallest >= -kRounding * largest;
}

}  // namespace sightline::core
