#pragma once

#include <memory>
#include <optional>
#include <tuple>
#include <vector>

#include "sightline/core/estimators/estimator.h"
#include "sightline/core/estimators/mode_chain.h"
#include "sightline/core/estimators/noise_learning.h"
#include "sightline/core/estimators/rate_prior.h"
#include "sightline/core/estimators/revisit_time.h"
#include "sightline/core/estimators/sighting_noise.h"
#include "sightline/core/model/kinematics.h"

namespace sightline::core {

/// The default bank, free of scale: from straight flight to a drone before a consumer camera.
std::vector<ProcessNoise> defaultAccelerations();

struct TwblsConsistentParams {
  /// White accelerations that are tried, 1 to kMaxModes; density or ratio > 0 each.
  std::vector<ProcessNoise> process_noises = defaultAccelerations();
  /// The window reaches back over at least so many sightings, >= 3, and at least `min_span` [s] >= 0. It
  /// grows to twice that before the older half is let go, so that a sighting costs the same however long it
  /// is; `exact_window` keeps it at max_sightings by fitting the window anew at each sighting.
  int sightings = 60;
  double min_span = 3.0;
  bool exact_window = false;
  double memory = 2.0;              ///< for the evidence of each process noise [units of time], > 0
  double initial_rate_sigma = 0.0;  ///< of each rate at first [rad/s], >= 0; 0 = not known (InitialRate)
  NoiseLearningParams noise;        ///< what the sightings' noise really is

  friend bool operator==(const TwblsConsistentParams& a, const TwblsConsistentParams& b) {
    return std::tie(a.process_noises, a.sightings, a.min_span, a.exact_window, a.memory, a.initial_rate_sigma,
                    a.noise) == std::tie(b.process_noises, b.sightings, b.min_span, b.exact_window, b.memory,
                                         b.initial_rate_sigma, b.noise);
  }
};

/// TWBLS, form `consistent` (S-4)-(S-6): generalised least squares of a straight line over the last
/// sightings, where the residuals are correlated as those of a target disturbed by white acceleration are, W
/// = (R + q K)^-1. A few densities q compete by how well they predict; what is published are the moments of
/// the mixture.
///
/// The inverse is never formed: the same estimate is that of a Kalman filter which starts at the window's
/// first sightings knowing nothing (a test holds the two equal). It goes on from sighting to sighting while
/// the window grows, and works on coupled channels as well.
///
/// Densities, memories and the like are per unit of time (RevisitTime). Each density learns the scale of the
/// sightings' noise for itself (S-11), channel by channel.
class TwblsConsistentEstimator final : public Estimator {
 public:
  /// Throws std::invalid_argument for a parameter out of range.
  explicit TwblsConsistentEstimator(const TwblsConsistentParams& params);

  std::unique_ptr<Estimator> clone() const override;
  void update(const Measurement& measurement) override;
  std::optional<AngularState> stateAt(Time time) const override;
  bool knowsRates() const override { return !rate_.isOpen(); }
  Eigen::Vector2d noiseScale() const override;
  void learnNoise(bool enabled) override;
  void rotate(const Eigen::Matrix3d& R_new_old) override;

  /// Weight of each process noise by the sightings so far; they sum to one.
  ModeArray weights() const;

 private:
  TwblsConsistentEstimator(const TwblsConsistentEstimator&) = default;
  int modes() const { return static_cast<int>(params_.process_noises.size()); }
  void weigh(const Measurement& measurement);
  void add(const Measurement& measurement);
  void shortenWindow();
  void fitWindow();
  Eigen::Matrix2d density(int mode, double h) const;
  Motion<4> predicted(int mode, double h) const;
  void take(Motion<4>& motion, int mode, std::size_t index) const;

  TwblsConsistentParams params_;
  std::vector<Measurement> window_;  // oldest first; sightings at the first instant are joined
  SightingNoise sighting_noise_;
  RevisitTime revisit_;
  InitialRate rate_;
  NoiseLearning noise_learning_;
  ModeArray evidence_;            // log likelihood of the sightings, fading
  Motion<4> motions_[kMaxModes];  // at the last sighting, by each process noise and the stated covariances
  Eigen::Vector2d noise_[kMaxModes];  // variance of the sightings over the stated one, by each process noise
};

}  // namespace sightline::core
