#include "sightline/ros/nodes/truth_publisher_node.h"

#include "sightline/ros/nodes/run_node.h"

int main(int argc, char** argv) {
  return sightline_ros::runNode<sightline_ros::TruthPublisherNode>(argc, argv, "truth_publisher");
}
