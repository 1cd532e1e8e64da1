#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "sightline/core/estimators/estimator.h"
#include "sightline/core/estimators/mode_chain.h"
#include "sightline/core/estimators/sighting_noise.h"
#include "sightline/core/model/kinematics.h"

namespace sightline::core {

/// One of the models that take turns.
struct ImmModel {
  int order = 1;  ///< 1: constant velocity and white acceleration; 2: constant acceleration and white jerk
  ProcessNoise noise;  ///< of the acceleration (order 1) or of the jerk (order 2); density or ratio > 0
};

/// The default bank, free of the angular scale.
std::vector<ImmModel> defaultImmModels();

struct ImmParams {
  /// 1 to kMaxModes. The default bank is free of the angular scale: straight flight, manoeuvre, curve, hard
  /// curve.
  std::vector<ImmModel> models = defaultImmModels();
  double dwell = 3.0;                       ///< mean time between changes of the model [s], > 0
  double initial_rate_sigma = 0.3;          ///< of each rate before the second sighting [rad/s], > 0
  double initial_acceleration_sigma = 1.0;  ///< of each acceleration before the third sighting [rad/s^2], > 0
};

/// Interacting multiple models: constant-velocity and constant-acceleration Kalman filters of different
/// process noise on the state (position, rate, acceleration), coupled in both channels, with one mode chain
/// for the target.
///
/// A constant-velocity model does not know its acceleration. It is taken to be zero with the variance that
/// the jerk of the mildest constant-acceleration model builds up in one second: with that a
/// constant-acceleration model starts when the mode changes.
class ImmEstimator final : public Estimator {
 public:
  /// Throws std::invalid_argument for a parameter out of range.
  explicit ImmEstimator(const ImmParams& params);

  std::unique_ptr<Estimator> clone() const override;
  void update(const Measurement& measurement) override;
  std::optional<AngularState> stateAt(Time time) const override;
  void rotate(const Eigen::Matrix3d& R_new_old) override;

  /// Probability of each model by the sightings so far, in the order of ImmParams::models.
  const ModeArray& probabilities() const { return chain_.probabilities(); }

 private:
  using Motions = std::array<Motion<6>, kMaxModes>;

  ImmEstimator(const ImmEstimator&) = default;
  int modes() const { return static_cast<int>(params_.models.size()); }
  Motions predicted(double h) const;
  Eigen::Matrix2d unknownAcceleration() const;

  ImmParams params_;
  ModeChain chain_;
  std::optional<Time> time_;  // of the last sighting
  Motions motions_;           // then, by each model
  SightingNoise noise_;
};

}  // namespace sightline::core
