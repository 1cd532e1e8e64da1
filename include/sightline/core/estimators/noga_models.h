#pragma once

#include <tuple>
#include <vector>

#include <Eigen/Core>

#include "sightline/core/estimators/harmonic_motion.h"
#include "sightline/core/model/kinematics.h"

/// The response models of NOGA's bank: how a target may move between two sightings.
namespace sightline::core {

/// How a target may answer: one model of the bank. Quantities that have the angle in them are for an
/// amplitude of 1 rad, those with the time for a unit of time of 1 s.
struct ResponseModel {
  enum class Kind { straight, harmonic, fixed_harmonic, fading };
  Kind kind = Kind::straight;
  double q = 1.0;  ///< density of white acceleration [rad^2/s^3] (straight) or white jerk [rad^2/s^5], >= 0
  double q_kappa = 0.0;     ///< density of the drift of kappa [1/s^5] (harmonic), >= 0
  double kappa = 0.0;       ///< the known kappa [1/s^2] (fixed_harmonic)
  double fade = 1.0;        ///< time constant of the acceleration [s] (fading), > 0
  double attraction = 1.0;  ///< in proportion to which it is probable at first and gone over to, > 0

  friend bool operator==(const ResponseModel& a, const ResponseModel& b) {
    return std::tie(a.kind, a.q, a.q_kappa, a.kappa, a.fade, a.attraction) ==
           std::tie(b.kind, b.q, b.q_kappa, b.kappa, b.fade, b.attraction);
  }
};

/// The default bank, free of scale.
std::vector<ResponseModel> defaultResponseModels();

/// The straight one of the largest noise, which expects targets that pass by as well (passingAcceleration);
/// -1 where none is straight.
int agilestStraight(const std::vector<ResponseModel>& models);

/// What white acceleration of spectral density `q` does in `h` units of time, ahead or back, to the
/// covariance of (x, v) of one channel (S-17).
Eigen::Matrix2d whiteAccelerationNoise(double h, double q);

/// What one response model knows of a target: for each channel the state (x, v, a, kappa) in the chart
/// [rad, rad/s, rad/s^2, 1/s^2], the covariance of the azimuth's state with the elevation's, and the variance
/// of the sightings over the stated one [1].
struct ResponseBelief {
  Eigen::Vector4d mean[2] = {Eigen::Vector4d::Zero(), Eigen::Vector4d::Zero()};
  Eigen::Matrix4d covariance[2] = {Eigen::Matrix4d::Zero(), Eigen::Matrix4d::Zero()};
  Eigen::Matrix4d cross = Eigen::Matrix4d::Zero();
  Eigen::Vector2d noise = Eigen::Vector2d::Ones();
};

/// Position and rates, both channels together.
Motion<4> motionOf(const ResponseBelief& belief);

/// Goes over to a chart that is turned by `R_new_old`. Position, rate and acceleration turn exactly in the
/// mean and by the derivative in the covariance; kappa is a property of the motion and stays.
void turn(ResponseBelief& belief, const Eigen::Matrix3d& R_new_old);

/// Throws std::invalid_argument for a model that cannot work.
void check(const ResponseModel& model);

/// One step of a channel by a model, `h` seconds ahead or back, for an amplitude of 1 rad: with another one
/// the process noise of position, rate and acceleration is as many times as large as its square. `state`:
/// (x, v, a, kappa) before, of which only that of a harmonic counts.
Transition transitionOf(const ResponseModel& model, const Eigen::Vector4d& state, double h);

}  // namespace sightline::core
