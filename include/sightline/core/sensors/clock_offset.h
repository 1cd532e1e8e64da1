#pragma once

#include <optional>
#include <tuple>
#include <vector>

#include <Eigen/Core>

#include "sightline/core/model/sphere.h"
#include "sightline/core/model/time.h"

namespace sightline::core {

/// When a sensor's clock counts as wrong.
struct ClockOffsetParams {
  double memory = 60.0;       ///< time constant with which old sightings are forgotten [s], > 0
  double significance = 5.0;  ///< standard errors from zero at which an offset is claimed, > 0
  double least = 0.002;       ///< smallest offset that is claimed [s], >= 0

  friend bool operator==(const ClockOffsetParams& a, const ClockOffsetParams& b) {
    return std::tie(a.memory, a.significance, a.least) == std::tie(b.memory, b.significance, b.least);
  }
};

/// By how much a clock is behind: sightings carry stamps that are so much too early.
struct ClockOffset {
  double behind = 0.0;  ///< [s]; negative: ahead
  double sigma = 0.0;   ///< its standard error [s]
};

/// Estimates the offset of one sensor's clock from its innovations, (S-55). Where a target moves with rate r,
/// a stamp that is too early by dt makes the innovation r dt. Recursive weighted least squares over all its
/// tracks for dt and, so that a misalignment is not taken for it, a constant offset of each angle: only
/// targets that change their rates tell the two apart. Errors in variables as in Fuller 1987. Plain state.
class ClockWatch {
 public:
  explicit ClockWatch(const ClockOffsetParams& params, Time since) : memory_(params.memory), last_(since) {}

  /// Takes an innovation `nu` [rad] of a sighting with covariance R [rad^2] against the motion expected at
  /// its stamp; times do not go back. A target whose rates are not
  /// significantly different from zero says nothing of dt.
  void take(Time time, const Eigen::Vector2d& nu, const Eigen::Matrix2d& R, const AngularState& expected);

  /// The offset against the tracks, to which the sensor itself contributes: only differences between sensors
  /// are meaningful. nullopt while it is not determined.
  std::optional<ClockOffset> against() const;

 private:
  double memory_;
  Time last_;
  Eigen::Matrix3d information_ = Eigen::Matrix3d::Zero();  // over (dt, azimuth, elevation), expected
  Eigen::Matrix3d noise_ = Eigen::Matrix3d::Zero();        // covariance of `vector_`
  Eigen::Vector3d vector_ = Eigen::Vector3d::Zero();
  double squares_ = 0.0, numbers_ = 0.0;  // of innovations over their variance
};

/// A clock found to be wrong.
struct ClockFinding {
  std::size_t sensor = 0;  ///< index
  ClockOffset offset;      ///< against the others
  bool undecided = false;  ///< there is one other only: either may be wrong
};

/// Which clocks are off, given each sensor's offset against the common tracks (nullopt where it is not
/// known): the most significant first, each against the mean of those not found wrong. (S-56)
std::vector<ClockFinding> wrongClocks(const std::vector<std::optional<ClockOffset>>& against,
                                      const ClockOffsetParams& params);

}  // namespace sightline::core
