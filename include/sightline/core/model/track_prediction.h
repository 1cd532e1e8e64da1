#pragma once

#include <cstdint>

#include <Eigen/Core>

#include "sightline/core/model/chart.h"
#include "sightline/core/model/sighting.h"
#include "sightline/core/model/sphere.h"

namespace sightline::core {

/// A state in the coordinates of a chart.
struct ChartedState {
  Chart chart;
  AngularState state;
};

/// What a track expects to see at the time of a scan.
struct TrackPrediction {
  std::uint32_t id = 0;
  bool believed = false;  ///< confirmed or coasting: chooses before the tentative ones
  bool guards = false;    ///< confirmed and not coasting: no track is started in its gate
  Chart chart;
  AngularState state;                                    ///< in the chart, at the time of the scan
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  ///< predicted, tracking frame
  /// Of a target that has been seen once, so that its rates are not known: time since then [s], > 0, and the
  /// covariance of that sighting in the chart [rad^2]. 0 for the others.
  double since_only_sighting = 0.0;
  Eigen::Matrix2d only_sighting = Eigen::Matrix2d::Zero();
  /// Of a target that has been seen so seldom that nobody knows how its rates change: standard deviation of
  /// its position by a change of the rates [rad]; 0 for the others.
  double change_sigma = 0.0;
  /// Added to the covariance of every sighting [rad^2]: how far the target moves within the error of the
  /// scan's stamp.
  Eigen::Matrix2d stamp_covariance = Eigen::Matrix2d::Zero();
  Eigen::Vector2d noise_scale = Eigen::Vector2d::Ones();  ///< of the sightings, as the track has found it
  double innovation_scale = 1.0;                          ///< by which S is enlarged, >= 1
  double existence = 1.0;              ///< probability that there is a target, before the scan
  double detection_probability = 0.9;  ///< that the scan shows the target, were it there, in (0, 1)
  /// Probability that the scan could show such a target at all: 1 where its sensor has seen it lately, 0 out
  /// of its field of view, and in between while nobody knows.
  double visibility = 1.0;
  bool is_in_view = true;  ///< the sensor has seen the target lately, and looks there

  /// Covariance of the noise of a sighting in the chart, by what the track has found [rad^2].
  Eigen::Matrix2d noiseOf(const Sighting& sighting) const {
    return noiseCovariance(chart.covarianceOf(sighting), noise_scale) + stamp_covariance;
  }
};

}  // namespace sightline::core
