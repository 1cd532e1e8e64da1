#pragma once

#include <string>

#include <ros/time.h>
#include <sightline/Association.h>
#include <sightline/Gate.h>
#include <sightline/SightingArray.h>
#include <sightline/Track.h>

#include "sightline/core/model/sighting.h"
#include "sightline/core/model/time.h"
#include "sightline/core/model/track.h"

/// Messages to core types and back. Units and frames are the same on both sides (interfaces of the messages).
namespace sightline_ros {

sightline::core::Time toCore(const ros::Time& stamp);

/// Throws std::range_error for a time that a ROS stamp cannot hold (before 1970 or after 2106).
ros::Time toRos(sightline::core::Time time);

sightline::Gate toMessage(const sightline::core::Gate& gate);
sightline::core::Gate toCore(const sightline::Gate& gate);

sightline::Track toMessage(const sightline::core::Track& track);
sightline::core::Track toCore(const sightline::Track& track);

/// `frame` is that of the scan's sightings.
sightline::SightingArray toMessage(const sightline::core::Scan& scan, const std::string& frame);

sightline::Association toMessage(const sightline::core::Association& association);
sightline::core::Association toCore(const sightline::Association& association);

}  // namespace sightline_ros
