#pragma once

#include <memory>
#include <optional>
#include <tuple>

#include "sightline/core/estimators/estimator.h"
#include "sightline/core/estimators/rate_prior.h"
#include "sightline/core/estimators/revisit_time.h"
#include "sightline/core/estimators/sighting_noise.h"
#include "sightline/core/model/kinematics.h"

namespace sightline::core {

struct KalmanParams {
  /// Spectral density of the white acceleration of each angle [rad^2/s^3], >= 0; 0 = by process_noise_ratio.
  double process_noise = 0.0;
  /// Density / sigma^2 of the sightings [1/unit of time^3], > 0, where process_noise is 0: free of the
  /// angular scale and, with RevisitTime, of that of time.
  double process_noise_ratio = 200.0;
  double initial_rate_sigma = 0.0;  ///< of each rate at first [rad/s], >= 0; 0 = not known (InitialRate)

  friend bool operator==(const KalmanParams& a, const KalmanParams& b) {
    return std::tie(a.process_noise, a.process_noise_ratio, a.initial_rate_sigma) ==
           std::tie(b.process_noise, b.process_noise_ratio, b.initial_rate_sigma);
  }
};

/// Kalman filter of constant angular velocity disturbed by white acceleration: four states, both channels
/// coupled by the sightings' full covariance. The yardstick for the other estimators. Where the process noise
/// is given by a ratio, that of a target that passes by is added (passingAcceleration).
class KalmanEstimator final : public Estimator {
 public:
  /// Throws std::invalid_argument for a parameter out of range.
  explicit KalmanEstimator(const KalmanParams& params);

  std::unique_ptr<Estimator> clone() const override;
  void update(const Measurement& measurement) override;
  std::optional<AngularState> stateAt(Time time) const override;
  bool knowsRates() const override { return !rate_.isOpen(); }
  void rotate(const Eigen::Matrix3d& R_new_old) override;

 private:
  KalmanEstimator(const KalmanEstimator&) = default;
  Motion<4> predicted(Time time) const;

  KalmanParams params_;
  std::optional<Time> time_;  // of the last sighting
  Motion<4> motion_;          // then
  SightingNoise noise_;
  RevisitTime revisit_;
  InitialRate rate_;
};

}  // namespace sightline::core
