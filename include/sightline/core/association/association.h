#pragma once

#include <cstdint>
#include <vector>

#include "sightline/core/association/clusters.h"
#include "sightline/core/association/equivalent_sighting.h"
#include "sightline/core/association/gate.h"
#include "sightline/core/model/sighting.h"
#include "sightline/core/model/track.h"
#include "sightline/core/model/track_prediction.h"

namespace sightline::core {

/// Who takes which sighting.
enum class AssociationMethod {
  nearest,  ///< global nearest neighbour: the most likely assignment
  jpda,     ///< a believed track's state is moved by all sightings in its gate, each with its probability
};

/// Who took what. Index -1 = nobody, nothing.
struct AssociationResult {
  std::vector<int> sighting_of;    ///< for each prediction
  std::vector<int> prediction_of;  ///< for each sighting
  /// With jpda, for each prediction that has a sighting: all that may be its own; empty = that sighting
  /// alone.
  std::vector<std::vector<PossibleSighting>> possible;
  /// For each prediction: how many times as often the target would have given what was seen as clutter does:
  /// 1 - P_D + P_D N(innovation; 0, S) / clutter density, 1 - P_D without a sighting, with P_D times
  /// `visibility`.
  std::vector<double> evidence;
  /// Pairs of a target seen once and a sighting that may be its second one, though it is more likely that it
  /// was missed and the sighting is another's.
  std::vector<GatedPair> second_looks;
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
/// `clutter_density`: of the scan's false sightings [1/sr], > 0. `with_branches`: whether second looks that
/// are less likely than a miss are listed.
AssociationResult associate(const Scan& scan, const std::vector<TrackPrediction>& predictions,
                            const GateParams& gate, double clutter_density,
                            AssociationMethod method = AssociationMethod::nearest,
                            bool with_branches = false);

}  // namespace sightline::core
