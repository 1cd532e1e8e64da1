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

/// How far what one sensor sees is from what others see at about the same time (within 0.15 s): the distance
/// [rad] that as many of its glimpses have from another's as half of its scans are, so that many false ones
/// in each do not matter. None where fewer than 10 can be compared. Both lists in order of time.
std::optional<double> separation(const std::vector<Glimpse>& mine, const std::vector<Glimpse>& others);

}  // namespace sightline::core
