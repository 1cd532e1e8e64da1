#include "sightline/ros/spot_detector_node.h"

#include "sightline/ros/run_node.h"

int main(int argc, char** argv) {
  return sightline_ros::runNode<sightline_ros::SpotDetectorNode>(argc, argv, "spot_detector");
}
