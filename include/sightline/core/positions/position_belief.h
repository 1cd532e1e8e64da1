#pragma once

#include <array>

#include <Eigen/Core>

/// What one motion model knows of a target's position, and of the slow errors of the stations that see it;
/// the linear algebra of the position estimator. Metric frame [m], angles [rad]. Nothing here allocates.
namespace sightline::core {

constexpr int kMotionSize = 9;    ///< position, velocity, acceleration
constexpr int kMostStations = 6;  ///< whose slow errors are in the state
constexpr int kMostStates = kMotionSize + 2 * kMostStations;

using PositionVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostStates, 1>;
using PositionMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMostStates, kMostStates>;

/// How a target may move: white acceleration of density q [m^2/s^3] or white jerk of density q [m^2/s^5]
/// along each axis, with q = ratio (sigma rho)^2 (P-4): nobody states metres.
struct PositionModel {
  enum class Kind { white_acceleration, white_jerk };
  Kind kind = Kind::white_jerk;
  double ratio = 1.0;  ///< q over the square of what one sighting resolves [1/s^3] or [1/s^5], >= 0
};

/// The slow error of one station: two angles across its line of sight, first-order Gauss-Markov.
struct SlowError {
  double variance = 0.0;       ///< of each angle [rad^2], >= 0
  double time_constant = 3.0;  ///< [s], > 0
};

/// Mean and covariance over (position [m], velocity [m/s], acceleration [m/s^2], slow errors [rad]), those of
/// the station in slot i at kMotionSize + 2 i, over the basis of that slot.
struct PositionBelief {
  PositionVector mean = PositionVector::Zero(kMotionSize);
  PositionMatrix covariance = PositionMatrix::Zero(kMotionSize, kMotionSize);

  int slots() const { return (static_cast<int>(mean.size()) - kMotionSize) / 2; }
};

/// Puts a slot for a station's slow error at the end: zero, with the variance given [rad^2].
void addSlot(PositionBelief& belief, double variance);

/// Takes out a slot; those behind it move up.
void removeSlot(PositionBelief& belief, int slot);

/// Predicts `h` >= 0 seconds ahead (P-4). `unit_squared`: (sigma rho)^2 [m^2]; `slow`: of each slot.
void predict(PositionBelief& belief, const PositionModel& model, double unit_squared, double h,
             const std::array<SlowError, kMostStations>& slow);

/// One direction from one place, as an update takes it.
struct DirectionUpdate {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();      ///< [m]
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  ///< unit vector
  Eigen::Matrix<double, 2, 3> basis;                     ///< two unit vectors across it: of the slot
  Eigen::Matrix2d R = Eigen::Matrix2d::Identity();       ///< white noise over `basis` [rad^2]
  int slot = -1;     ///< of the station's slow error; -1: not in the state
  double age = 0.0;  ///< seen so long before the time of the belief; negative: after it [s]
};

/// What an update did.
struct UpdateResult {
  double distance_squared = 0.0;  ///< of the innovation, nu^T S^-1 nu, before any down-weighting
  double log_determinant = 0.0;   ///< of S
  bool is_behind = false;         ///< the direction points away from the target; nothing was done
};

/// Iterated update (P-5), (20I), covariance in Joseph form (S-7). Innovations beyond `outlier_distance`
/// standard deviations count with their noise enlarged to that distance.
UpdateResult update(PositionBelief& belief, const DirectionUpdate& seen, double outlier_distance);

/// The same for a station that sees the target alone and stands still (P-6): directions tell neither range
/// nor speed along the ray, so that these keep their values and their variances; only their correlations
/// change. Done in (direction, log range, velocity/range, acceleration/range), in which that is exact.
UpdateResult updateAlone(PositionBelief& belief, const DirectionUpdate& seen, double outlier_distance);

}  // namespace sightline::core
