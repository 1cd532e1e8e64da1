#pragma once

#include <vector>

#include "sightline/core/model/track.h"

namespace sightline::core {

/// Whether a track's state, in the tracking frame, is one: finite, with its gate; a covariance that is
/// positive semidefinite to rounding; a position less uncertain than anywhere on the sphere (sigma at most pi
/// rad).
bool isTrack(const Track& track);

/// The tracks that are. One of the others goes on unseen: a sighting may yet make it one.
std::vector<Track> publishedTracks(std::vector<Track> tracks);

}  // namespace sightline::core
