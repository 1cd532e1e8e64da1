#include "sightline/ros/adapters/sighting_adapter_node.h"

#include "sightline/ros/nodes/run_node.h"

int main(int argc, char** argv) {
  return sightline_ros::runNode<sightline_ros::SightingAdapterNode>(argc, argv, "sighting_adapter");
}
