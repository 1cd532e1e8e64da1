#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "sightline/core/model/chart.h"
#include "sightline/core/model/time.h"
#include "sightline/core/smoothing/bank_smoother.h"
#include "sightline/core/smoothing/track_smoother.h"

/// From the sightings of a track on the sphere to those of a smoother in charts, and back.
namespace sightline::core {

/// Sightings in charts that follow the target as those of its filter do.
class ChartedSightings {
 public:
  /// Later than those before, or at the same time.
  void add(const TakenSighting& sighting);

  /// Sighting `k` alone: further ones go on from its chart.
  ChartedSightings only(std::size_t k) const;

  const std::vector<ChartedMeasurement>& measurements() const { return measurements_; }
  const Chart& chartOf(std::size_t k) const { return charts_[k]; }

 private:
  std::vector<Chart> charts_;
  std::vector<ChartedMeasurement> measurements_;
};

/// What the sensors' positions have in them beside white noise, as a track takes it together (S-42). A value.
class SlowErrors {
 public:
  /// Sightings come in order of time.
  void note(const TakenSighting& sighting);

  /// Variance of each coordinate of a chart [rad^2]. `noise_scale`: of white noise over that of the
  /// sightings.
  Eigen::Vector2d variance(const Chart& chart, Time time, const Eigen::Vector2d& noise_scale) const;

 private:
  struct Source {
    TakenSighting last;
    double information;  // of its sightings, fading [1/rad^2]
  };

  static double faded(const Source& source, Time time);

  std::vector<Source> sources_;
};

/// The motion in the tracking frame's angles, with the slow errors in the covariance of the position.
AngularState stateIn(const Chart& chart, const SmoothedMotion& motion, const SlowErrors& slow_errors,
                     Time time);

}  // namespace sightline::core
