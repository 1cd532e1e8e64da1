#pragma once

#include <memory>
#include <optional>
#include <tuple>
#include <vector>

#include <Eigen/Core>

#include "sightline/core/estimators/estimator.h"
#include "sightline/core/estimators/rate_prior.h"

namespace sightline::core {

/// A straight line through weighted values, y = C_1 s + C_2 with age s [s]: equations (1)-(4), (7)-(9C),
/// (S-2).
struct LineFit {
  Eigen::Vector2d C =
      Eigen::Vector2d::Zero();  ///< (C_1 [rad/s], C_2 [rad]); velocity = -C_1, position now = C_2
  Eigen::Matrix2d P = Eigen::Matrix2d::Zero();           ///< (F^T W F)^-1, order (C_1, C_2)
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();  ///< of C by the stated variances, G R G^T (S-2)
  double rms = 0.0;                                      ///< weighted residual [rad], (7)
  double efit = 0.0;  ///< the same for n - 2 degrees of freedom [rad], (8); NaN for n = 2
  Eigen::Vector2d E =
      Eigen::Vector2d::Zero();  ///< fit errors (E_1 [rad/s], E_2 [rad]), (9C); Student-t scales
  double misfit = 1.0;          ///< residuals squared over what the variances make expected; 1 for n = 2
};

/// Weighted least squares line (3). All of one length n: ages [s], values [rad], stated variances [rad^2],
/// weights (any common unit). nullopt when the line is not determined: fewer than two ages at least 1 us
/// apart that weigh something.
std::optional<LineFit> fitLine(const Eigen::Ref<const Eigen::ArrayXd>& age,
                               const Eigen::Ref<const Eigen::ArrayXd>& value,
                               const Eigen::Ref<const Eigen::ArrayXd>& variance,
                               const Eigen::Ref<const Eigen::ArrayXd>& weight);

/// How the weight of a sighting falls with its age (6C).
enum class TimeWeight { none, linear, exponential };

/// How sensors are weighted against each other (6C): by 1/sigma^2 (right), or by 1/ifov^2 as the paper has it
/// (right only where ifov is proportional to sigma).
enum class SensorWeight { variance, ifov };

/// From where the position is extrapolated (5C).
enum class TwblsAnchor {
  fit,  ///< from the fitted position
  raw   ///< from the last sighting, as the paper has it: costs a factor two in the prediction
};

/// What is published as covariance in the form `paper`.
enum class TwblsCovariance {
  residual,  ///< (S-2) times the misfit where the residuals are larger than the stated sigmas explain
  sandwich,  ///< (S-2): right if the sigmas are, and the target flies straight for the length of the window
  fit_error  ///< diag(E_2^2, E_1^2) of (9C), as the paper has it: the cross term is lost
};

struct TwblsParams {
  double window = 0.6;      ///< T_w, age up to which sightings count [s], > 0
  int max_sightings = 160;  ///< N_max; 20 is the paper's for one sensor, six sensors need 140 and more; >= 3
  int min_sightings = 5;    ///< that many count whatever their age (a slow sensor), in [2, max_sightings]
  TimeWeight time_weight = TimeWeight::exponential;
  double decay = 1.0;  ///< tau of the exponential weight [s], > 0
  SensorWeight sensor_weight = SensorWeight::variance;
  TwblsAnchor anchor = TwblsAnchor::fit;
  TwblsCovariance covariance = TwblsCovariance::residual;
  double initial_rate_sigma = 0.0;  ///< of each rate at first [rad/s], >= 0; 0 = not known (InitialRate)

  friend bool operator==(const TwblsParams& a, const TwblsParams& b) {
    return std::tie(a.window, a.max_sightings, a.min_sightings, a.time_weight, a.decay, a.sensor_weight,
                    a.anchor, a.covariance, a.initial_rate_sigma) ==
           std::tie(b.window, b.max_sightings, b.min_sightings, b.time_weight, b.decay, b.sensor_weight,
                    b.anchor, b.covariance, b.initial_rate_sigma);
  }
};

/// Half width of the paper's gate, seconds `h` after the last sighting: three times the linear sum E_2 + h
/// E_1 of (5), and at least three sigmas of the sighting, without which the paper's gate loses its target
/// [rad].
double paperGateHalfWidth(const LineFit& fit, double h, double sigma);

/// TWBLS, time-weighted backvalues least squares, form `paper`: a straight line through the sightings of a
/// sliding window, channel by channel; sightings of several sensors in one window are the paper's data
/// fusion. Linear in the window; no heap allocation after construction.
class TwblsEstimator final : public Estimator {
 public:
  explicit TwblsEstimator(const TwblsParams& params);

  std::unique_ptr<Estimator> clone() const override;
  void update(const Measurement& measurement) override;
  std::optional<AngularState> stateAt(Time time) const override;
  bool knowsRates() const override { return !rate_.isOpen(); }
  void rotate(const Eigen::Matrix3d& R_new_old) override;

  /// Number of sightings in the window.
  std::size_t windowSize() const { return window_.size(); }

  /// The last fit of a channel (0 azimuth, 1 elevation); nullopt while the line is not determined.
  const std::optional<LineFit>& fit(int channel) const { return fits_[channel]; }

 private:
  TwblsEstimator(const TwblsEstimator&) = default;
  void forget(Time now);
  void refit();
  AngularState lineState() const;
  AngularState pointState() const;

  TwblsParams params_;
  InitialRate rate_;
  std::vector<Measurement> window_;  // oldest first
  std::optional<LineFit> fits_[2];
  AngularState state_;  // at the time of the newest sighting

  // One entry for each sighting of the window, kept to spare allocations.
  Eigen::ArrayXd age_, time_weight_;
  Eigen::ArrayXd value_[2], variance_[2], weight_[2], cross_covariance_;
};

}  // namespace sightline::core
