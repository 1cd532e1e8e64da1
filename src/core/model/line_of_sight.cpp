#include "sightline/core/model/line_of_sight.h"

#include <cmath>

#include <Eigen/Geometry>

#include "sightline/core/model/sphere.h"

namespace sightline::core {
namespace {

constexpr double kSingular = 1e-12;  // of a 2x2 covariance: determinant over the trace's square

/// Unit vectors across a unit direction: along growing azimuth and along growing elevation, 3x2.
Eigen::Matrix<double, 3, 2> across(const Eigen::Vector3d& direction) {
  const double azimuth = anglesOf(direction).x();
  Eigen::Matrix<double, 3, 2> axes;
  axes.col(0) << -std::sin(azimuth), std::cos(azimuth), 0.0;
  axes.col(1) = direction.cross(axes.col(0));
  return axes;
}

bool isPositiveDefinite(const Eigen::Matrix2d& covariance) {
  const double trace = covariance.trace();
  return covariance.allFinite() && covariance(0, 0) > 0.0 &&
         covariance.determinant() > kSingular * trace * trace;
}

}  // namespace

bool hasDirection(const Eigen::Vector3d& vector) {
  return vector.allFinite() && vector.stableNorm() > 0.0;
}

// (S-15)
std::optional<Sighting> sightingOfPoint(const Eigen::Vector3d& point, const Eigen::Matrix3d& covariance) {
  if (!hasDirection(point)) return std::nullopt;
  Sighting sighting;
  sighting.direction = point.stableNormalized();
  const Eigen::Matrix<double, 3, 2> axes = across(sighting.direction);
  const double range = point.stableNorm();
  const Eigen::Matrix2d on_sphere = symmetric(axes.transpose() * covariance * axes) / (range * range);
  if (!isPositiveDefinite(on_sphere)) return std::nullopt;
  sighting.covariance = symmetric(axes * on_sphere * axes.transpose());
  return sighting;
}

std::optional<Sighting> sightingAlong(const Eigen::Vector3d& direction, const Eigen::Vector2d& sigma) {
  if (!hasDirection(direction)) return std::nullopt;
  Sighting sighting;
  sighting.direction = direction.stableNormalized();
  const Eigen::Matrix<double, 3, 2> axes = across(sighting.direction);
  sighting.covariance = symmetric(axes * sigma.cwiseAbs2().asDiagonal() * axes.transpose());
  return sighting;
}

Eigen::Matrix3d R_boresight_optical() {
  Eigen::Matrix3d R;
  R << 0.0, 0.0, 1.0,  //
      -1.0, 0.0, 0.0,  //
      0.0, -1.0, 0.0;
  return R;
}

}  // namespace sightline::core
