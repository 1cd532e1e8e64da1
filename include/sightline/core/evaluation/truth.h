#pragma once

#include <cstdint>
#include <deque>
#include <limits>
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

/// A target at the instant that is scored.
struct TrueTarget {
  std::uint32_t id = 0;
  AngularState state;                                    ///< the truth, tracking frame, covariance zero
  bool is_scored = true;                                 ///< false: its errors do not count yet
  double age = std::numeric_limits<double>::infinity();  ///< how long it has been there without a gap [s]
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

  /// Between samples more than `largest_gap` apart the target does not exist.
  explicit TruthPath(Duration largest_gap) : largest_gap_(largest_gap) {}

  /// Adds a sample. A late one is put in its place, one of a known time replaces the sample of that time.
  void add(const TruthSample& sample);

  /// Removes what is not needed for times from `time` on.
  void forgetBefore(Time time);

  /// The target at `time`; nullopt when it does not exist then, or is not known yet.
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
