#include "sightline/ros/nodes/track_outputs_node.h"

#include "sightline/ros/nodes/run_node.h"

int main(int argc, char** argv) {
  return sightline_ros::runNode<sightline_ros::TrackOutputsNode>(argc, argv, "track_outputs");
}
