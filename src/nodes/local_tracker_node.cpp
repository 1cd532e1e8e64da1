#include "sightline/ros/nodes/local_tracker_node.h"

#include "sightline/ros/nodes/run_node.h"

int main(int argc, char** argv) {
  return sightline_ros::runNode<sightline_ros::LocalTrackerNode>(argc, argv, "local_tracker");
}
