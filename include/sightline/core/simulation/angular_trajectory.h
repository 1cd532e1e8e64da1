#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "sightline/core/model/refusal.h"
#include "sightline/core/model/sphere.h"
#include "sightline/core/simulation/route.h"

/// Motions given as (azimuth, elevation) [rad] in platform_enu: of targets so far that the platform's own way
/// does not change them. Time counts from the target's start [s]; every motion goes on for ever. Elevations
/// beyond +-pi/2 mean that the target has gone over the pole.
namespace sightline::core {

/// angles = offset + amplitude sin(frequency t + phase), each channel for itself. The default is the paper's
/// target: azimuth = sin t, elevation = cos t.
struct Sinusoid {
  Eigen::Vector2d amplitude{1.0, 1.0};                 ///< [rad]
  Eigen::Vector2d frequency{1.0, 1.0};                 ///< [rad/s]
  Eigen::Vector2d phase{0.0, 1.57079632679489661923};  ///< [rad]
  Eigen::Vector2d offset{0.0, 0.0};                    ///< [rad]
};

/// Constant rates.
struct AngularLine {
  Eigen::Vector2d angles{-1.0, 0.5};  ///< at the start [rad]
  Eigen::Vector2d rates{0.3, -0.1};   ///< [rad/s]
};

/// Acceleration of one channel within [from, to): constant + amplitude sin(frequency (t - from) + phase).
struct AccelerationPiece {
  double from = 0.0;       ///< [s]
  double to = 0.0;         ///< [s]
  double constant = 0.0;   ///< [rad/s^2]
  double amplitude = 0.0;  ///< [rad/s^2]
  double frequency = 0.0;  ///< [rad/s]
  double phase = 0.0;      ///< [rad]
};

/// Motion with prescribed accelerations. Pieces of a channel may overlap, their accelerations add up; after
/// the last the rates stay what they are.
struct Weave {
  Eigen::Vector2d angles{0.0, 0.0};  ///< at the start [rad]
  Eigen::Vector2d rates{0.3, -0.2};  ///< at the start [rad/s]
  std::vector<AccelerationPiece> azimuth;
  std::vector<AccelerationPiece> elevation;
};

/// The weave of the estimators' benchmark, with `scale` rad for its unit. It covers 10 units: a scale
/// above 0.1 leads over the poles.
Weave benchmarkWeave(double scale = 0.1);

/// White-noise acceleration (S-87): a path of integrated Brownian motion, drawn once by its seed. The path
/// is exact on a grid of 2^-10 s and cubic (its conditional mean) between.
struct WhiteAcceleration {
  std::uint64_t seed = 0;
  double density = 0.3;              ///< of the acceleration, each channel [rad^2/s^3]
  Eigen::Vector2d angles{0.0, 0.0};  ///< at the start [rad]
  Eigen::Vector2d rates{0.0, 0.0};   ///< at the start [rad/s]
};

/// Angles passed at given times.
using AngularRoute = Route<2>;

/// Angles [rad], not wrapped, and their rates [rad/s].
struct AngularMotion {
  Eigen::Vector2d angles = Eigen::Vector2d::Zero();
  Eigen::Vector2d rates = Eigen::Vector2d::Zero();
};

AngularMotion motionAt(const Sinusoid& sinusoid, double time);
AngularMotion motionAt(const AngularLine& line, double time);
AngularMotion motionAt(const Weave& weave, double time);
AngularMotion motionAt(const WhiteAcceleration& path, double time);
AngularMotion motionAt(const AngularRoute& route, double time);

/// The same motion with the angles brought into their ranges: azimuth wrapped, elevations beyond +-pi/2 led
/// over the pole. Covariance zero.
AngularState onSphere(const AngularMotion& motion);

/// What is wrong with a motion's parameters; nullopt when nothing is.
std::optional<Refusal> refusalOf(const Sinusoid& sinusoid);
std::optional<Refusal> refusalOf(const AngularLine& line);
std::optional<Refusal> refusalOf(const Weave& weave);
std::optional<Refusal> refusalOf(const WhiteAcceleration& path);

}  // namespace sightline::core
