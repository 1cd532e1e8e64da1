#pragma once

#include <string>

namespace sightline::bench {

/// The drone with the whole chain: local trackers, tracklets, position tracker.
void trackedDrone(const std::string& folder);

/// Four stations of which one is turned and late, against the same with that known.
void misalignedStation(int runs);

/// Simulated targets in a field, with the whole chain and the bound.
void simulatedFields(int runs);

}  // namespace sightline::bench
