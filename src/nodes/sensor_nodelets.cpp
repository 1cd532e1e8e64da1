#include <pluginlib/class_list_macros.hpp>

#include "sightline/ros/nodelet_of.h"
#include "sightline/ros/sighting_adapter_node.h"

namespace sightline_ros {

using SightingAdapterNodelet = NodeletOf<SightingAdapterNode>;

}  // namespace sightline_ros

PLUGINLIB_EXPORT_CLASS(sightline_ros::SightingAdapterNodelet, nodelet::Nodelet)
