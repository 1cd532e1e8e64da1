#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "sightline/core/model/refusal.h"

/// Directions seen from several places, and the points at which they cross. All in one metric frame whose
/// axes do not turn; lengths in m, angles in rad.
namespace sightline::core {

/// How a ray turns: the rate of the unit vector to the target, and the motion of the place it is seen from.
struct RayMotion {
  Eigen::Vector3d rate = Eigen::Vector3d::Zero();        ///< d direction/dt, across the direction [rad/s]
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< of `rate` [rad^2/s^2], rank 2
  Eigen::Vector3d origin_velocity = Eigen::Vector3d::Zero();  ///< [m/s]
};

/// A direction seen from a place.
struct Ray {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();      ///< [m]
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  ///< unit vector
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< of `direction` [rad^2], rank 2, as of a Sighting
  std::optional<RayMotion> motion;
};

/// Whether origin, direction (a unit vector) and covariance are usable; the motion is not looked at.
bool isDetermined(const Ray& ray);

/// Largest standard deviation in any direction, of a covariance.
double largestSigma(const Eigen::Matrix3d& covariance);

/// Two unit vectors across a unit vector, as rows; they change smoothly with it except where z = -1.
Eigen::Matrix<double, 2, 3> acrossBasis(const Eigen::Vector3d& direction);

/// What a ray says of a point, linearised there (P-1).
struct RayInnovation {
  Eigen::Vector2d residual = Eigen::Vector2d::Zero();  ///< seen less expected, across the line of sight [rad]
  Eigen::Matrix<double, 2, 3> H = Eigen::Matrix<double, 2, 3>::Zero();  ///< d expected/d point [rad/m]
  Eigen::Matrix2d R = Eigen::Matrix2d::Identity();                      ///< covariance of the ray [rad^2]
  double range = 0.0;                                                   ///< from the origin to the point [m]
};

/// (P-1). nullopt when the point is at the origin or behind the ray (more than 90 degrees from it).
std::optional<RayInnovation> innovationOf(const Ray& ray, const Eigen::Vector3d& point);

/// Chi-square of a ray against a target of this (position, velocity): 2 degrees of freedom, 4 with the rate
/// (P-2), which counts where the ray has motion. nullopt as for innovationOf.
std::optional<double> distanceSquared(const Ray& ray, const Eigen::Matrix<double, 6, 1>& state,
                                      const Eigen::Matrix<double, 6, 6>& covariance, bool with_rate);

/// The point at which rays cross, and how well it is known.
struct Intersection {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();       ///< [m]
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< of `point` [m^2]
  std::optional<Eigen::Vector3d> velocity;  ///< [m/s]; when at least two rays have motion and tell it
  Eigen::Matrix<double, 6, 6> joint_covariance =
      Eigen::Matrix<double, 6, 6>::Zero();  ///< of (point, velocity); the velocity's part 0 without one
  double chi_square = 0.0;                  ///< of the residuals
  int degrees = 0;        ///< of freedom of `chi_square`: 2 n - 3, with rates of m rays 2 m - 3 more
  double parallax = 0.0;  ///< largest angle between two rays at the point [rad]
  double relative_sigma =
      0.0;  ///< largest standard deviation of `point` over the distance to the nearest origin

  Eigen::Matrix3d velocityCovariance() const { return joint_covariance.bottomRightCorner<3, 3>(); }
};

/// Whether rays cross.
enum class CrossingVerdict {
  crossing,       ///< at `Crossing::at`
  too_few,        ///< less than two rays
  bad_ray,        ///< a ray is not finite, or its covariance is not positive definite across it
  parallel,       ///< the rays do not tell a point
  behind,         ///< they cross, but behind an origin
  not_converged,  ///< the iteration did not end; the rays contradict each other
};

struct Crossing {
  CrossingVerdict verdict = CrossingVerdict::too_few;
  Intersection at;  ///< valid with `crossing`
};

/// What the verdict is called in reports, and what it means.
Refusal refusalOf(CrossingVerdict verdict);

/// The point that explains all rays best, sum nu^T C^-1 nu least, by Gauss-Newton from the midpoints of the
/// common perpendiculars; with rates of two rays or more, the velocity together with it (P-2).
Crossing intersect(const std::vector<Ray>& rays);

/// Whether two rays lie in one plane with their baseline, as rays to one target do (P-3).
struct PlaneTest {
  double offset = 0.0;                ///< tau: volume of (baseline, direction, direction), unit vectors [rad]
  double variance = 0.0;              ///< of `offset` [rad^2]
  std::optional<double> offset_rate;  ///< d tau/dt [rad/s], when both rays have motion
  double rate_variance = 0.0;         ///< of `offset_rate` [rad^2/s^2]
  double range_a = 0.0;  ///< along either ray to the points nearest to the other [m]; negative: behind
  double range_b = 0.0;
  double parallax = 0.0;  ///< angle between the rays [rad]

  bool isAhead() const { return range_a > 0.0 && range_b > 0.0; }
  /// offset^2/variance, plus the same of the rate where there is one: chi-square of `degrees()`.
  double distanceSquared() const;
  int degrees() const { return offset_rate ? 2 : 1; }
};

/// (P-3). nullopt when the rays start at one place (closer than `least_baseline` [m]) or are parallel.
std::optional<PlaneTest> planeTest(const Ray& a, const Ray& b, double least_baseline = 1e-3);

/// The plane of a ray with a baseline: all rays to one target lie at one angle, so that sorted lists of two
/// stations' rays pair in M log M.
struct PlaneAngle {
  double angle = 0.0;     ///< about the baseline, in (-pi, pi] [rad]
  double variance = 0.0;  ///< [rad^2]; infinite for a ray along the baseline
};

/// Angle of a ray about a unit vector `axis`; zero is at the first row of acrossBasis(axis).
PlaneAngle planeAngle(const Ray& ray, const Eigen::Vector3d& axis);

}  // namespace sightline::core
