#pragma once

#include <cstdint>
#include <vector>

#include "sightline/core/association/association.h"
#include "sightline/core/model/sighting.h"
#include "sightline/core/model/track_prediction.h"
#include "sightline/core/tracking/live_track.h"
#include "sightline/core/tracking/track_lifecycle.h"

/// What a tracker does about targets of which so little is known that a sighting may be theirs or not.
namespace sightline::core {

/// Near a believed track a tentative one may be made of sightings of two targets, or of that one's: there its
/// rates are taken not to change (S-94).
void keepApart(std::vector<TrackPrediction>& predictions);

/// Whether so few sightings of the scan are false that a second look at a very fast target can be told from
/// them. `clutter`: false sightings expected in it.
bool isClear(const Scan& scan, const std::vector<LiveTrack>& tracks, double clutter);

/// Second tracks, (S-95): the second look at a very fast target is told from a miss and a false sighting only
/// by the third. The tracks that have been seen once go on as missed, and for each sighting that may be
/// theirs all the same, and is free, there is one more that has taken it. `ids` gives them theirs.
std::vector<LiveTrack> branchesOf(const std::vector<LiveTrack>& tracks, const Scan& scan,
                                  const std::vector<TrackPrediction>& predictions,
                                  const AssociationResult& result, const LifecycleParams& params,
                                  TrackIds& ids);

}  // namespace sightline::core
