#pragma once

#include <cstdint>
#include <limits>
#include <optional>

#include <Eigen/Core>

#include "sightline/core/model/sighting.h"
#include "sightline/core/model/sphere.h"

/// Errors against the truth, and what is made of many of them (estimators.md, section 7).
namespace sightline::core {

/// Which angles of the truth are known.
enum class Channels { azimuth_and_elevation, azimuth_only };

/// An estimate, or a sighting, minus the truth. Lengths are arcs on the sphere: azimuth errors are multiplied
/// by the cosine of the truth's elevation; near the zenith the two axes are those of the tilted Chart around
/// the truth, along azimuth and along elevation. With Channels::azimuth_only the elevation's parts are 0.
struct DirectionError {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  ///< (along azimuth, along elevation) [rad]
  std::optional<Eigen::Vector2d> rate;                 ///< the same of the rates [rad/s]; not for sightings
  Eigen::Vector2d sigma = Eigen::Vector2d::Zero();     ///< stated standard deviation of `position` [rad]

  /// Squared error in units of the stated covariance over the number of its dimensions (1 is expected of an
  /// honest one), of the position and of position and rate; nullopt when the covariance is not positive
  /// definite.
  std::optional<double> position_nees;
  std::optional<double> state_nees;  ///< not for sightings
};

/// Error of an estimate; both in the tracking frame.
DirectionError errorOf(const AngularState& estimate, const AngularState& truth,
                       Channels channels = Channels::azimuth_and_elevation);

/// Error of a sighting; both in the tracking frame.
DirectionError errorOf(const Sighting& sighting, const AngularState& truth,
                       Channels channels = Channels::azimuth_and_elevation);

/// Mean of numbers that come one by one.
class RunningMean {
 public:
  void add(double value) { mean_ += (value - mean_) / static_cast<double>(++count_); }
  std::uint64_t count() const { return count_; }
  /// NaN when there was none.
  double mean() const { return count_ ? mean_ : std::numeric_limits<double>::quiet_NaN(); }

 private:
  std::uint64_t count_ = 0;
  double mean_ = 0.0;
};

/// Root mean square errors and average normalised squared errors (ANEES) of errors that come one by one.
class ErrorStatistics {
 public:
  explicit ErrorStatistics(Channels channels = Channels::azimuth_and_elevation) : channels_(channels) {}

  void add(const DirectionError& error);

  std::uint64_t samples() const { return position_.count(); }
  double rmse() const;      ///< of the position, pooled over the channels [rad]; NaN without samples
  double rateRmse() const;  ///< of the rates, pooled over the channels [rad/s]; NaN without samples
  double aneesPosition() const { return position_nees_.mean(); }  ///< over its dimension; NaN without samples
  double aneesState() const { return state_nees_.mean(); }        ///< over its dimension; NaN without samples
  int dimensions() const { return channels_ == Channels::azimuth_only ? 1 : 2; }  ///< of the position

 private:
  Channels channels_;
  RunningMean position_, rate_;  // of the squared length over the number of channels
  RunningMean position_nees_, state_nees_;
};

struct Band {
  double low = 0.0, high = 0.0;
};

/// Where an honest covariance's ANEES lies with 95 % probability: chi^2_n / n by Wilson and Hilferty, for
/// `degrees` = number of independent samples times their dimension, > 0. Samples along one track are not
/// independent: over time the true band is wider.
Band aneesBand(double degrees);

/// Share of instants in which an optimal fuser is nearer to the truth than the best of its sources, in one
/// channel, for `s` = mean square error of the fused over that of the best source (S-10). nullopt outside [0,
/// 1].
std::optional<double> beatsTheory(double s);

}  // namespace sightline::core
