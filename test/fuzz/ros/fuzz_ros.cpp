// The fuzz program of the ROS layer (fuzz_driver.cpp has its usage).
#include <console_bridge/console.h>

#include <ros/console.h>
#include <ros/time.h>

#include "fuzz/fuzz_driver.h"
#include "fuzz/ros/ros_targets.h"

int main(int argc, char** argv) {
  ros::Time::init();
  // What is wrong with the input is said at each call: nobody reads that here.
  ros::console::set_logger_level(ROSCONSOLE_DEFAULT_NAME, ros::console::levels::Fatal);
  console_bridge::setLogLevel(console_bridge::CONSOLE_BRIDGE_LOG_NONE);
  return sightline_fuzz::fuzzMain(argc, argv, sightline_fuzz::rosTargets());
}
