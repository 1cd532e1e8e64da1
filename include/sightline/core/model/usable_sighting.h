#pragma once

#include "sightline/core/model/sighting.h"

namespace sightline::core {

/// Whether numbers of a sighting, or of a tracklet's, can be worked with: a finite unit direction, and a
/// covariance that is finite, symmetric, in the tangent plane not indefinite, and whose largest sigma is in
/// [1e-12, pi] rad. What sensors state is judged more strictly where it comes in (`rejectionOf`).
bool isUsable(const Sighting& sighting);

}  // namespace sightline::core
