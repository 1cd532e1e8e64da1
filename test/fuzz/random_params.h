#pragma once

#include "sightline/core/fusion/track_fusion_params.h"
#include "sightline/core/positions/position_tracker.h"
#include "sightline/core/tracking/local_tracker.h"

#include "fuzz/random_input.h"

namespace sightline_fuzz {

/// Settings that the loaders of parameters accept: any estimator, form, association and rule; of the numbers
/// most at their defaults, some anywhere in their range.
sightline::core::EstimatorParams randomEstimator(RandomInput& input);
sightline::core::LocalTrackerParams randomTracker(RandomInput& input);
sightline::core::TrackFusionParams randomFusion(RandomInput& input);
sightline::core::PositionTrackerParams randomPositions(RandomInput& input);

}  // namespace sightline_fuzz
