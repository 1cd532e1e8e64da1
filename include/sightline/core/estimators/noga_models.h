#pragma once

#include <vector>

#include <Eigen/Core>

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
};

/// The default bank, free of scale.
std::vector<ResponseModel> defaultResponseModels();

/// What one response model knows of a target: for each channel the state (x, v, a, kappa) in the chart
/// [rad, rad/s, rad/s^2, 1/s^2], the covariance of the azimuth's state with the elevation's, and the variance
/// of the sightings over the stated one [1].
struct ResponseBelief {
  Eigen::Vector4d mean[2] = {Eigen::Vector4d::Zero(), Eigen::Vector4d::Zero()};
  Eigen::Matrix4d covariance[2] = {Eigen::Matrix4d::Zero(), Eigen::Matrix4d::Zero()};
  Eigen::Matrix4d cross = Eigen::Matrix4d::Zero();
  Eigen::Vector2d noise = Eigen::Vector2d::Ones();
};

/// Goes over from seconds to units of time of `unit` seconds: rates per unit, and so on.
void inUnits(ResponseBelief& belief, double unit);

/// Position and rates, both channels together.
Motion<4> motionOf(const ResponseBelief& belief);

/// Goes over to a chart that is turned by `R_new_old`. Position, rate and acceleration turn exactly in the
/// mean and by the derivative in the covariance; kappa is a property of the motion and stays.
void turn(ResponseBelief& belief, const Eigen::Matrix3d& R_new_old);

/// Throws std::invalid_argument for a model that cannot work.
void check(const ResponseModel& model);

/// Predicts the belief `h` seconds ahead (or back). `units`: the angle of each channel that stands for 1 rad
/// of the model [rad]. `is_coupled`: whether the channels' cross-covariance is kept.
void step(ResponseBelief& belief, const ResponseModel& model, const Eigen::Vector2d& units, double h,
          bool is_coupled);

}  // namespace sightline::core
