#pragma once

#include <cstdint>
#include <vector>

#include "sightline/core/chart.h"
#include "sightline/core/equivalent_sighting.h"
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
  AngularState prediction;                               ///< in the chart, at the time of the scan
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  ///< predicted, tracking frame
  /// Added to the covariance of every sighting [rad^2]: how far the target moves within the error of the
  /// scan's stamp.
  Eigen::Matrix2d smear = Eigen::Matrix2d::Zero();
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
    return noiseCovariance(chart.covarianceOf(sighting), noise_scale) + smear;
  }
};

/// Who takes which sighting.
enum class AssociationMethod {
  nearest,  ///< global nearest neighbour: the most likely assignment
  jpda,     ///< a believed track's state is moved by all sightings in its gate, each with its probability
};

/// Who took what. Index -1 = nobody, nothing.
struct Pairing {
  std::vector<int> sighting_of;     ///< for each expectation
  std::vector<int> expectation_of;  ///< for each sighting
  /// With jpda, for each expectation that has a sighting: all that may be its own; empty = that sighting
  /// alone.
  std::vector<std::vector<PossibleSighting>> possible;
  /// For each expectation: how many times as often the target would have given what was seen as clutter does:
  /// 1 - P_D + P_D N(innovation; 0, S) / clutter density, 1 - P_D without a sighting, with P_D times
  /// `visibility`.
  std::vector<double> evidence;
  std::vector<bool> may_start;  ///< for each sighting: free, and in no guarded gate
  std::vector<Association>
      decisions;  ///< for each sighting; those that may start a track are OUTSIDE_GATE still
};

/// Global nearest neighbour: the believed tracks choose first, then the others from what is left; each round
/// is, cluster by cluster, the assignment of the largest likelihood, of tracks that are seen, tracks that are
/// missed, and sightings that are clutter: the sum of ln(P_D N(innovation; 0, S) / clutter density) over the
/// pairs and of ln(1 - P_D) over the missed. N is a density on the sphere [1/sr], as that of the clutter.
/// Inside gates only. The scan is in the tracking frame. Deterministic; the order of tracks or sightings
/// changes nothing but ties.
///
/// With `jpda` the same assignment says which sighting is recorded as whose and who has missed; what moves
/// the states of the believed tracks, and their evidence, are the joint probabilities of all assignments.
///
/// `clutter_density`: of the scan's false sightings [1/sr], > 0.
Pairing associate(const Scan& scan, const std::vector<Expectation>& expectations, const GateParams& gate,
                  double clutter_density, AssociationMethod method = AssociationMethod::nearest);

}  // namespace sightline::core
