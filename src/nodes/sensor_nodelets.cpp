#include <pluginlib/class_list_macros.hpp>

#include "sightline/ros/adapters/sighting_adapter_node.h"
#include "sightline/ros/adapters/spot_detector_node.h"
#include "sightline/ros/nodes/nodelet_of.h"

namespace sightline_ros {

using SightingAdapterNodelet = NodeletOf<SightingAdapterNode>;
using SpotDetectorNodelet = NodeletOf<SpotDetectorNode>;

}  // namespace sightline_ros

PLUGINLIB_EXPORT_CLASS(sightline_ros::SightingAdapterNodelet, nodelet::Nodelet)
PLUGINLIB_EXPORT_CLASS(sightline_ros::SpotDetectorNodelet, nodelet::Nodelet)
