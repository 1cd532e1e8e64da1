#include "sightline/ros/nodes/sensor_simulator_node.h"

#include "sightline/ros/nodes/run_node.h"

int main(int argc, char** argv) {
  return sightline_ros::runNode<sightline_ros::SensorSimulatorNode>(argc, argv, "sensor_simulator");
}
