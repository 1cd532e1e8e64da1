#pragma once

#include <optional>

#include <Eigen/Core>

#include "sightline/core/model/refusal.h"
#include "sightline/core/model/sphere.h"

/// Local tracks brought to a common time. Coordinates are those of one chart throughout.
namespace sightline::core {

/// State `h` seconds later (or earlier) at constant rates, plus white acceleration of a density of each
/// channel's own
/// (`q`, [rad^2/s^3]); the same as `propagate` with one density for both.
AngularState propagate(const AngularState& state, double h, const Eigen::Vector2d& q);

/// The density of white acceleration [rad^2/s^3] that each channel of a track's covariance speaks of.
///
/// A report does not say which process noise its tracker assumed, but its covariance does: in the steady
/// state of a constant-velocity Kalman filter with sightings of spectral density r, position variance P11 =
/// sqrt(2) q^(1/4) r^(3/4) and rate variance P22 = sqrt(2) q^(3/4) r^(1/4), so that q = sqrt(P22^3 / (2
/// P11)), whatever the scale of the angles and the rate of the sightings. For a line fitted to a window of
/// length T it gives 3.7 P11 / T^3: the density for which a filter's memory is as long as the window. At most
/// `kLargestDensityRatio` P11, where the rates are not known yet.
Eigen::Vector2d impliedProcessNoise(const Eigen::Matrix4d& covariance);

/// Largest density / position variance that is believed [1/s^3]: a memory of about 6 ms.
constexpr double kLargestDensityRatio = 1e6;

/// Why a reported state cannot be used (invalid); nullopt when it can. Refused: a mean that is not finite or
/// off the sphere (degrees?), a covariance that is not finite, not symmetric, not positive definite (zero:
/// truth?), or whose smallest position sigma on the sphere is below 1e-9 rad or above pi/2 rad; and what no
/// target can have and no computation can carry: a rate on the sphere above 1e4 rad/s, a sigma above 1e3 rad
/// or 1e6 rad/s. One large sigma is welcome: a sensor that sees the azimuth alone leaves the elevation open.
std::optional<Refusal> rejectionOf(const AngularState& state);

/// The larger of the position's two sigmas on the sphere, where azimuth shrinks with the cosine of the
/// elevation [rad].
double largestPositionSigma(const AngularState& state);

}  // namespace sightline::core
