#pragma once

#include <Eigen/Core>

namespace sightline::core {

/// Stumpff functions c_0 = cos sqrt z, c_1 = sin sqrt z / sqrt z, c_2 = (1 - cos sqrt z) / z, continued to z
/// <= 0, and their derivatives by z. Near zero by series.
struct Stumpff {
  double c0, c1, c2;
  double d0, d1, d2;
};
Stumpff stumpff(double z);

/// One step of a linear(ised) motion of one channel, state (position x [rad], rate v [rad/s], acceleration a
/// [rad/s^2], kappa [1/s^2]).
struct Transition {
  Eigen::Vector4d mean;  ///< the state after the step
  Eigen::Matrix4d F;     ///< d state after / d state before
  Eigen::Matrix4d Q;     ///< process noise
};

/// Harmonic motion with offset, x''' = -kappa v, for `h` seconds (S-8): the exact auto-regression of second
/// order on irregular times with its coefficient among the unknowns. kappa > 0 oscillates, 0 accelerates
/// evenly, < 0 runs away; within the step it is kept to [-1, 40] 1/s^2. White jerk of density `q`
/// [rad^2/s^5], drift of kappa of density `q_kappa` [1/s^5].
Transition harmonicStep(const Eigen::Vector4d& state, double h, double q, double q_kappa);

/// The same with a kappa that is known: it tells nothing of the state's own, which becomes N(kappa,
/// kappa_sigma^2).
Transition fixedHarmonicStep(const Eigen::Vector4d& state, double h, double q, double kappa,
                             double kappa_sigma);

/// Motion whose acceleration fades with the time constant `tau` [s] > 0 and is renewed by white jerk of
/// density `q` [rad^2/s^5] (Singer's model): a manoeuvre that will not last. Of kappa it knows nothing: N(0,
/// kappa_sigma^2).
Transition fadingStep(const Eigen::Vector4d& state, double h, double q, double tau, double kappa_sigma);

/// Coefficients (a_1, a_2) of y(k) = a_1 y(k-1) + a_2 y(k-2) for harmonic motion about zero (13C), with the
/// steps h_1 = t_k - t_{k-1} and h_2 = t_{k-1} - t_{k-2} [s], h_2 != 0.
Eigen::Vector2d autoRegression(double kappa, double h_1, double h_2);

}  // namespace sightline::core
