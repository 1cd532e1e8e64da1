#include <pluginlib/class_list_macros.hpp>

#include "sightline/ros/nodes/flight_recorder_node.h"
#include "sightline/ros/nodes/local_tracker_node.h"
#include "sightline/ros/nodes/nodelet_of.h"
#include "sightline/ros/nodes/position_display_node.h"
#include "sightline/ros/nodes/position_tracker_node.h"
#include "sightline/ros/nodes/sensor_simulator_node.h"
#include "sightline/ros/nodes/track_display_node.h"
#include "sightline/ros/nodes/track_evaluator_node.h"
#include "sightline/ros/nodes/track_fusion_node.h"
#include "sightline/ros/nodes/track_outputs_node.h"
#include "sightline/ros/nodes/truth_publisher_node.h"

namespace sightline_ros {

using FlightRecorderNodelet = NodeletOf<FlightRecorderNode>;
using LocalTrackerNodelet = NodeletOf<LocalTrackerNode>;
using SensorSimulatorNodelet = NodeletOf<SensorSimulatorNode>;
using TruthPublisherNodelet = NodeletOf<TruthPublisherNode>;
using TrackDisplayNodelet = NodeletOf<TrackDisplayNode>;
using TrackEvaluatorNodelet = NodeletOf<TrackEvaluatorNode>;
using TrackFusionNodelet = NodeletOf<TrackFusionNode>;
using TrackOutputsNodelet = NodeletOf<TrackOutputsNode>;
using PositionDisplayNodelet = NodeletOf<PositionDisplayNode>;
using PositionTrackerNodelet = NodeletOf<PositionTrackerNode>;

}  // namespace sightline_ros

PLUGINLIB_EXPORT_CLASS(sightline_ros::FlightRecorderNodelet, nodelet::Nodelet)
PLUGINLIB_EXPORT_CLASS(sightline_ros::LocalTrackerNodelet, nodelet::Nodelet)
PLUGINLIB_EXPORT_CLASS(sightline_ros::SensorSimulatorNodelet, nodelet::Nodelet)
PLUGINLIB_EXPORT_CLASS(sightline_ros::TruthPublisherNodelet, nodelet::Nodelet)
PLUGINLIB_EXPORT_CLASS(sightline_ros::TrackDisplayNodelet, nodelet::Nodelet)
PLUGINLIB_EXPORT_CLASS(sightline_ros::TrackEvaluatorNodelet, nodelet::Nodelet)
PLUGINLIB_EXPORT_CLASS(sightline_ros::TrackFusionNodelet, nodelet::Nodelet)
PLUGINLIB_EXPORT_CLASS(sightline_ros::TrackOutputsNodelet, nodelet::Nodelet)
PLUGINLIB_EXPORT_CLASS(sightline_ros::PositionDisplayNodelet, nodelet::Nodelet)
PLUGINLIB_EXPORT_CLASS(sightline_ros::PositionTrackerNodelet, nodelet::Nodelet)
