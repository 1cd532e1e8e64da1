#pragma once

#include <set>
#include <string>

#include <ros/time.h>
#include <rosbag/bag.h>

#include "sightline/formats/geodesy.h"

namespace sightline_ros {

/// Frame in which stations stand: east, north, up.
inline constexpr const char* kWorldFrame = "world";

/// Topic of the place of `world` on the earth (sensor_msgs/NavSatFix, latched), where it is known.
inline constexpr const char* kWorldOriginTopic = "/world_origin";

/// Writes /tf_static from `world` to a frame named as each of `sensors`, and where they all stand within a
/// metre to the tracking frame `platform_enu` there, and the place of `world`. Throws std::runtime_error for
/// a sensor without a place, naming `remedy`.
void writeStationFrames(rosbag::Bag& bag, const sightline::formats::StationLayout& layout,
                        const std::set<std::string>& sensors, const ros::Time& stamp,
                        const std::string& remedy);

}  // namespace sightline_ros
