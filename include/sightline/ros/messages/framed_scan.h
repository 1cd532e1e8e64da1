#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <sightline/SightingArray.h>

#include "sightline/core/model/field_of_view.h"
#include "sightline/core/model/refusal.h"
#include "sightline/core/model/sighting.h"
#include "sightline/ros/messages/sensor_turn.h"

namespace sightline_ros {

/// A scan message and the scan in the tracking frame.
struct FramedScan {
  sightline::SightingArray::ConstPtr message;

  /// In the tracking frame; as many sightings as the message has, in its order. Those that cannot be used
  /// have a NaN covariance, which the trackers reject, and an entry in `rejections`.
  sightline::core::Scan scan;
  std::vector<std::pair<std::uint32_t, std::string>> rejections;  ///< index, why; ascending

  std::optional<sightline::core::Refusal> refusal;  ///< of the whole scan; nullopt = it can be used
};

/// What is wrong with a scan as a whole; nullopt when nothing is.
std::optional<sightline::core::Refusal> refusalOf(const sightline::SightingArray& message);

/// The message's scan, turned into the tracking frame where `turn` says how. Refused when none of its
/// sightings can be used: it then says neither "detected" nor "looked and detected nothing".
FramedScan framedScan(const sightline::SightingArray::ConstPtr& message, const std::optional<Turn>& turn,
                      const std::optional<sightline::core::FieldOfView>& view);

/// A scan that is not used: time and sensor only.
FramedScan refusedScan(const sightline::SightingArray::ConstPtr& message, sightline::core::Refusal refusal);

}  // namespace sightline_ros
