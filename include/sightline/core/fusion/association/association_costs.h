#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "sightline/core/fusion/association/tracker_misalignment.h"
#include "sightline/core/fusion/global_tracks.h"
#include "sightline/core/fusion/reports/local_reports.h"

/// What it costs that a local track, or a global one, is of the target of a global track (S-71), (S-72).
namespace sightline::core {

/// Something to be assigned to a global track: a free local track, or (without key) a global track.
struct AssignedRow {
  std::optional<LocalKey> key;
  std::size_t entry = 0;  // without key; with one that which the local track had before, if it waits for it
  LocalTrack local;       // without key: the global track's state as one
};

/// What the costs depend on beside rows and columns.
struct CostContext {
  const GlobalTracks& tracks;
  const TrackerMisalignment& misalignment;
  double join_threshold;

  double sigmaOf(const AssignedRow& row) const {
    return row.key ? misalignment.sigma(row.key->tracker) : misalignment.largestSigma();
  }
};

struct Costs {
  Eigen::MatrixXd pairs;  // by row and column
  double alone = 0.0;
};

/// Normalised distances squared and ln det of their covariances, so that a vague track near to many does not
/// take a sharp one's place; forbidden beyond the gate, and between global tracks with a tracker in common.
/// To stay alone costs as much as the vaguest pair at the gate.
Costs costsOf(const std::vector<AssignedRow>& rows, const std::vector<std::size_t>& columns,
              const CostContext& context);

/// Whether two global tracks may be one, before that is computed exactly.
bool areNear(const GlobalTrack& a, const GlobalTrack& b, const CostContext& context);

}  // namespace sightline::core
