#pragma once

#include "sightline/core/model/track.h"

namespace sightline::core {

/// Whether a track's state, in the tracking frame, is one: finite, with its gate; a covariance that is
/// positive semidefinite to rounding; a position less uncertain than anywhere on the sphere (sigma at most pi
/// rad).
bool isTrack(const Track& track);

}  // namespace sightline::core
