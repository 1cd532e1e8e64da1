#include <exception>
#include <memory>

#include <nodelet/nodelet.h>
#include <pluginlib/class_list_macros.hpp>

#include "sightline/ros/sensor_simulator_node.h"
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

// Each class as `using XxxNodelet = NodeletOf<XxxNode>;` here and in nodelets.xml, exported below.
using SensorSimulatorNodelet = NodeletOf<SensorSimulatorNode>;
using TruthPublisherNodelet = NodeletOf<TruthPublisherNode>;
using TrackDisplayNodelet = NodeletOf<TrackDisplayNode>;

}  // namespace sightline_ros
PLUGINLIB_EXPORT_CLASS(sightline_ros::SensorSimulatorNodelet, nodelet::Nodelet)
PLUGINLIB_EXPORT_CLASS(sightline_ros::TruthPublisherNodelet, nodelet::Nodelet)
PLUGINLIB_EXPORT_CLASS(sightline_ros::TrackDisplayNodelet, nodelet::Nodelet)
