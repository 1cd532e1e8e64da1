#pragma once

#include <string>
#include <vector>

#include <ros/node_handle.h>

#include "sightline/ros/params/param_reader.h"

/// The topics of local trackers that a node listens to, by their full names.
namespace sightline_ros {

/// `track_topics`: two or more, all different. Throws ParamError.
std::vector<std::string> trackTopicsFrom(const ParamReader& reader, const ros::NodeHandle& nh);

/// `tracklet_topics` where that is set, or else `tracklets` beside each topic of tracks. Throws ParamError.
std::vector<std::string> trackletTopicsFrom(const ParamReader& reader, const ros::NodeHandle& nh,
                                            const std::vector<std::string>& track_topics);

}  // namespace sightline_ros
