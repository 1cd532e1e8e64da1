#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "sightline/core/estimators/estimator.h"
#include "sightline/core/estimators/revisit_time.h"
#include "sightline/core/model/sighting.h"
#include "sightline/core/tracking/live_track.h"
#include "sightline/core/tracking/track_ids.h"

namespace sightline::core {

/// Begins anew where the stated noise of a sensor with one target has been found far too small (S-96), and
/// what its tracks say is worth nothing: of those that began with the sensor one is left, of the scan's only
/// sighting, under the id of the oldest established one; the others are deleted. `scan`: with the noise that
/// has been found; `odds`, `interval`: as for every new track. The tracks are in order of their ids, and stay
/// so. Returns the id.
std::uint32_t begunAnew(std::vector<LiveTrack>& tracks, const Scan& scan,
                        std::unique_ptr<Estimator> estimator, double odds, const RevisitTime& interval,
                        TrackIds& ids);

}  // namespace sightline::core
