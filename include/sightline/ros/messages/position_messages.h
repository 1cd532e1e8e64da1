#pragma once

#include <string>

#include <geometry_msgs/PoseArray.h>
#include <sightline/PositionReport.h>
#include <sightline/PositionTrackArray.h>

#include "sightline/core/positions/position_track.h"

/// Positions of the core to messages and back. Metric frame, m and s on both sides.
namespace sightline_ros {

sightline::PositionTrack toMessage(const sightline::core::PositionTrack& track);
sightline::core::PositionTrack toCore(const sightline::PositionTrack& message);

/// `frame`: the metric frame.
sightline::PositionTrackArray toMessage(const sightline::core::PositionTrackArray& tracks,
                                        const std::string& tracker, const std::string& frame);
sightline::core::PositionTrackArray toCore(const sightline::PositionTrackArray& message);

/// The report on these tracks, with their stamp.
sightline::PositionReport toMessage(const sightline::core::PositionOutput& output, const std::string& frame);

/// Of the confirmed tracks: position, and x forward along the velocity (y level; no turn for one at rest).
geometry_msgs::PoseArray posesOf(const sightline::PositionTrackArray& tracks);

}  // namespace sightline_ros
