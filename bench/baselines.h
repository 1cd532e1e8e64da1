#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "sightline/core/estimators/estimator.h"

/// What the estimators are measured against: Kalman filters and interacting multiple models with settings
/// that are told the amplitude, written apart from the core's so that neither hides the other's faults.
namespace sightline::bench {

/// Constant velocity with white acceleration of density q [rad^2/s^3], or constant acceleration with white
/// jerk of density q [rad^2/s^5], for amplitude 1 rad.
struct BaselineModel {
  enum class Kind { velocity, acceleration };
  Kind kind = Kind::velocity;
  double q = 0.0;
};

struct BaselineParams {
  std::vector<BaselineModel> models;  ///< one: a Kalman filter; more: an IMM
  double dwell = 3.0;                 ///< tau of the mode chain, stay = exp(-h / tau) [s]
  double scale = 1.0;                 ///< amplitude [rad]
  double outlier_share = 0.0;         ///< eps of the soft gate of section 4.3, 0 = none
};

/// The baselines' filter: models on (x, v, a) of each channel, one mode chain for both.
class BaselineEstimator final : public core::Estimator {
 public:
  explicit BaselineEstimator(const BaselineParams& params) : params_(params) {}

  std::unique_ptr<core::Estimator> clone() const override {
    return std::unique_ptr<core::Estimator>(new BaselineEstimator(*this));
  }
  void update(const core::Measurement& measurement) override;
  std::optional<core::AngularState> stateAt(core::Time time) const override;
  bool knowsRates() const override { return true; }
  /// The baselines live in one chart: throws std::logic_error.
  void rotate(const Eigen::Matrix3d& R_new_old) override;

 private:
  struct Belief {
    Eigen::Vector3d mean[2] = {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
    Eigen::Matrix3d covariance[2] = {Eigen::Matrix3d::Zero(), Eigen::Matrix3d::Zero()};
    double probability = 0.0;
  };

  BaselineEstimator(const BaselineEstimator&) = default;
  void start(const core::Measurement& measurement);
  std::vector<Belief> mixed(double h) const;
  std::vector<Belief> expected(double h) const;
  double reduce(Belief& belief, const core::Measurement& measurement) const;

  BaselineParams params_;
  std::optional<core::Time> time_;
  std::vector<Belief> beliefs_;
};

/// A competitor in a table.
struct Contender {
  std::string name;
  std::function<std::unique_ptr<core::Estimator>()> make;
  /// Sightings outside this gate are not shown to the estimator [chi-square of two channels]; infinity = all.
  double gate;
};

/// The 16 Kalman filters of which the best in hindsight is KF*.
std::vector<Contender> kalmanFilters(double scale, double outlier_share);
/// The IMMs of reference_results E2 to E4.
std::vector<Contender> imms(double scale, double outlier_share);
/// NOGA and TWBLS, form `consistent`, with the core's default settings; `gate` as the tracker sets it or
/// infinity.
std::vector<Contender> ours(double gate);

/// The core's other estimators with their default settings: IMM, Kalman filter, both of form `paper`.
std::vector<Contender> otherEstimators(double gate);

/// Gate of the local tracker: holds 99.95 % of genuine sightings, chi-square of two channels.
constexpr double kTrackerGate = 15.2;

}  // namespace sightline::bench
