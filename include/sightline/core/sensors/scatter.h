#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include <Eigen/Core>

#include "sightline/core/model/time.h"
#include "sightline/core/sensors/recent_values.h"

namespace sightline::core {

/// How much the sightings of one target scatter, against their stated covariances, without any model of its
/// motion (S-57): the third divided difference of four consecutive sightings (von Neumann, Kent, Bellinson,
/// Hart 1941),
///
///   e = sum_i c_i z_i,  c_i = 1 / prod_{j != i} (t_i - t_j),  of covariance sum_i c_i^2 R_i,
///
/// is zero for any constant acceleration, so that over a short time only the noise is left.
class Scatter {
 public:
  /// The last sightings of one target, in order of time.
  class Chain {
    friend class Scatter;
    struct Point {
      Time time{};
      Eigen::Vector2d angles = Eigen::Vector2d::Zero();
      Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
    };
    std::array<Point, 4> points_;  // oldest first; the last `count_` of them count
    int count_ = 0;
  };

  /// `longest`: time that four sightings may take [s]; beyond, the target's motion would count as noise.
  explicit Scatter(double longest = 0.5) : longest_(longest) {}

  /// The next sighting of a target: (azimuth, elevation) [rad], covariance [rad^2], positive definite. One
  /// near the zenith, or not after the last one, breaks the chain.
  void add(Chain& chain, Time time, const Eigen::Vector2d& angles, const Eigen::Matrix2d& covariance);

  /// Sigma of the scatter over the stated one, from the median of e^T cov(e)^-1 e, which outliers do not
  /// move. None while there are fewer than 20 samples.
  std::optional<double> ratio() const;

  std::size_t samples() const { return distances_.size(); }

 private:
  static std::optional<double> distanceSquared(const std::array<Chain::Point, 4>& points);

  double longest_;
  RecentValues distances_;
};

}  // namespace sightline::core
