#pragma once

#include <memory>
#include <optional>
#include <tuple>
#include <vector>

#include <Eigen/Core>

#include "sightline/core/estimators/auto_regression.h"
#include "sightline/core/estimators/estimator.h"
#include "sightline/core/estimators/rate_prior.h"

namespace sightline::core {

/// What is published as the covariance of a position.
enum class NogaCovariance {
  /// What the residuals of the auto-regression and the noise of its regressors say of its prediction, shared
  /// out as
  /// the estimate is. Holds tracks; the estimates are the same.
  residual,
  /// C_rhat of (22) and S C_a S^T: as the paper has it. Several times too small (the noise of the regressors
  /// and the
  /// error of the model are not in it), so that a gate built on it loses real targets.
  printed
};

struct NogaParams {
  int rows = 18;  ///< of the auto-regression, in [3, 62]; the paper prints 3, with one degree of freedom
  bool weighted = false;  ///< regressors times d exp(-d) / ifov^2 of their age d [s] (16); favours the older
  bool feedback = false;  ///< the estimates take the sightings' place in later rows; diverges
  NogaCovariance covariance = NogaCovariance::residual;
  double initial_rate_sigma = 0.0;  ///< of each rate at first [rad/s], >= 0; 0 = not known (InitialRate)

  friend bool operator==(const NogaParams& a, const NogaParams& b) {
    return std::tie(a.rows, a.weighted, a.feedback, a.covariance, a.initial_rate_sigma) ==
           std::tie(b.rows, b.weighted, b.feedback, b.covariance, b.initial_rate_sigma);
  }
};

/// NOGA, form `paper`: equations (10)-(16C) as the model, (20)-(22) to make it agree with the sighting,
/// channel by channel, with C_p = 0 because the sighting is not among the rows. Linear in the rows; no heap
/// allocation after construction.
///
/// It is here to be compared with: less accurate than TWBLS in every reading (rms error 0.78 sigma instead of
/// 0.48 on the paper's benchmark). An auto-regression without an intercept depends on the angular origin. The
/// coordinates of the chart are used as they are: azimuth from where the track began, elevation from the
/// horizon. So the result does not depend on the heading of the tracking frame, and elevation is the paper's.
/// Values less the mean of the window, the reading that depends on no origin at all, lag behind a moving
/// target (0.96 sigma on the benchmark).
///
/// What the auto-regression does not say comes from a straight line through the same sightings, weighted by
/// 1/sigma^2: the rates, with the covariance that the sigmas or, if larger, the residuals give; and the
/// position until `rows` rows without a pause are there, a pause being an interval of more than eight times
/// the mean. The auto-regression predicts "the next sighting"; beyond the longest interval of the window its
/// value goes on at the line's rate. While it coasts, the variance of the rate grows by itself within the
/// length of the window, one second at the least. Published covariances: position and rate of a channel are
/// taken as uncorrelated at a sighting, the channels always; no variance is below 1e-9 of the sighting's.
class NogaEstimator final : public Estimator {
 public:
  /// Throws std::invalid_argument for a parameter out of range.
  explicit NogaEstimator(const NogaParams& params);

  std::unique_ptr<Estimator> clone() const override;
  void update(const Measurement& measurement) override;
  std::optional<AngularState> stateAt(Time time) const override;
  bool knowsRates() const override { return !rate_.isOpen(); }
  void rotate(const Eigen::Matrix3d& R_new_old) override;

  /// Whether the last estimate came from the auto-regression rather than the straight line.
  bool isAutoRegressive() const { return auto_regressive_; }

 private:
  struct Response;

  NogaEstimator(const NogaEstimator&) = default;
  bool hasRows() const { return series_ == params_.rows + 2; }
  bool isPause(double h) const;
  void reduce(const Measurement& measurement);
  Response responseAfter(int channel, double h) const;
  void store(const Measurement& measurement);
  void fitLines();
  AngularState coasted(AngularState state, double h) const;

  NogaParams params_;
  InitialRate rate_;
  int size_ = 0;    // sightings in the window
  int series_ = 0;  // of those, the last ones without a pause
  bool auto_regressive_ = false;
  double longest_ = 0.0;  // interval of the series [s]
  double mean_ = 0.0;     // interval of the window [s]
  AngularState state_;    // at the last sighting
  AngularState line_;     // the same by the straight lines

  // The window, oldest first, one entry for each sighting.
  std::vector<Time> time_;
  Eigen::ArrayXd value_[2], variance_[2], cross_covariance_, ifov_;
};

}  // namespace sightline::core
