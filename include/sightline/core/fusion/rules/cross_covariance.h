#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "sightline/core/fusion/rules/fusion_rules.h"

namespace sightline::core {

/// The cross-covariances P_ij of the errors of local tracks of one target, kept by whoever receives their
/// reports.
///
/// Local tracks of one target err alike because none foresees its manoeuvres. With the same process noise Q
/// on all and sightings of their own, the errors obey (estimators.md, section 6.2)
///     P_ij+ = (I - K_i H) (F P_ij F^T + Q) (I - K_j H)^T.
/// A report does not say the gains K_i, but I - K_i H = P_i+ (P_i-)^-1 =: A_i, where P_i+ is the reported
/// covariance and P_i- the one before it, predicted to the report's time. This holds for every estimator that
/// adds independent sightings to a prediction; for others (windows, mixtures of models) it is the Kalman
/// filter that would have reported the same covariances. Further approximations: all sightings between two
/// reports count as taken at the later one; a track's errors are independent of the others' when it first
/// appears (forgotten within its memory); sightings shared between sources are not accounted for.
///
/// Cross-covariances that overflow are forgotten: zero.
///
/// Sources are numbered 0 ... size() - 1 in the order in which they were added. States are (2 positions, 2
/// rates) in one chart.
class CrossCovariance {
 public:
  std::size_t size() const { return static_cast<std::size_t>(blocks_.rows()) / 4; }

  /// A further source, whose errors are independent of the others'.
  void add();

  /// Source `source` is gone; those after it move up.
  void remove(std::size_t source);

  /// `h` >= 0 seconds pass: P_ij <- F P_ij F^T + Q_ij. `densities`: each source's density of white
  /// acceleration by channel [rad^2/s^3]; Q_ij takes the geometric mean of both, the largest that two such
  /// errors can share.
  void predict(double h, const std::vector<Eigen::Vector2d>& densities);

  /// Source `source` took sightings: P_ij <- A P_ij for every j, with A = `covariance_after`
  /// `covariance_before`^-1. Where the covariance did not shrink (a tracker that became less sure), A leaves
  /// the errors as they are.
  void update(std::size_t source, const Eigen::Matrix4d& covariance_before,
              const Eigen::Matrix4d& covariance_after);

  /// The coordinates change: P_ij <- J_i P_ij J_j^T.
  void transform(const std::vector<Eigen::Matrix4d>& jacobians);

  /// P_ij = cov(error_i, error_j), i != j.
  Eigen::Matrix4d between(std::size_t i, std::size_t j) const;

  /// The joint covariance of those sources whose numbers are in `which`, with `sources` (of the same order
  /// and number) on the diagonal. Its cross-covariances are shrunk by one factor where they contradict the
  /// sources' covariances: in units of these the smallest eigenvalue is at least `kLeastOwnError`.
  Eigen::MatrixXd joint(const std::vector<Estimate<4>>& sources, const std::vector<std::size_t>& which) const;

  /// Share of error variance that every combination of sources has to itself [1].
  static constexpr double kLeastOwnError = 0.02;

 private:
  Eigen::MatrixXd blocks_;  // P_ij; zero on the diagonal
};

}  // namespace sightline::core
