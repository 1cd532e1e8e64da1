#pragma once

#include <cstdint>
#include <vector>

#include "sightline/core/chart.h"
#include "sightline/core/estimator.h"
#include "sightline/core/gate.h"
#include "sightline/core/sighting.h"
#include "sightline/core/track.h"

namespace sightline::core {

/// What a track expects to see at the time of a scan.
struct Expectation {
  std::uint32_t id = 0;
  bool believed = false;  ///< confirmed or coasting: chooses before the tentative ones
  bool guards = false;    ///< confirmed and not coasting: no track is started in its gate
  Chart chart;
  AngularState prediction;  ///< in the chart, at the time of the scan
  /// Added to the covariance of every sighting [rad^2]: how far the target moves within the error of the
  /// scan's stamp.
  Eigen::Matrix2d smear = Eigen::Matrix2d::Zero();
  Eigen::Vector2d noise_scale = Eigen::Vector2d::Ones();  ///< of the sightings, as the track has found it
  double innovation_scale = 1.0;                          ///< by which S is enlarged, >= 1

  /// Covariance of the noise of a sighting in the chart, by what the track has found [rad^2].
  Eigen::Matrix2d noiseOf(const Sighting& sighting) const {
    return noiseCovariance(chart.covarianceOf(sighting), noise_scale) + smear;
  }
};

/// Who took what. Index -1 = nobody, nothing.
struct Pairing {
  std::vector<int> sighting_of;     ///< for each expectation
  std::vector<int> expectation_of;  ///< for each sighting
  std::vector<bool> may_start;      ///< for each sighting: free, and in no guarded gate
  std::vector<Association>
      decisions;  ///< for each sighting; those that may start a track are OUTSIDE_GATE still
};

/// Global nearest neighbour: the believed tracks choose first, then the tentative ones from what is left;
/// each round is the optimal assignment on the cost d^2 + ln det S, inside gates only, as many tracks served
/// as possible. The scan is in the tracking frame. Deterministic; the order of tracks or sightings changes
/// nothing but ties.
Pairing associate(const Scan& scan, const std::vector<Expectation>& expectations, const GateParams& gate);

}  // namespace sightline::core
