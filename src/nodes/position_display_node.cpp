#include "sightline/ros/nodes/position_display_node.h"

#include "sightline/ros/nodes/run_node.h"

int main(int argc, char** argv) {
  return sightline_ros::runNode<sightline_ros::PositionDisplayNode>(argc, argv, "position_display");
}
