#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "sightline/core/time.h"

namespace sightline::core {

/// Something seen at a time, in a direction (unit vector) of a frame that sensors have in common.
struct Glimpse {
  Time time{};
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();
};

/// How far what one sensor sees is from what others see at about the same time (within 0.3 s): a fifth of
/// its glimpses have another's nearer than this [rad]. None where fewer than 10 can be compared. Both lists
/// in order of time.
std::optional<double> separation(const std::vector<Glimpse>& mine, const std::vector<Glimpse>& others);

}  // namespace sightline::core
