#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "sightline/core/model/time.h"

namespace sightline::core {

/// Something seen at a time, in a direction (unit vector) of a frame that sensors have in common.
struct Glimpse {
  Time time{};
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();
};

/// How far the sightings of one sensor are from those of the others at about the same time (within 0.15 s)
/// [rad], (S-58): the k-th smallest distance to the nearest of the others', k = half the number of its scans,
/// so that many false sightings in each scan do not matter. nullopt where fewer than 10 can be compared. Both
/// lists are in order of time.
std::optional<double> separation(const std::vector<Glimpse>& mine, const std::vector<Glimpse>& others);

}  // namespace sightline::core
