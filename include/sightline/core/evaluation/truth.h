#pragma once

#include <deque>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "sightline/core/model/sphere.h"
#include "sightline/core/model/time.h"

namespace sightline::core {

/// Where a target truly was: (azimuth, elevation, azimuth_rate, elevation_rate) [rad, rad, rad/s, rad/s] in
/// the tracking frame.
struct TruthSample {
  Time time{};
  Eigen::Vector4d motion = Eigen::Vector4d::Zero();
};

/// A true direction alone, (azimuth, elevation) [rad] in the tracking frame.
struct TruthDirection {
  Time time{};
  Eigen::Vector2d angles = Eigen::Vector2d::Zero();
};

/// Motion at `time` between two samples, by the cubic that has their positions and their rates (Hermite) in
/// the chart of the direction between them, so that the wrap and the zenith are ordinary places. nullopt when
/// `time` is not within [before.time, after.time] or the two times are equal.
std::optional<Eigen::Vector4d> interpolate(const TruthSample& before, const TruthSample& after, Time time);

/// Directions of one target in ascending order of time, completed by the rates of the parabola through each
/// and its neighbours (of the line through two at an end). Neighbours further away than `largest_gap` are not
/// used; a sample without neighbours has rates of zero. Of equal times the first counts.
std::vector<TruthSample> withRates(const std::vector<TruthDirection>& directions, Duration largest_gap);

/// The path of one target through its samples, as far back as it is kept.
class TruthPath {
 public:
  /// A point of the path.
  struct Point {
    AngularState state;  ///< covariance zero
    double age = 0.0;    ///< how long the target has been there without a gap [s]
  };

  /// Between samples more than `largest_gap` apart the target is not there.
  explicit TruthPath(Duration largest_gap) : largest_gap_(largest_gap) {}

  /// Takes a sample; one that is late goes to its place, one of a time already known replaces it.
  void add(const TruthSample& sample);

  /// Forgets what is not needed for times from `time` on.
  void forgetBefore(Time time);

  /// The target at `time`; nullopt when it is not there, or not known yet.
  std::optional<Point> at(Time time) const;

  bool empty() const { return samples_.empty(); }

 private:
  struct Sample {
    TruthSample truth;
    Time piece_start{};  ///< of the samples without a gap to which this one belongs
  };

  std::deque<Sample> samples_;  // ascending in time
  Duration largest_gap_;
};

}  // namespace sightline::core
