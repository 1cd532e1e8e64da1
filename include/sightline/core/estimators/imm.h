#pragma once

#include <array>
#include <memory>
#include <optional>
#include <tuple>
#include <vector>

#include "sightline/core/estimators/estimator.h"
#include "sightline/core/estimators/mode_chain.h"
#include "sightline/core/estimators/rate_prior.h"
#include "sightline/core/estimators/revisit_time.h"
#include "sightline/core/estimators/sighting_noise.h"
#include "sightline/core/model/kinematics.h"

namespace sightline::core {

/// One of the models that take turns.
struct ImmModel {
  int order = 1;  ///< 1: constant velocity and white acceleration; 2: constant acceleration and white jerk
  ProcessNoise noise;  ///< of the acceleration (order 1) or of the jerk (order 2); density or ratio > 0

  friend bool operator==(const ImmModel& a, const ImmModel& b) {
    return std::tie(a.order, a.noise) == std::tie(b.order, b.noise);
  }
};

/// The default bank, free of the angular scale.
std::vector<ImmModel> defaultImmModels();

struct ImmParams {
  /// 1 to kMaxModes. The default bank is free of the angular scale: straight flight, manoeuvre, curve, hard
  /// curve.
  std::vector<ImmModel> models = defaultImmModels();
  double dwell = 3.0;               ///< mean time between changes of the model [units of time], > 0
  double initial_rate_sigma = 0.0;  ///< of each rate at first [rad/s], >= 0; 0 = not known (InitialRate)
  /// Of each acceleration before the third sighting [rad/unit of time^2], > 0.
  double initial_acceleration_sigma = 1.0;

  friend bool operator==(const ImmParams& a, const ImmParams& b) {
    return std::tie(a.models, a.dwell, a.initial_rate_sigma, a.initial_acceleration_sigma) ==
           std::tie(b.models, b.dwell, b.initial_rate_sigma, b.initial_acceleration_sigma);
  }
};

/// Interacting multiple models: constant-velocity and constant-acceleration Kalman filters of different
/// process noise on the state (position, rate, acceleration), coupled in both channels, with one mode chain
/// for the target. The unit of time is that of RevisitTime. The most agile model, where its noise is given by
/// a ratio, expects targets that pass by as well (passingAcceleration).
///
/// A constant-velocity model does not know its acceleration. It is taken to be zero with the variance that
/// the jerk of the mildest constant-acceleration model builds up in one unit of time: with that a
/// constant-acceleration model starts when the mode changes.
class ImmEstimator final : public Estimator {
 public:
  /// Throws std::invalid_argument for a parameter out of range.
  explicit ImmEstimator(const ImmParams& params);

  std::unique_ptr<Estimator> clone() const override;
  void update(const Measurement& measurement) override;
  std::optional<AngularState> stateAt(Time time) const override;
  std::vector<Hypothesis> hypothesesAt(Time time) const override;
  bool knowsRates() const override { return !rate_.isOpen(); }
  void rotate(const Eigen::Matrix3d& R_new_old) override;

  /// Probability of each model by the sightings so far, in the order of ImmParams::models.
  const ModeArray& probabilities() const { return chain_.probabilities(); }

 private:
  using Motions = std::array<Motion<6>, kMaxModes>;

  ImmEstimator(const ImmEstimator&) = default;
  int modes() const { return static_cast<int>(params_.models.size()); }
  Motions predicted(double h) const;
  void predict(double h, Motions& ahead) const;
  void setUnknown(double h);
  Eigen::Matrix2d unknownAcceleration(double unit) const;

  ImmParams params_;
  ModeChain chain_;
  std::optional<Time> time_;  // of the last sighting
  Motions motions_;           // then, by each model
  SightingNoise noise_;
  RevisitTime revisit_;
  InitialRate rate_;
};

}  // namespace sightline::core
