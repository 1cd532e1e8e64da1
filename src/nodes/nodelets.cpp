#include <exception>
#include <memory>

#include <nodelet/nodelet.h>
#include <pluginlib/class_list_macros.hpp>

#include "sightline/ros/local_tracker_node.h"
#include "sightline/ros/sensor_simulator_node.h"
#include "sightline/ros/track_display_node.h"
#include "sightline/ros/track_evaluator_node.h"
#include "sightline/ros/track_fusion_node.h"
#include "sightline/ros/truth_publisher_node.h"

namespace sightline_ros {

/// A nodelet that does nothing but hold a node.
template <typename Node>
class NodeletOf : public nodelet::Nodelet {
  void onInit() override {
    try {
      node_ = std::make_unique<Node>(getNodeHandle(), getPrivateNodeHandle());
    } catch (const std::exception& problem) {
      // The nodelet loader would die without a word.
      NODELET_FATAL_STREAM(problem.what());
      throw;
    }
  }

  std::unique_ptr<Node> node_;
};

using LocalTrackerNodelet = NodeletOf<LocalTrackerNode>;
using SensorSimulatorNodelet = NodeletOf<SensorSimulatorNode>;
using TruthPublisherNodelet = NodeletOf<TruthPublisherNode>;
using TrackDisplayNodelet = NodeletOf<TrackDisplayNode>;
using TrackEvaluatorNodelet = NodeletOf<TrackEvaluatorNode>;
using TrackFusionNodelet = NodeletOf<TrackFusionNode>;

}  // namespace sightline_ros

PLUGINLIB_EXPORT_CLASS(sightline_ros::LocalTrackerNodelet, nodelet::Nodelet)
PLUGINLIB_EXPORT_CLASS(sightline_ros::SensorSimulatorNodelet, nodelet::Nodelet)
PLUGINLIB_EXPORT_CLASS(sightline_ros::TruthPublisherNodelet, nodelet::Nodelet)
PLUGINLIB_EXPORT_CLASS(sightline_ros::TrackDisplayNodelet, nodelet::Nodelet)
PLUGINLIB_EXPORT_CLASS(sightline_ros::TrackEvaluatorNodelet, nodelet::Nodelet)
PLUGINLIB_EXPORT_CLASS(sightline_ros::TrackFusionNodelet, nodelet::Nodelet)
