#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "sightline/core/fusion/contributors.h"
#include "sightline/core/fusion/fusion_report.h"
#include "sightline/core/fusion/global_tracks.h"
#include "sightline/core/fusion/track_fusion_params.h"
#include "sightline/core/fusion/tracklets/tracklet_memory.h"

/// A global track's state from its supporters: from their tracklets, or by a rule from their states.
namespace sightline::core {

/// A global track's new state and who made it.
struct CombinedState {
  FusionRule rule = FusionRule::best;  ///< that was applied
  Contributors contributors;
  AngularState state;          ///< in the global track's chart; not determined without contributors
  std::vector<double> shares;  ///< in the fused position, of contributors.used, summing to one
};

/// Tracklets that were not used.
struct TrackletLosses {
  std::size_t late = 0;     ///< they came too late
  TrackletFailures failed;  ///< the estimator could not take them
};

/// Gives the supporters' new tracklets to the global track, in which those of a faulty sensor are found;
/// where that cannot be told, those of a supporter that contradicts the others are taken back from when that
/// began.
TrackletLosses feedTracklets(GlobalTrackEntry& entry, const TrackletMemory& memory,
                             const TrackFusionParams& params);

/// The state by the configured rule; `best` decides for the track what its inputs allow. Says in the entry's
/// report why not tracklets. Without a solution that is finite and positive definite nobody contributes.
CombinedState combine(GlobalTrackEntry& entry, const TrackletMemory& memory, const TrackFusionParams& params,
                      const DistanceThresholds& thresholds);

/// The whole step: tracklets, sensors that are biased, the new state and its report. `new_reports` caused it.
TrackletLosses fuse(GlobalTrackEntry& entry, const NewReports& new_reports, const TrackletMemory& memory,
                    const TrackFusionParams& params, const DistanceThresholds& thresholds);

}  // namespace sightline::core
