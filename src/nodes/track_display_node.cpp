#include "sightline/ros/track_display_node.h"

#include "sightline/ros/run_node.h"

int main(int argc, char** argv) {
  return sightline_ros::runNode<sightline_ros::TrackDisplayNode>(argc, argv, "track_display");
}
