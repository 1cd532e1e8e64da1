#pragma once

#include <exception>
#include <string>

#include <ros/ros.h>

namespace sightline_ros {

/// The whole main of a node: `Node(nh, private_nh)` lives until shutdown. Anything thrown at construction,
/// above all a ParamError, ends the process with one FATAL line and exit code 1.
template <typename Node>
int runNode(int argc, char** argv, const std::string& default_name) {
  ros::init(argc, argv, default_name);
  ros::NodeHandle nh;  // outlives the node: without a handle alive the FATAL line would not be printed
  try {
    Node node(nh, ros::NodeHandle("~"));
    ros::spin();
  } catch (const std::exception& problem) {
    ROS_FATAL_STREAM(problem.what());
    return 1;
  }
  return 0;
}

}  // namespace sightline_ros
