#pragma once

#include <memory>
#include <optional>

#include "sightline/core/estimators/estimator.h"
#include "sightline/core/estimators/sighting_noise.h"
#include "sightline/core/model/kinematics.h"

namespace sightline::core {

struct KalmanParams {
  /// Spectral density of the white acceleration of each angle [rad^2/s^3], >= 0; 0 = by process_noise_ratio.
  double process_noise = 0.0;
  /// Density / sigma^2 of the sightings [1/s^3], > 0, where process_noise is 0: free of the angular scale.
  double process_noise_ratio = 200.0;
  double initial_rate_sigma = 0.3;  ///< of each rate before the second sighting [rad/s], > 0
};

/// Kalman filter of constant angular velocity disturbed by white acceleration: four states, both channels
/// coupled by the sightings' full covariance. The yardstick for the other estimators.
class KalmanEstimator final : public Estimator {
 public:
  /// Throws std::invalid_argument for a parameter out of range.
  explicit KalmanEstimator(const KalmanParams& params);

  std::unique_ptr<Estimator> clone() const override;
  void update(const Measurement& measurement) override;
  std::optional<AngularState> stateAt(Time time) const override;
  void rotate(const Eigen::Matrix3d& R_new_old) override;

 private:
  KalmanEstimator(const KalmanEstimator&) = default;
  Motion<4> predicted(Time time) const;

  KalmanParams params_;
  std::optional<Time> time_;  // of the last sighting
  Motion<4> motion_;          // then
  SightingNoise noise_;
};

}  // namespace sightline::core
