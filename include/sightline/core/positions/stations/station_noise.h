#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include <Eigen/Core>

#include "sightline/core/model/time.h"
#include "sightline/core/positions/position_belief.h"
#include "sightline/core/positions/position_estimator.h"

namespace sightline::core {

struct StationNoiseParams {
  double slow_scale = 1.3;     ///< sigma of the slow error over the root of slowReference at first [1], >= 0
  double time_constant = 3.0;  ///< of the slow error at first [s], > 0
  double safety = 2.0;   ///< factor on the variance that is learnt: errors of one visit differ from those
                         ///< of the next by more than chance [1], > 0
  double memory = 60.0;  ///< over which size and time constant are learnt [s], > 0
  double prior_weight = 10.0;  ///< what was set at first counts as so many seconds of data [s], >= 0
  double least_scale = 0.1;    ///< bounds of the learnt slow scale [1], > 0
  double most_scale = 30.0;    ///< [1], > least_scale
  double least_time = 0.5;     ///< bounds of the learnt time constant [s], > 0
  double most_time = 30.0;     ///< [s], > least_time
  bool learn_time = false;     ///< whether the time constant is learnt, or kept as set
};

/// What a slow error is measured by (P-9): the part of the stated variance that is not white noise, and at
/// least a small part of it, because nobody states what is left of it [rad^2].
double slowReference(double stated_variance, double white_variance);

/// What the directions of one station are wrong by: white noise from sighting to sighting, told by what a
/// smooth motion cannot explain, and a slow error, told by the targets whose positions several stations know.
/// Sizes are kept relative to what the station states, because sigma may change from sighting to sighting.
class StationNoise {
 public:
  /// Throws std::invalid_argument for a parameter out of range.
  explicit StationNoise(const StationNoiseParams& params = {});

  /// A direction to one target, in order of time, with its stated covariance [rad^2] (P-13). Only where the
  /// stated sigma is that of the whole error, and not of tracklets.
  void noteDirection(Time time, const Eigen::Vector3d& direction, double stated_variance);

  /// The slow error as a target's position estimator sees it (P-9). `reference` [rad^2]: slowReference;
  /// `since`: the station's last measurement of the same target [s].
  void noteSlowError(const SlowErrorEstimate& estimate, double reference, double since);

  /// Variance of the white noise over the stated one, at most 1 [1].
  double whiteScale() const;

  /// The slow error of a sighting of this slowReference [rad^2].
  SlowError slowError(double reference) const;

  /// Sigma of the slow error over the root of slowReference, and its time constant [s].
  double slowScale() const;
  double timeConstant() const;

 private:
  struct Direction {
    Time time{};
    Eigen::Vector3d direction = Eigen::Vector3d::Zero();
  };
  struct Past {
    Time time{};
    Eigen::Vector3d error =
        Eigen::Vector3d::Zero();  // over the root of the reference [1], as a vector in the frame
  };
  static constexpr std::size_t kPast = 16;

  StationNoiseParams params_;
  std::array<Direction, 4> directions_;  // the last of one target, oldest first
  std::size_t direction_count_ = 0;
  double white_sum_ = 0.0, white_weight_ = 0.0;
  double slow_sum_ = 0.0, slow_weight_ = 0.0;  // of squares over the reference; seconds
  std::array<Past, kPast> past_;
  std::size_t past_count_ = 0;
  std::optional<Time> last_;
  double same_sum_ = 0.0, lag_sum_ = 0.0, lag_seconds_ = 0.0, lag_weight_ = 0.0;
};

}  // namespace sightline::core
