#include "sightline/ros/sensor_simulator_node.h"

#include "sightline/ros/run_node.h"

int main(int argc, char** argv) {
  return sightline_ros::runNode<sightline_ros::SensorSimulatorNode>(argc, argv, "sensor_simulator");
}
