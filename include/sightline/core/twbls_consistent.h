#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "sightline/core/estimator.h"
#include "sightline/core/kinematics.h"
#include "sightline/core/mode_chain.h"
#include "sightline/core/sighting_noise.h"

namespace sightline::core {

struct TwblsConsistentParams {
  /// White accelerations that are tried, 1 to kMaxModes; density or ratio > 0 each. The default is free of
  /// scale: from straight flight to a drone before a consumer camera.
  std::vector<ProcessNoise> process_noises = {{0.0, 0.01}, {0.0, 1.0}, {0.0, 30.0}, {0.0, 1e3}, {0.0, 3e4}};
  int max_sightings = 60;           ///< of the window, >= 3; no limit in time
  double memory = 1.5;              ///< for the evidence of each process noise [s], > 0
  double initial_rate_sigma = 0.3;  ///< of each rate before the second sighting [rad/s], > 0
};

/// TWBLS, form `consistent` (S-4)-(S-6): generalised least squares of a straight line over the last
/// sightings, where the residuals are correlated as those of a target disturbed by white acceleration are, W
/// = (R + q K)^-1. A few densities q compete by how well they predict; what is published are the moments of
/// the mixture.
///
/// The inverse is never formed: the same estimate is that of a Kalman filter which starts at the window's
/// first sightings knowing nothing (a test holds the two equal), and that is linear in the window and works
/// on coupled channels as well.
class TwblsConsistentEstimator final : public Estimator {
 public:
  /// Throws std::invalid_argument for a parameter out of range.
  explicit TwblsConsistentEstimator(const TwblsConsistentParams& params);

  std::unique_ptr<Estimator> clone() const override;
  void update(const Measurement& measurement) override;
  std::optional<AngularState> stateAt(Time time) const override;
  void rotate(const Eigen::Matrix3d& R_new_old) override;

  /// Weight of each process noise by the sightings so far; they sum to one.
  ModeArray weights() const;

 private:
  TwblsConsistentEstimator(const TwblsConsistentEstimator&) = default;
  int modes() const { return static_cast<int>(params_.process_noises.size()); }
  bool isDetermined() const { return window_.back().time != window_.front().time; }
  void weigh(const Measurement& measurement);
  void fitWindow();
  Motion<4> fitted(const Eigen::Matrix2d& density) const;

  TwblsConsistentParams params_;
  std::vector<Measurement> window_;  // oldest first
  SightingNoise noise_;
  ModeArray evidence_;            // log likelihood of the sightings, fading
  Motion<4> motions_[kMaxModes];  // at the last sighting, by each process noise
};

}  // namespace sightline::core
