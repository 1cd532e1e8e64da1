#include "sightline/core/model/sighting.h"

#include <cmath>
#include <sstream>
#include <string>

#include "sightline/core/model/angle_range.h"
#include "sightline/core/model/sphere.h"

namespace sightline::core {
namespace {

constexpr double kSmallestSigma = 1e-9;      // [rad]: a thousandth of an arc second is no camera's accuracy
constexpr double kLargestSigma = kPi / 2.0;  // [rad]: beyond, the sighting says nothing about the direction
constexpr double kAsymmetry = 1e-6;          // relative to the geometric mean of the variances

/// Arc on the sphere by one radian of azimuth (S-12): the cosine of the elevation. At a pole an azimuth
/// variance would shrink to nothing; there the elevation is still uncertain by its sigma, which holds the
/// target off the pole by as much, up to an arc as long as that sigma itself.
double arcOfAzimuth(double elevation, const Eigen::Matrix2d& covariance) {
  const double cosine = std::max(std::cos(elevation), 0.0);
  const double sigma_azimuth = std::sqrt(covariance(0, 0)), sigma_elevation = std::sqrt(covariance(1, 1));
  if (!(cosine * sigma_azimuth < kSmallestSigma)) return cosine;
  return std::max(cosine, std::min(sigma_elevation, sigma_elevation / sigma_azimuth));
}

}  // namespace

Sighting sightingOf(const Eigen::Vector2d& angles, const Eigen::Matrix2d& covariance, double snr) {  // (S-12)
  const Eigen::Vector2d on_sphere(angles.x(), withinPoles(angles.y()));
  Eigen::Matrix<double, 3, 2> D = directionJacobian(on_sphere);
  const double arc = arcOfAzimuth(on_sphere.y(), covariance);
  if (arc != std::cos(on_sphere.y())) {
    D.col(0) = arc * Eigen::Vector3d(-std::sin(angles.x()), std::cos(angles.x()), 0.0);
  }
  Sighting sighting;
  sighting.direction = directionOf(on_sphere);
  sighting.covariance = symmetric(D * covariance * D.transpose());
  sighting.snr = snr;
  return sighting;
}

Eigen::Matrix2d anglesCovariance(const Sighting& sighting) {  // (S-12)
  const Eigen::Matrix<double, 2, 3> A = anglesJacobian(sighting.direction);
  return symmetric(A * sighting.covariance * A.transpose());
}

Sighting rotate(const Sighting& sighting, const Eigen::Matrix3d& R_to_from) {
  Sighting turned = sighting;
  turned.direction = (R_to_from * sighting.direction).normalized();
  turned.covariance = symmetric(R_to_from * sighting.covariance * R_to_from.transpose());
  return turned;
}

std::optional<Refusal> rejectionOf(const Eigen::Vector2d& angles, const Eigen::Matrix2d& covariance) {
  std::ostringstream why;
  if (!angles.allFinite()) {
    why << "direction (" << angles.x() << ", " << angles.y()
        << ") rad is not finite: leave such sightings out";
    return invalid(why.str());
  }
  if (!isAzimuth(angles.x()) || !isElevation(angles.y())) {
    why << "direction (" << angles.x() << ", " << angles.y()
        << ") rad is off the sphere: azimuth within +-2 pi, elevation within +-pi/2; are these degrees?";
    return invalid(why.str());
  }
  if (!covariance.allFinite()) {
    why << "covariance is not finite: give the variances in rad^2";
    return invalid(why.str());
  }
  const double scale = std::sqrt(std::abs(covariance(0, 0) * covariance(1, 1)));
  if (std::abs(covariance(0, 1) - covariance(1, 0)) > kAsymmetry * scale) {
    why << "covariance is not symmetric (" << covariance(0, 1) << " and " << covariance(1, 0) << " rad^2)";
    return invalid(why.str());
  }
  if (covariance(0, 0) <= 0.0 || covariance.determinant() <= 0.0) {
    why << "covariance is not positive definite (variances " << covariance(0, 0) << ", " << covariance(1, 1)
        << " rad^2): the sensor's driver must state its sigma";
    return invalid(why.str());
  }
  // Judged on the sphere, where azimuth shrinks with the cosine of the elevation.
  Eigen::Matrix2d on_sphere = covariance;
  const double arc = std::max(arcOfAzimuth(withinPoles(angles.y()), covariance), kSmallestSigma);
  on_sphere.row(0) *= arc;
  on_sphere.col(0) *= arc;
  const double half = 0.5 * on_sphere.trace();
  const double largest = half + std::hypot(0.5 * (on_sphere(0, 0) - on_sphere(1, 1)), on_sphere(0, 1));
  const double smallest = on_sphere.determinant() / largest;  // a difference of eigenvalues would cancel
  if (!(smallest >= kSmallestSigma * kSmallestSigma)) {
    why << "sigma " << std::sqrt(std::max(smallest, 0.0)) << " rad is below " << kSmallestSigma
        << " rad: no sensor is that good; state the sigma in radians";
    return invalid(why.str());
  }
  if (!(largest <= kLargestSigma * kLargestSigma)) {
    why << "sigma " << std::sqrt(largest)
        << " rad is above pi/2: the sighting says nothing; are these degrees?";
    return invalid(why.str());
  }
  return std::nullopt;
}

Eigen::Matrix2d noiseCovariance(const Eigen::Matrix2d& R, const Eigen::Vector2d& noise_scale) {  // (S-11)
  const Eigen::Vector2d factors = noise_scale.cwiseSqrt();
  return factors.asDiagonal() * R * factors.asDiagonal();
}

}  // namespace sightline::core
