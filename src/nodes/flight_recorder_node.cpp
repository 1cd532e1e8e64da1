#include "sightline/ros/nodes/flight_recorder_node.h"

#include "sightline/ros/nodes/run_node.h"

int main(int argc, char** argv) {
  return sightline_ros::runNode<sightline_ros::FlightRecorderNode>(argc, argv, "flight_recorder");
}
